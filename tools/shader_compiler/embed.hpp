#pragma once

#include "shader_tree.hpp"

#include <filesystem>
#include <string>

namespace lamina::tools {

/// C++ that defines lamina::gl::embeddedShaders() with the sources of `tree`. Byte arrays, because
/// compilers limit string literals to 64 KiB and sources may hold any byte.
std::string embeddedSource(const ShaderTree& tree);

/// A Makefile rule: `target` depends on `root` / each name of `tree`, and on `programs` if it is
/// not empty.
std::string dependencyFile(const std::filesystem::path& target, const std::filesystem::path& root,
                           const ShaderTree& tree, const std::filesystem::path& programs);

} // namespace lamina::tools
