#pragma once

#include <lamina/shadow_volumes/shadow_volumes.hpp>

#include <glm/mat4x4.hpp>
#include <glm/vec4.hpp>

#include <cstddef>

namespace lamina::shared {

// The shaders' names for the GLM types.
using glm::mat4;
using glm::uvec4;
using glm::vec4;
using uint = std::uint32_t;
#include "lamina/shared/shadow_volumes_block.glsl"

} // namespace lamina::shared

namespace lamina {

static_assert(offsetof(shared::LaminaShadowFrame, size) == 14 * 16 &&
                  sizeof(shared::LaminaShadowFrame) == 16 * 16 &&
                  sizeof(shared::LaminaShadowDraw) == 5 * 16,
              "std140");
static_assert(sizeof(shared::LaminaShadowCaster) == 2 * 16 &&
                  sizeof(shared::LaminaShadowCommand) == 5 * 4,
              "std430");

/// What the shaders know of a frame.
struct ShadowFrame {
    shared::LaminaShadowFrame constants{};
    glm::dvec3 origin{0.0}; ///< Of origin space, world space.
};

/// depthStep: least step of the depth texture's values, 0 for a float format.
/// Errors: InvalidArgument (a view without an inverse, a light that is nowhere).
[[nodiscard]] Result<ShadowFrame> makeShadowFrame(const ShadowScene& scene,
                                                  const ShadowVolumesDesc& desc, double depthStep);

/// Words of 32 layers.
[[nodiscard]] inline std::uint32_t layerWords(std::uint32_t layers) {
    return (layers + 31) / 32;
}

} // namespace lamina
