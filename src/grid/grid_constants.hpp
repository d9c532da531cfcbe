#pragma once

#include <lamina/core/export.hpp>
#include <lamina/grid/grid_transform.hpp>

#include <glm/mat4x4.hpp>
#include <glm/vec4.hpp>

#include <array>
#include <cstddef>

namespace lamina::shared {

// The shaders' names for the GLM types.
using glm::dvec4;
using glm::uvec4;
using glm::vec4;
#include "lamina/shared/grid_block.glsl"

} // namespace lamina::shared

namespace lamina {

/// The content of LaminaGridBlock (lamina/grid.glsl).
struct GridBlock {
    shared::LaminaGridConstants constants{};
    std::array<float, LAMINA_MAX_SLICE_BOUNDARIES> boundaries{};
};
static_assert(offsetof(GridBlock, boundaries) == 80 && sizeof(GridBlock) <= 16384,
              "std140, within the least GL_MAX_UNIFORM_BLOCK_SIZE");
static_assert(offsetof(shared::LaminaDrawConstants, depthRange) == 96 &&
                  offsetof(shared::LaminaDrawConstants, size) == 160 &&
                  offsetof(shared::LaminaDrawConstants, dilation) == 192,
              "std140");

/// hasLocalRanges: sets LAMINA_GRID_LOCAL.
[[nodiscard]] LAMINA_API GridBlock makeGridBlock(const GridTransform& transform,
                                                 bool hasLocalRanges = false);

/// LAMINA_GRID_* flags of a grid.
[[nodiscard]] std::uint32_t gridFlags(const GridTransform& transform);

} // namespace lamina
