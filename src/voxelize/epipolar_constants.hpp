#pragma once

#include <lamina/voxelize/epipolar_bits.hpp>

#include <glm/mat4x4.hpp>
#include <glm/vec4.hpp>

#include <cstddef>
#include <span>

namespace lamina::shared {

// The shaders' names for the GLM types.
using glm::ivec4;
using glm::mat4;
using glm::uvec4;
using glm::vec4;
#include "lamina/shared/epipolar_block.glsl"

} // namespace lamina::shared

namespace lamina {

static_assert(sizeof(shared::LaminaEpipolarSpace) == 9 * 16 &&
                  offsetof(shared::LaminaEpipolarMap, toTexel) == 5 * 16 &&
                  sizeof(shared::LaminaEpipolarMap) == 13 * 16,
              "std430");

/// Errors: InvalidArgument (see EpipolarBits::create()).
[[nodiscard]] Result<void> checkEpipolarLayout(const EpipolarLayout& layout);
[[nodiscard]] Result<void> checkEpipolarLayout(std::span<const EpipolarTransform> transforms,
                                               const EpipolarLayout& layout);

/// Distance along the axis from which on the epipole rule takes a point to be lit.
[[nodiscard]] double epipoleRuleDistance(const EpipolarTransform& transform);

/// The shaders' view of a transform. tile: its first texel.
[[nodiscard]] shared::LaminaEpipolarSpace makeEpipolarSpace(const EpipolarTransform& transform,
                                                            const EpipolarLayout& layout,
                                                            const glm::uvec2& tile);

} // namespace lamina
