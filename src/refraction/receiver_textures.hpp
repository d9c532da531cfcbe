#pragma once

#include "gl/device_state.hpp"

#include <lamina/refraction/refraction.hpp>

#include <memory>

namespace lamina {

/// Can an Environment be loaded from the texture, which should be of `target`: GL_TEXTURE_2D or
/// GL_TEXTURE_CUBE_MAP? Errors: InvalidArgument.
[[nodiscard]] Result<void> checkEnvironmentTexture(const std::shared_ptr<gl::DeviceState>& device,
                                                   GLuint texture, GLenum target);

/// Can apply() read the receiver's textures, and draw to `target`?
/// Errors: InvalidArgument, naming the texture.
[[nodiscard]] Result<void> checkReceiverTextures(const std::shared_ptr<gl::DeviceState>& device,
                                                 const RefractionReceiver& receiver, GLuint target);

} // namespace lamina
