#pragma once

#include "gl/device_state.hpp"

#include <lamina/refraction/refraction.hpp>

#include <memory>

namespace lamina {

/// Can apply() read the receiver's textures, and draw to `target`?
/// Errors: InvalidArgument, naming the texture.
[[nodiscard]] Result<void> checkReceiverTextures(const std::shared_ptr<gl::DeviceState>& device,
                                                 const RefractionReceiver& receiver, GLuint target);

} // namespace lamina
