#pragma once

#include "gl/device_state.hpp"
#include "refraction/refraction_constants.hpp"

#include <lamina/refraction/refraction.hpp>

namespace lamina {

/// Errors: InvalidArgument, naming the value.
[[nodiscard]] Result<void> checkSettings(const RefractionSettings& settings);

/// Writes the settings' part of the block; modes.x holds nothing else then.
void writeSettings(const RefractionSettings& settings, RefractionModel model,
                   shared::LaminaRefractionConstants& block);

/// Is `texture` a 2D texture of `size` pixels? `what`: for the error's text.
/// Errors: InvalidArgument.
[[nodiscard]] Result<void> checkTexture(const gl::DeviceState& device, GLuint texture,
                                        const glm::uvec2& size, std::string_view what);

} // namespace lamina
