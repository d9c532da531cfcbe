#pragma once

#include "voxelize/voxel_ranks.hpp"

#include <lamina/voxelize/voxel_attributes.hpp>

#include <optional>

namespace lamina {

struct VoxelAttributes::Impl {
    std::shared_ptr<gl::DeviceState> device;
    VoxelAttributesDesc desc;
    VoxelRanks ranks;
    gl::Buffer records;
    gl::Texture recordTexture; ///< The records as a texel buffer, as many as there is room for.
    std::uint64_t capacity = 0;
    std::optional<GridTransform> transform;

    /// Room for the records of so many voxels. Errors: DeviceLimit, OutOfMemory.
    [[nodiscard]] Result<void> reserve(std::uint64_t voxels);
};

} // namespace lamina
