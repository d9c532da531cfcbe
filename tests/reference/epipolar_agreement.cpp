#include <reference/epipolar_agreement.hpp>

#include <lamina/grid/grid_transform.hpp>

#include <glm/geometric.hpp>
#include <glm/gtc/matrix_transform.hpp>

#include <cmath>
#include <random>

namespace lamina::reference {
namespace {

/// Is there a shadow boundary within `radius` voxels of the point? Looks for a place there whose
/// visibility differs.
bool isNearBoundary(const ShadowRays& rays, const EpipolarTransform& transform,
                    const glm::dvec3& world, bool isLit, double radius, std::mt19937& random) {
    const glm::dvec3 voxel = transform.worldToVoxel(world);
    std::uniform_real_distribution<double> offset(-radius, radius);
    constexpr int kTries = 4000;
    for (int i = 0; i < kTries; ++i) {
        const glm::dvec3 shift(offset(random), offset(random), offset(random));
        if (glm::length(shift) > radius)
            continue;
        const glm::dvec3 place = transform.voxelToWorld(voxel + shift);
        if (std::isfinite(place.x + place.y + place.z) &&
            rays.lit(transform.light(), place) != isLit)
            return true;
    }
    return false;
}

} // namespace

Agreement compareWithRays(const EpipolarBits& bits, std::size_t vsv, const ShadowRays& rays,
                          const GridCamera& eye, std::size_t count, double lowest) {
    const EpipolarTransform& transform = bits.transforms()[vsv];
    const GridTransform view = GridTransform::camera(eye, {1, 1, 1}).value();
    std::mt19937 random(11);
    std::uniform_real_distribution<double> x(-3.0, 3.0);
    std::uniform_real_distribution<double> y(lowest, 1.6);
    Agreement result;
    while (result.points < count) {
        const glm::dvec3 point(x(random), y(random), x(random));
        if (!view.voxelAt(point))
            continue;
        ++result.points;
        const bool isLit = rays.lit(transform.light(), point);
        result.lit += isLit ? 1 : 0;
        const glm::dvec3 center = glm::floor(transform.worldToVoxel(point)) + 0.5;
        if (rays.lit(transform.light(), transform.voxelToWorld(center)) != isLit)
            ++result.ideal;
        if (bits.lit(vsv, point) == isLit)
            continue;
        ++result.disagreements;
        if (!isNearBoundary(rays, transform, point, isLit, 1.5, random))
            ++result.unproved;
    }
    return result;
}

GridCamera makeEye(const glm::dvec3& from, const glm::dvec3& to) {
    return GridCamera::perspective(glm::lookAt(from, to, glm::dvec3(0, 1, 0)), 1.0, 1.25, 0.1,
                                   10.0);
}

GridCamera frontEye() {
    return makeEye({0.5, 1.6, 5.0}, {0.0, 0.6, 0.0});
}

std::vector<LightCase> makeLightCases() {
    const auto point = [](const glm::dvec3& place) { return EpipolarLight{.position = place}; };
    const auto sun = [](const glm::dvec3& direction) {
        return EpipolarLight{.kind = LightKind::Directional, .direction = direction};
    };
    return {
        {"point on screen", point({0.6, 2.2, -2.6})},
        {"point off screen", point({-3.5, 3.0, 1.0})},
        {"point behind the camera", point({1.5, 2.6, 7.0})},
        {"sun off screen", sun({0.7, -0.6, 0.3})},
        {"sun on screen", sun({0.1, -0.2, 1.0})},
        {"sun behind the camera", sun({0.2, -0.5, -1.0})},
        {"spot",
         {.kind = LightKind::Spot,
          .position = {2.0, 2.8, -3.0},
          .direction = {-0.5, -0.6, 0.8},
          .coneAngle = 0.5}},
    };
}

} // namespace lamina::reference
