#pragma once

#include "gl/view_constants.hpp"

#include <glm/mat4x4.hpp>
#include <glm/vec4.hpp>

#include <cstddef>
#include <cstdint>

namespace lamina::shared {

// The shaders' names for the GLM types.
using glm::mat4;
using glm::uvec4;
using glm::vec4;
using uint = std::uint32_t;
#include "lamina/shared/refraction_block.glsl"

static_assert(offsetof(LaminaRefractionConstants, surface) == 11 * 16 &&
                  sizeof(LaminaRefractionConstants) == 18 * 16,
              "std140");
static_assert(sizeof(LaminaThicknessConstants) == 16 && sizeof(LaminaThicknessCounts) == 8 &&
                  sizeof(LaminaRefractionCounts) == 4,
              "std140, std430");

} // namespace lamina::shared
