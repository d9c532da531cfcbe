#pragma once

#include <lamina/voxelize/voxelizer.hpp>

namespace lamina {

/// Backend::Overlap.
[[nodiscard]] Result<std::unique_ptr<Voxelizer>> createOverlapVoxelizer(const Device& device,
                                                                        const VoxelizerDesc& desc);

} // namespace lamina
