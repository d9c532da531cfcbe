#include <reference/fog_voxels.hpp>

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <vector>

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

/// Phi coordinate of the first surface that the eye sees.
double firstPhi(const ShadowRays& rays, const EpipolarTransform& volume, double theta,
                double alpha) {
    const glm::dvec3 around = std::cos(theta) * volume.u() + std::sin(theta) * volume.v();
    const glm::dvec3 along = std::cos(alpha) * volume.axis() + std::sin(alpha) * around;
    const double distance = rays.firstHit(volume.eye(), along);
    if (std::isinf(distance))
        return distance;
    return volume.worldToVoxel(volume.eye() + distance * along).z;
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
    std::vector<double> phis;
    (void)marchFog(
        [&](const glm::dvec3& at) {
            phis.push_back(snapped(volume.worldToVoxel(at).z, voxels.phi));
            return 1.0;
        },
        light, medium, volume.eye(), point, steps);
    const auto litAt = [&](double row) {
        const double angle = origin.y + row / scale.y;
        std::vector<bool> lit;
        for (std::size_t i = 0; i < phis.size(); ++i)
            lit.push_back(i > 0 && phis[i] == phis[i - 1]
                              ? lit.back()
                              : reaches(rays, volume, angle, origin.z + phis[i] / scale.z, alpha));
        // The shadow of the surface that the ray through the voxels' centres ends on.
        const double surface = firstPhi(rays, volume, angle, alpha);
        std::size_t begin = lit.size();
        while (begin > 0 && !lit[begin - 1])
            --begin;
        if (begin < lit.size() && phis[begin] >= surface)
            std::fill(lit.begin() + static_cast<std::ptrdiff_t>(begin), lit.end(), true);
        return lit;
    };
    const std::vector<bool> first = litAt(theta.first);
    const std::vector<bool> second = theta.share > 0.0 ? litAt(theta.second) : first;
    std::size_t next = 0;
    const auto lit = [&](const glm::dvec3&) {
        const std::size_t i = next++;
        return (first[i] ? 1.0 - theta.share : 0.0) + (second[i] ? theta.share : 0.0);
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
