#pragma once

#include <lamina/gl/view.hpp>

#include <glm/vec4.hpp>

#include <cstddef>

namespace lamina::shared {

// The shaders' names for the GLM types.
using glm::mat4;
using glm::uvec4;
using glm::vec4;
#include "lamina/shared/view_block.glsl"

} // namespace lamina::shared

namespace lamina {

static_assert(sizeof(shared::LaminaViewConstants) == 11 * 16 &&
                  offsetof(shared::LaminaViewConstants, viewpoint) == 8 * 16,
              "std140");

/// The shaders' view of a View.
/// Errors: those of viewpoint(), prefixed by `operation`.
[[nodiscard]] LAMINA_API Result<shared::LaminaViewConstants>
makeViewConstants(const View& view, std::string_view operation);

} // namespace lamina
