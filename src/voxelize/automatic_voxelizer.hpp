#pragma once

#include <lamina/voxelize/voxelizer.hpp>

namespace lamina {

/// Backend::Automatic where the grid decides: the overlap backend for the grids that it takes, the
/// slicemap for the others. Both serve `desc.coverage`.
[[nodiscard]] Result<std::unique_ptr<Voxelizer>>
createAutomaticVoxelizer(const Device& device, const VoxelizerDesc& desc);

} // namespace lamina
