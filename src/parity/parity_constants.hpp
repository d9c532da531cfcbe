#pragma once

#include <glm/vec4.hpp>

#include <cstddef>

namespace lamina::shared {

// The shaders' names for the types.
using glm::uvec4;
using glm::vec4;
using uint = unsigned int;
#include "lamina/shared/parity_block.glsl"

/// The content of LaminaParityBlock (lamina/parity.glsl).
struct ParityBlock {
    uvec4 count{};
    LaminaSpriteConstants sprites[LAMINA_PARITY_MAX_SPRITES]{};
};

static_assert(sizeof(LaminaSpriteConstants) == 80 && offsetof(ParityBlock, sprites) == 16 &&
                  offsetof(LaminaSpriteConstants, scale) == 48,
              "std140");
static_assert(sizeof(LaminaSpriteReport) == 24, "std430");

} // namespace lamina::shared
