#pragma once

#include <lamina/voxelize/voxelizer.hpp>

namespace lamina {

/// The store in which Backend::MrtSlicemap gathers 1024 slices faster on this device: measured at
/// the first call, which waits for the GPU. The texture store if it cannot be measured.
[[nodiscard]] VoxelStore fasterSlicemapStore(const Device& device);

} // namespace lamina
