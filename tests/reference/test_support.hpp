#pragma once

#include <lamina/grid/bit_grid.hpp>

#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>

#include <functional>
#include <vector>

/// What the tests of the references share.
namespace lamina::reference {

/// Voxel (i,j,k) of this grid is the world cube at (i,j,k) if `axis` is Z.
inline GridTransform unitGrid(const glm::uvec3& voxels, Axis axis = Axis::Z) {
    return *GridTransform::box({glm::dvec3(0.0), glm::dvec3(voxels)}, voxels, axis);
}

/// Set voxels for which `expected` is false plus clear voxels for which it is true.
inline std::uint64_t differences(const BitGrid& grid,
                                 const std::function<bool(const glm::ivec3&)>& expected) {
    std::uint64_t count = 0;
    const glm::ivec3 size(grid.size());
    for (int z = 0; z < size.z; ++z)
        for (int y = 0; y < size.y; ++y)
            for (int x = 0; x < size.x; ++x)
                count += grid.test({x, y, z}) != expected({x, y, z});
    return count;
}

/// Is every voxel of `part` set in `whole`?
inline bool isSubset(const BitGrid& part, const BitGrid& whole) {
    return compare(part, whole)->onlyFirst == 0;
}

/// The part of a convex polygon where normal . point >= offset (Sutherland and Hodgman).
inline std::vector<glm::dvec3> clipped(const std::vector<glm::dvec3>& polygon,
                                       const glm::dvec3& normal, double offset) {
    std::vector<glm::dvec3> kept;
    for (std::size_t i = 0; i < polygon.size(); ++i) {
        const glm::dvec3& a = polygon[i];
        const glm::dvec3& b = polygon[(i + 1) % polygon.size()];
        const double da = normal.x * a.x + normal.y * a.y + normal.z * a.z - offset;
        const double db = normal.x * b.x + normal.y * b.y + normal.z * b.z - offset;
        if (da >= 0.0)
            kept.push_back(a);
        if ((da >= 0.0) != (db >= 0.0))
            kept.push_back(a + (b - a) * (da / (da - db)));
    }
    return kept;
}

} // namespace lamina::reference
