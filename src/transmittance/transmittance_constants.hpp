#pragma once

#include <glm/mat4x4.hpp>
#include <glm/vec4.hpp>

#include <cstddef>

namespace lamina::shared {

// The shaders' names for the GLM types.
using glm::ivec4;
using glm::mat4;
using glm::uvec4;
using glm::vec4;
#include "lamina/shared/transmittance_block.glsl"

static_assert(offsetof(LaminaTransmittanceConstants, gridFaces) == 5 * 16 &&
                  offsetof(LaminaTransmittanceConstants, attenuation) == 9 * 16 &&
                  offsetof(LaminaTransmittanceConstants, worldToOpaque) == 17 * 16 &&
                  sizeof(LaminaTransmittanceConstants) == 41 * 16,
              "std140");

} // namespace lamina::shared
