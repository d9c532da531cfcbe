#pragma once

#include "voxelize/volume_constants.hpp"

namespace lamina::shared {

using glm::uvec4;
using glm::vec4;
#include "lamina/shared/attribute_block.glsl"

static_assert(sizeof(LaminaAttributeConstants) == 80, "std140");
static_assert(LAMINA_MAX_MATERIALS <= 1 << LAMINA_MATERIAL_BITS, "ids fit the records");

} // namespace lamina::shared
