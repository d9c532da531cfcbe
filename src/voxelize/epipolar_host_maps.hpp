#pragma once

#include "gl/device_state.hpp"
#include "voxelize/epipolar_constants.hpp"

#include <lamina/voxelize/light_depth_map.hpp>

#include <cstddef>

namespace lamina {

/// Checks a host's depth map against its texture and the transform's light, and makes the rectify
/// kernel's view of it. index: of the map in the call, and of the shadow volume.
/// Errors: InvalidArgument.
[[nodiscard]] Result<shared::LaminaEpipolarMap> makeHostMap(const gl::DeviceState& device,
                                                            const LightDepthMap& map,
                                                            const EpipolarTransform& transform,
                                                            std::size_t index);

} // namespace lamina
