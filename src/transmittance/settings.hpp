#pragma once

#include "transmittance/light_faces.hpp"
#include "transmittance/transmittance_constants.hpp"

#include <lamina/transmittance/transmittance.hpp>

namespace lamina {

/// Width of the widest filter, in columns.
inline constexpr float kWidestFilter = 7.0f;

/// Errors: InvalidArgument.
[[nodiscard]] Result<void> checkTransmittance(const TransmittanceDesc& desc);
[[nodiscard]] Result<void> checkTransmittance(const TransmittanceSettings& settings);
[[nodiscard]] Result<void> checkTransmittance(NormalEncoding encoding);

/// What shaders know of the light, its faces and the settings; all but the opaque map.
[[nodiscard]] shared::LaminaTransmittanceConstants
makeTransmittanceConstants(const TransmittanceDesc& desc, const TransmittanceSettings& settings,
                           const TransmittanceLight& light, const LightFaces& faces);

} // namespace lamina
