#pragma once

#include <span>
#include <string>
#include <vector>

namespace glslang {
class TIntermediate;
}

namespace lamina::tools {

/// A compiled stage of a program, and the names behind the source numbers of its `#line`s.
struct CompiledStage {
    const glslang::TIntermediate* tree;
    std::span<const std::string> files;
};

/// Checks that each input that `consumer` uses has an output of the same type in `producer`, by
/// location if it has one, else by name. glslang's own linker overlooks inputs that nothing feeds,
/// and its messages name no line.
/// Returns one "name:line: error: ..." per input that fails; the line is that of its first use.
std::vector<std::string> checkInterface(const CompiledStage& producer,
                                        const CompiledStage& consumer);

} // namespace lamina::tools
