#pragma once

#include <lamina/voxelize/voxelizer.hpp>

namespace lamina {

/// Backend::Volume.
[[nodiscard]] Result<std::unique_ptr<Voxelizer>>
createVolumeBitsVoxelizer(const Device& device, const VoxelizerDesc& desc);

} // namespace lamina
