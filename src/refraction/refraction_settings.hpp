#pragma once

#include "refraction/refraction_constants.hpp"

#include <lamina/refraction/refraction.hpp>

namespace lamina {

/// Of settings and materials.
inline constexpr float kGreatestIndex = 4.0f;

/// Errors: InvalidArgument, naming the value.
[[nodiscard]] Result<void> checkSettings(const RefractionSettings& settings);

/// Writes the settings' part of the block; modes.x holds nothing else then.
void writeSettings(const RefractionSettings& settings, RefractionModel model,
                   shared::LaminaRefractionConstants& block);

} // namespace lamina
