#pragma once

#include "gl/shader_source.hpp"

#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <vector>

namespace lamina::tools {

/// Every shader source under a root directory, by name ("voxelize/slicemap.frag").
using ShaderTree = std::map<std::string, std::string, std::less<>>;

/// A line `NAME: STAGE STAGE ...` of the program list.
struct ProgramDeclaration {
    std::string name;
    std::vector<std::string> stages; ///< Names of entry points.
    std::size_t line = 0;
};

/// Reads all files with the extension of a stage or of an include.
Result<ShaderTree> readShaderTree(const std::filesystem::path& root);

/// Whether a name has the extension of an entry point: vert, tesc, tese, geom, frag or comp.
bool isEntryPoint(std::string_view name);

gl::ShaderReader readerOf(const ShaderTree& tree);

/// Parses the program list; blank lines and lines that begin with # mean nothing.
/// Errors: ShaderError, "file:line: error: ..." for another form or an unknown entry point.
Result<std::vector<ProgramDeclaration>>
parsePrograms(const std::string& file, std::string_view text, const ShaderTree& tree);

} // namespace lamina::tools
