#pragma once

#include <lamina/voxelize/voxelizer.hpp>

namespace lamina {

/// Backend::Slicemap, Backend::LocalSlicemap and Backend::MrtSlicemap: desc.backend is one of them.
/// MrtSlicemap without desc.store takes the texture store.
[[nodiscard]] Result<std::unique_ptr<Voxelizer>> createSlicemapVoxelizer(const Device& device,
                                                                         const VoxelizerDesc& desc);

} // namespace lamina
