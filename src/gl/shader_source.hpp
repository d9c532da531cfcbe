#pragma once

// What the shader library and the build-time shader compiler share: includes, permutations and
// compiler logs. Plain C++, no GL.

#include <lamina/core/result.hpp>

#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace lamina::gl {

/// A shader with its includes in place. `#line` directives in `text` keep each line's origin: line
/// N of `files[S]` has the number S * kLinesPerSource + N and the source number S. Both, because
/// Mesa forgets the source number of most errors.
struct ShaderText {
    std::string text;               ///< Without `#version`: assemble() writes it.
    std::vector<std::string> files; ///< Names under the shader root; [0] is the shader itself.
};

inline constexpr std::size_t kLinesPerSource = 100'000;

/// `#define name value`.
struct ShaderDefine {
    std::string name;
    std::string value;
    bool operator==(const ShaderDefine&) const = default;
};

/// A name that a shader is compiled with several values of.
struct PermutationAxis {
    std::string name;
    std::vector<std::string> values;
    bool operator==(const PermutationAxis&) const = default;
};

/// Gives the content of a source by its name under the shader root, e.g. "lamina/queries.glsl";
/// nothing when there is no such source.
using ShaderReader = std::function<std::optional<std::string>(std::string_view name)>;

/// Reads sources from files under `root`; a name that leaves `root` names nothing.
[[nodiscard]] ShaderReader readFrom(std::string root);

/// Replaces each `#include <name>` of the source `name` by the content of that source, the first
/// time it occurs; later ones become blank lines. What the pre-processor would keep for C++ only
/// (`__cplusplus`), `#pragma once` and `#version 450 core` become blank lines too.
/// Errors, with text "name:line: error: ...": NotFound for a missing source; ShaderError for a
/// cycle, an include inside an `#if` other than the file's include guard (its content would be lost
/// to later includers), a malformed include, a version other than 450 core, an `#if` without
/// `#endif`.
[[nodiscard]] Result<ShaderText> flattenShader(std::string_view name, const ShaderReader& read);

/// Finds the lines `// permute NAME = VALUE VALUE ...` of an entry point's own source.
/// Errors: ShaderError, "name:line: error: ..." for a line of another form or a name seen twice.
[[nodiscard]] Result<std::vector<PermutationAxis>> parsePermutations(std::string_view name,
                                                                     std::string_view source);

/// Every combination of the axes' values, the last axis fastest; one empty set without axes.
[[nodiscard]] std::vector<std::vector<ShaderDefine>>
expandPermutations(std::span<const PermutationAxis> axes);

/// What a GL compiler is given: `#version 450 core`, the definitions, the text.
[[nodiscard]] std::string assemble(const ShaderText& shader, std::span<const ShaderDefine> defines);

/// "name:line" for the source and line number that a compiler reports of a flattened text; empty if
/// they are not of it.
[[nodiscard]] std::string describePlace(std::size_t source, std::size_t line,
                                        std::span<const std::string> files);

/// Rewrites the places in a compiler's log, "0:12(5): error: x" (Mesa), "0(12) : error C1: x"
/// (NVIDIA), "ERROR: 0:12: x" (AMD, Intel, glslang), as "files[0]:12: error: x". Lines without a
/// place, or with one that describePlace() does not know, stay as they are.
[[nodiscard]] std::string translateLog(std::string_view log, std::span<const std::string> files);

} // namespace lamina::gl
