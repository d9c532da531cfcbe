#pragma once

#include <glm/vec4.hpp>

#include <cstddef>

namespace lamina::shared {

// The shaders' names for the types.
using glm::dvec4;
using glm::ivec4;
using glm::uvec4;
using glm::vec4;
using uint = unsigned int;
#include "lamina/shared/overlap_block.glsl"

static_assert(offsetof(LaminaOverlapConstants, low) == 96 &&
                  offsetof(LaminaOverlapConstants, source) == 160 &&
                  offsetof(LaminaOverlapConstants, normalToWorld) == 224 &&
                  sizeof(LaminaOverlapConstants) == 288,
              "std140");
static_assert(sizeof(LaminaOverlapClass) == 16, "std430");

} // namespace lamina::shared
