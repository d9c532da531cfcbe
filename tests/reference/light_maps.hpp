#pragma once

#include <lamina/voxelize/epipolar_bits.hpp>

#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

/// What is made of a light's depth map, on the host and in double precision: hole filling and
/// rectification ([WD13] 3.1.2, 3.1.3).
namespace lamina::reference {

/// A square map of distances, rows one after the other.
struct DistanceMap {
    std::uint32_t side = 0;
    std::vector<double> values;
    double empty = 0.0; ///< The value of texels without a surface.

    [[nodiscard]] double at(std::uint32_t x, std::uint32_t y) const {
        return values[std::size_t{y} * side + x];
    }
};

/// Pulls a pyramid of `levels` up from the map and pushes it down into its empty texels.
/// Pull: a coarser texel has a value if at least three of its four finer ones have (at the border
/// of an odd side the last one counts twice): the mean of those at most a tenth farther than the
/// nearest. Push: an empty texel takes the bilinear mean of the four nearest coarser texels, if all
/// of them have a value.
[[nodiscard]] DistanceMap fillHoles(const DistanceMap& map, std::uint32_t levels);

/// The first surface along a light ray, from its origin along a unit direction; world space.
using FirstSurface =
    std::function<std::optional<glm::dvec3>(const glm::dvec3& origin, const glm::dvec3& direction)>;

/// For each light ray (theta, phi) of a point or directional light's volume, theta slowest, the
/// first alpha voxel whose centre lies behind the ray's surface; the number of alpha voxels if none
/// does.
[[nodiscard]] std::vector<std::uint32_t> rectify(const EpipolarTransform& transform,
                                                 const FirstSurface& surface);

} // namespace lamina::reference
