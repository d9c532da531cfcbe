#pragma once

#include "gl/device_state.hpp"
#include "voxelize/slicemap_draw.hpp"

#include <lamina/grid/grid_transform.hpp>
#include <lamina/grid/voxel_grid.hpp>

#include <cstdint>
#include <vector>

namespace lamina {

/// The groups of 128 slices of one pass, and where their words stand in the buffer store.
struct SlicemapGroups {
    std::uint32_t first = 0;
    std::uint32_t count = 0;
    GLintptr offsetBytes = 0; ///< Of the storage binding, aligned.
    GLsizeiptr sizeBytes = 0;
    std::uint32_t skippedWords = 0; ///< From there to the first word.
};

/// The groups of all slices, pass by pass; at most `mostPerPass` in one, fewer where a storage
/// binding cannot hold them. Errors: DeviceLimit (128 slices of the columns exceed a storage
/// binding).
[[nodiscard]] Result<std::vector<SlicemapGroups>> slicemapGroups(const gl::DeviceState& device,
                                                                 const GridTransform& transform,
                                                                 VoxelStore store,
                                                                 std::uint32_t mostPerPass);

/// Sets the depths of the triangles that matter to the slices of the pass, in uniform ranges.
void limitDepths(SlicemapPass& pass, const GridTransform& transform, Coverage coverage);

} // namespace lamina
