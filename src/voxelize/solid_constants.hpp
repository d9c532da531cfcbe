#pragma once

#include "voxelize/overlap_constants.hpp"

#include <glm/vec4.hpp>

namespace lamina::shared {

#include "lamina/shared/solid_block.glsl"

static_assert(sizeof(LaminaSolidLine) == 64, "std140");
static_assert(sizeof(LaminaSolidPart) == 48, "std140");

} // namespace lamina::shared
