#pragma once

#include <lamina/voxelize/voxelizer.hpp>

namespace lamina {

/// Backend::Slicemap.
[[nodiscard]] Result<std::unique_ptr<Voxelizer>> createSlicemapVoxelizer(const Device& device,
                                                                         const VoxelizerDesc& desc);

} // namespace lamina
