#pragma once

#include "gl/shader_source.hpp"

#include <span>
#include <string>
#include <string_view>

namespace lamina::gl {

/// One file of shaders/ as it was when the library was built.
struct EmbeddedShader {
    std::string_view name; ///< Under the shader root: "voxelize/slicemap.frag".
    std::string_view source;
};

/// All of them, by name in ascending order. The build's shader compiler writes the definition.
[[nodiscard]] std::span<const EmbeddedShader> embeddedShaders();

/// The embedded file of this name, or null. Cost: a binary search.
[[nodiscard]] const EmbeddedShader* findEmbeddedShader(std::string_view name);

/// Reads each source from `overrideDirectory` (a shader root; empty: none) if it is there, else
/// from the library itself.
[[nodiscard]] ShaderReader libraryReader(std::string overrideDirectory = {});

/// The shader `name` with its includes in place, each file read through libraryReader().
/// Errors: those of flattenShader(); without an override directory only NotFound for an unknown
/// name can happen, because the build flattened everything once.
[[nodiscard]] Result<ShaderText> loadShader(std::string_view name,
                                            const std::string& overrideDirectory = {});

} // namespace lamina::gl
