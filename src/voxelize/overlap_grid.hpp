#pragma once

#include "gl/device_state.hpp"
#include "voxelize/overlap_constants.hpp"

#include <lamina/grid/grid_transform.hpp>

#include <cstdint>
#include <vector>

namespace lamina {

/// A box of voxels whose words one storage binding holds: layers of all columns, or rows of one
/// layer where even a layer is too large.
struct GridPart {
    glm::ivec3 low{0};  ///< First voxel.
    glm::ivec3 high{0}; ///< Last voxel, inclusive.
    GLintptr offsetBytes = 0;
    GLsizeiptr sizeBytes = 0;
    std::uint32_t skippedTexels = 0; ///< From the binding's start, which is aligned, to the part.

    /// Columns in x and y together.
    [[nodiscard]] std::uint64_t columns() const {
        const glm::ivec3 counts = high - low + 1;
        return static_cast<std::uint64_t>(counts.x) * static_cast<std::uint64_t>(counts.y);
    }
    /// Layers of 128 slices.
    [[nodiscard]] int layers() const { return (high.z >> 7) - (low.z >> 7) + 1; }
};

/// Slices of a part at most: bounds the loops of one invocation.
inline constexpr std::uint32_t kOverlapSlicesPerPart = 16384;

/// Does the backend take grids of this projection and distribution?
[[nodiscard]] bool isOverlapGrid(const GridTransform& transform);

/// The parts of a grid, few and in order.
/// Errors: Unsupported (perspective, or slices that are not linear), DeviceLimit.
[[nodiscard]] Result<std::vector<GridPart>> gridParts(const gl::DeviceState& device,
                                                      const GridTransform& transform);

[[nodiscard]] std::uint32_t maxOverlapColumns(const gl::DeviceState& device);
[[nodiscard]] std::uint32_t maxOverlapSlices(const gl::DeviceState& device);

/// Fills in what the shaders need to know of the part.
void writeGridPart(const GridPart& part, const GridTransform& transform,
                   shared::LaminaOverlapConstants& block);

/// World to grid coordinates as one affine matrix.
[[nodiscard]] glm::dmat4 overlapWorldToGrid(const GridTransform& transform);

} // namespace lamina
