#pragma once

#include "grid/grid_constants.hpp"

#include <glm/mat4x4.hpp>

#include <array>
#include <cstddef>
#include <cstdint>

namespace lamina::shared {

using uint = std::uint32_t;
#include "lamina/shared/volume_block.glsl"

} // namespace lamina::shared

namespace lamina {

/// The content of LaminaVolumeBlock (lamina/volume.glsl).
struct VolumeBlock {
    shared::LaminaVolumeConstants constants{};
    std::array<float, LAMINA_MAX_SLICE_BOUNDARIES> boundaries{};
};
static_assert(offsetof(VolumeBlock, boundaries) ==
                      sizeof(shared::LaminaGridConstants) + sizeof(glm::uvec4) &&
                  sizeof(shared::LaminaGridConstants) % 16 == 0 && sizeof(VolumeBlock) <= 16384,
              "std140, within the least GL_MAX_UNIFORM_BLOCK_SIZE");
static_assert(offsetof(shared::LaminaVolumeDrawConstants, depthRange) == 96 &&
                  offsetof(shared::LaminaVolumeDrawConstants, normalToWorld) == 128 &&
                  offsetof(shared::LaminaVolumeDrawConstants, size) == 176 &&
                  offsetof(shared::LaminaVolumeDrawConstants, settings) == 208,
              "std140");
static_assert(sizeof(shared::LaminaMaterialConstants) * LAMINA_MAX_MATERIALS <= 16384,
              "within the least GL_MAX_UNIFORM_BLOCK_SIZE");

} // namespace lamina
