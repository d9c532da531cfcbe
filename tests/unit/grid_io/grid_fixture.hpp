#pragma once

#include "support/temporary_folder.hpp"

#include <lamina/grid/bit_grid.hpp>

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <random>
#include <string>
#include <vector>

namespace lamina::test {

inline BitGrid emptyGrid(const Box3& box, const glm::uvec3& counts, Axis axis) {
    return *BitGrid::create(*GridTransform::box(box, counts, axis));
}

/// Sets world voxel (i,j,k) of a box grid by its centre: the plainest way, through no index of
/// ours.
inline void setWorld(BitGrid& grid, const glm::uvec3& counts, const glm::uvec3& voxel) {
    const Box3& box = grid.transform().boxBounds();
    const glm::dvec3 center = box.min + (glm::dvec3(voxel) + 0.5) * box.size() / glm::dvec3(counts);
    grid.set(*grid.transform().voxelAt(center));
}

/// About a third of the voxels, from noise, with a full and an empty region as real grids have.
inline BitGrid randomGrid(const Box3& box, const glm::uvec3& counts, Axis axis, unsigned seed = 1) {
    BitGrid grid = emptyGrid(box, counts, axis);
    std::mt19937 random(seed);
    for (std::uint32_t k = 0; k < counts.z; ++k)
        for (std::uint32_t j = 0; j < counts.y; ++j)
            for (std::uint32_t i = 0; i < counts.x; ++i) {
                const bool noise = random() % 3 == 0;
                const bool full = i >= counts.x / 2 && j < (counts.y + 1) / 2;
                const bool empty = k < counts.z / 3 && j >= (counts.y + 1) / 2;
                if (full || (noise && !empty))
                    setWorld(grid, counts, {i, j, k});
            }
    return grid;
}

/// A byte, 0 or 1, for each voxel, x fastest, then y, then z, asked one by one by world position.
inline std::string occupancy(const BitGrid& grid, const glm::uvec3& counts) {
    const Box3& box = grid.transform().boxBounds();
    std::string bytes;
    for (std::uint32_t k = 0; k < counts.z; ++k)
        for (std::uint32_t j = 0; j < counts.y; ++j)
            for (std::uint32_t i = 0; i < counts.x; ++i)
                bytes += static_cast<char>(grid.at(box.min + (glm::dvec3(i, j, k) + 0.5) *
                                                                 box.size() / glm::dvec3(counts)));
    return bytes;
}

/// A box of `counts` voxels of the given edges with its low corner away from the origin.
inline Box3 boxOf(const glm::uvec3& counts, const glm::dvec3& edge) {
    const glm::dvec3 low(-1.25, 3.5, 0.75);
    return {low, low + glm::dvec3(counts) * edge};
}

} // namespace lamina::test
