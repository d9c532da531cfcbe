#include <reference/fog_voxels.hpp>

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>

namespace lamina::reference {
namespace {

/// Does a light ray reach alpha unhindered? theta and phi in radians.
bool reaches(const ShadowRays& rays, const EpipolarTransform& volume, double theta, double phi,
             double alpha) {
    const glm::dvec3 around = std::cos(theta) * volume.u() + std::sin(theta) * volume.v();
    const glm::dvec3 along = std::sin(phi) * around - std::cos(phi) * volume.axis();
    const glm::dvec3& light = volume.light().position;
    const double distance = rays.firstHit(light, along);
    if (std::isinf(distance))
        return true;
    const glm::dvec3 offset = light + distance * along - volume.eye();
    const double reached = glm::dot(offset, volume.axis());
    return std::atan2(glm::length(offset - reached * volume.axis()), reached) >= alpha;
}

double snapped(double coordinate, bool isWhole) {
    return isWhole ? std::floor(coordinate) + 0.5 : coordinate;
}

/// Two neighbours and the share of the second.
struct Between {
    double first = 0.0;
    double second = 0.0;
    double share = 0.0;
};

Between between(double coordinate, const VoxelSteps& voxels, bool isWhole) {
    if (!isWhole || !voxels.interpolate)
        return {snapped(coordinate, isWhole), 0.0, 0.0};
    const double low = std::floor(coordinate - 0.5);
    return {low + 0.5, low + 1.5, coordinate - 0.5 - low};
}

} // namespace

double marchVoxels(const ShadowRays& rays, const VirtualLight& light,
                   const EpipolarTransform& volume, const Medium& medium, const glm::dvec3& point,
                   std::uint32_t steps, const VoxelSteps& voxels) {
    const glm::dvec3 origin = volume.origin();
    const glm::dvec3 scale = volume.scale();
    const glm::dvec3 end = volume.worldToVoxel(point);
    // An eye ray has one alpha and one theta.
    const double alpha = origin.x + snapped(end.x, voxels.alpha) / scale.x;
    const Between theta = between(end.y, voxels, voxels.theta);
    double lastPhi = -1.0;
    double lastLit = 1.0;
    const auto lit = [&](const glm::dvec3& at) {
        const double phi = snapped(volume.worldToVoxel(at).z, voxels.phi);
        if (phi == lastPhi)
            return lastLit;
        const auto one = [&](double place) {
            return reaches(rays, volume, origin.y + place / scale.y, origin.z + phi / scale.z,
                           alpha)
                       ? 1.0
                       : 0.0;
        };
        lastPhi = phi;
        lastLit = (1.0 - theta.share) * one(theta.first);
        if (theta.share > 0.0)
            lastLit += theta.share * one(theta.second);
        return lastLit;
    };
    return marchFog(lit, light, medium, volume.eye(), point, steps).airlight;
}

double litVoxels(const ShadowRays& rays, const EpipolarTransform& volume,
                 const glm::dvec3& coordinates, const VoxelSteps& voxels) {
    const glm::dvec3 origin = volume.origin();
    const glm::dvec3 scale = volume.scale();
    const double alpha = origin.x + snapped(coordinates.x, voxels.alpha) / scale.x;
    const Between theta = between(coordinates.y, voxels, voxels.theta);
    const Between phi = between(coordinates.z, voxels, voxels.phi);
    const auto one = [&](double thetaAt, double phiAt) {
        return reaches(rays, volume, origin.y + thetaAt / scale.y, origin.z + phiAt / scale.z,
                       alpha)
                   ? 1.0
                   : 0.0;
    };
    const auto row = [&](double phiAt) {
        const double first = (1.0 - theta.share) * one(theta.first, phiAt);
        return theta.share > 0.0 ? first + theta.share * one(theta.second, phiAt) : first;
    };
    const double first = (1.0 - phi.share) * row(phi.first);
    return phi.share > 0.0 ? first + phi.share * row(phi.second) : first;
}

} // namespace lamina::reference
