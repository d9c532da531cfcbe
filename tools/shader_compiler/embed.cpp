#include "embed.hpp"

namespace lamina::tools {
namespace {

std::string byteArray(std::size_t index, const std::string& bytes) {
    // One byte more: an array may not be empty.
    std::string text = "const unsigned char kSource" + std::to_string(index) + "[" +
                       std::to_string(bytes.size() + 1) + "] = {";
    for (std::size_t i = 0; i < bytes.size(); ++i) {
        if (i % 32 == 0)
            text += "\n    ";
        text += std::to_string(static_cast<unsigned char>(bytes[i])) + ",";
    }
    return text + "};\n";
}

std::string tableRow(std::size_t index, const std::string& name, std::size_t size) {
    return "    {\"" + name + "\", {reinterpret_cast<const char*>(kSource" + std::to_string(index) +
           "), " + std::to_string(size) + "}},\n";
}

std::string escapedForMake(const std::filesystem::path& path) {
    std::string escaped;
    for (const char c : path.string()) {
        if (c == ' ' || c == '#')
            escaped.push_back('\\');
        if (c == '$')
            escaped.push_back('$');
        escaped.push_back(c);
    }
    return escaped;
}

} // namespace

std::string embeddedSource(const ShaderTree& tree) {
    std::string arrays;
    std::string table;
    std::size_t index = 0;
    for (const auto& [name, source] : tree) {
        arrays += byteArray(index, source);
        table += tableRow(index, name, source.size());
        ++index;
    }
    std::string text = "// Written by lamina_shader_compiler: edit the shaders instead.\n"
                       "#include \"gl/shader_library.hpp\"\n\n"
                       "namespace lamina::gl {\n";
    if (tree.empty())
        return text + "std::span<const EmbeddedShader> embeddedShaders() { return {}; }\n"
                      "} // namespace lamina::gl\n";
    return text + "namespace {\n" + arrays + "const EmbeddedShader kTable[] = {\n" + table +
           "};\n} // namespace\n\n"
           "std::span<const EmbeddedShader> embeddedShaders() { return kTable; }\n\n"
           "} // namespace lamina::gl\n";
}

std::string dependencyFile(const std::filesystem::path& target, const std::filesystem::path& root,
                           const ShaderTree& tree, const std::filesystem::path& programs) {
    std::string text = escapedForMake(target) + ":";
    for (const auto& [name, source] : tree)
        text += " \\\n  " + escapedForMake(root / name);
    if (!programs.empty())
        text += " \\\n  " + escapedForMake(programs);
    return text + "\n";
}

} // namespace lamina::tools
