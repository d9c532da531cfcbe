#include "shader_tree.hpp"

#include <algorithm>
#include <array>
#include <sstream>

namespace lamina::tools {
namespace {

constexpr std::array<std::string_view, 6> kStageExtensions = {".vert", ".tesc", ".tese",
                                                              ".geom", ".frag", ".comp"};

} // namespace

bool isEntryPoint(std::string_view name) {
    return std::ranges::any_of(kStageExtensions,
                               [name](std::string_view end) { return name.ends_with(end); });
}

Result<ShaderTree> readShaderTree(const std::filesystem::path& root) {
    ShaderTree tree;
    const gl::ShaderReader read = gl::readFrom(root.string());
    std::error_code failure;
    std::filesystem::recursive_directory_iterator entry(root, failure);
    for (; !failure && entry != std::filesystem::recursive_directory_iterator();
         entry.increment(failure)) {
        const std::string name = entry->path().lexically_relative(root).generic_string();
        if (!isEntryPoint(name) && !name.ends_with(".glsl"))
            continue;
        std::optional<std::string> source = read(name);
        if (!source)
            return Error{ErrorCode::InputOutput, name + ":1: error: cannot be read"};
        tree.emplace(name, std::move(*source));
    }
    if (failure)
        return Error{ErrorCode::InputOutput, root.string() + ": error: " + failure.message()};
    return tree;
}

gl::ShaderReader readerOf(const ShaderTree& tree) {
    return [&tree](std::string_view name) -> std::optional<std::string> {
        const auto found = tree.find(name);
        if (found == tree.end())
            return std::nullopt;
        return found->second;
    };
}

Result<std::vector<ProgramDeclaration>>
parsePrograms(const std::string& file, std::string_view text, const ShaderTree& tree) {
    std::vector<ProgramDeclaration> programs;
    std::istringstream lines{std::string(text)};
    std::string line;
    for (std::size_t number = 1; std::getline(lines, line); ++number) {
        const auto error = [&](const std::string& message) {
            return Error{ErrorCode::ShaderError,
                         file + ":" + std::to_string(number) + ": error: " + message};
        };
        std::istringstream words(line);
        ProgramDeclaration program;
        program.line = number;
        if (!(words >> program.name) || program.name.starts_with('#'))
            continue;
        if (!program.name.ends_with(':'))
            return error("expected NAME: STAGE STAGE ..., found " + line);
        program.name.pop_back();
        for (std::string stage; words >> stage;) {
            if (!isEntryPoint(stage) || !tree.contains(stage))
                return error("program " + program.name +
                             ": expected entry points of the tree, "
                             "found " +
                             stage);
            program.stages.push_back(stage);
        }
        if (program.stages.empty())
            return error("program " + program.name + ": expected at least one stage, found none");
        programs.push_back(std::move(program));
    }
    return programs;
}

} // namespace lamina::tools
