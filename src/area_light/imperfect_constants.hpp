#pragma once

#include <glm/mat4x4.hpp>
#include <glm/vec4.hpp>

namespace lamina::shared {

// The shaders' names for the GLM types.
using glm::mat4;
using glm::uvec4;
using glm::vec4;
#include "lamina/shared/imperfect_block.glsl"

static_assert(sizeof(LaminaSampleConstants) == 6 * 16 && sizeof(LaminaSplatConstants) == 4 * 16,
              "std140");
static_assert(sizeof(LaminaPointSample) == 3 * 16 && sizeof(LaminaImperfectMap) == 3 * 16,
              "std430");

} // namespace lamina::shared
