#pragma once

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

static_assert(sizeof(LaminaThicknessConstants) == 16 && sizeof(LaminaThicknessCounts) == 8,
              "std140, std430");

} // namespace lamina::shared
