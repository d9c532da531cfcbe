#pragma once

#include <glm/vec4.hpp>

#include <cstddef>

namespace lamina::shared {

// The shaders' names for the GLM types.
using glm::ivec4;
using glm::mat4;
using glm::uvec4;
using glm::vec4;
#include "lamina/shared/area_light_block.glsl"

} // namespace lamina::shared

namespace lamina {

static_assert(sizeof(shared::LaminaAreaLightConstants) == 3 * 16 &&
                  sizeof(shared::LaminaVirtualLight) == 3 * 16,
              "std430");
static_assert(sizeof(shared::LaminaGatherConstants) == 3 * 16, "std140");

} // namespace lamina
