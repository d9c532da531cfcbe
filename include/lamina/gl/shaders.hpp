#pragma once

#include <lamina/core/export.hpp>
#include <lamina/core/result.hpp>

#include <string>
#include <string_view>

namespace lamina {

/// GLSL of Lamina for the engine's own shaders, e.g. "lamina/grid.glsl": the file with its includes
/// in place, to be pasted after the shader's `#version 450` line and its `#define`s. The same files
/// are installed under share/lamina/shaders for engines with an include mechanism of their own. The
/// text numbers its lines as source strings 0, 1, ...; follow it by `#line` to number your own.
/// Errors: NotFound for an unknown name.
[[nodiscard]] LAMINA_API Result<std::string> shaderSource(std::string_view name);

} // namespace lamina
