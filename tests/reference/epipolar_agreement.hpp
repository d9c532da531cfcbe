#pragma once

#include <reference/epipolar_rays.hpp>

#include <lamina/voxelize/epipolar_bits.hpp>

#include <cstddef>
#include <vector>

/// Voxelized shadow volumes against ray casting, for the scene of makeFenceScene().
namespace lamina::reference {

struct Agreement {
    std::size_t points = 0;
    std::size_t lit = 0;
    std::size_t disagreements = 0;
    /// Disagreements of exact visibility at the centre of the point's voxel: what a perfect volume
    /// of this size would have.
    std::size_t ideal = 0;
    /// Disagreements farther than 1.5 voxels from every place found with the other visibility.
    std::size_t unproved = 0;
};

/// Compares EpipolarBits::lit() at random points of the scene that the camera sees, from `lowest`
/// on: points below 0 are in the shadow of the floor.
[[nodiscard]] Agreement compareWithRays(const EpipolarBits& bits, std::size_t vsv,
                                        const ShadowRays& rays, const GridCamera& eye,
                                        std::size_t count, double lowest = 0.0);

/// Sees the scene's ten units.
[[nodiscard]] GridCamera makeEye(const glm::dvec3& from, const glm::dvec3& to);

struct LightCase {
    const char* name;
    EpipolarLight light;
};
/// Sees fence and sphere from the front.
[[nodiscard]] GridCamera frontEye();
/// Point, spot and directional lights on and off frontEye()'s screen and behind it.
[[nodiscard]] std::vector<LightCase> makeLightCases();

} // namespace lamina::reference
