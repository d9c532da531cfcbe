#include "gl/shader_library.hpp"

#include <lamina/gl/shaders.hpp>

#include <algorithm>

namespace lamina {

Result<std::string> shaderSource(std::string_view name) {
    auto shader = gl::loadShader(name);
    if (!shader)
        return shader.error();
    return std::move(shader->text);
}

namespace gl {

const EmbeddedShader* findEmbeddedShader(std::string_view name) {
    const std::span<const EmbeddedShader> all = embeddedShaders();
    const auto found = std::ranges::lower_bound(all, name, {}, &EmbeddedShader::name);
    return found != all.end() && found->name == name ? &*found : nullptr;
}

ShaderReader libraryReader(std::string overrideDirectory) {
    ShaderReader disk;
    if (!overrideDirectory.empty())
        disk = readFrom(std::move(overrideDirectory));
    return [disk](std::string_view name) -> std::optional<std::string> {
        if (disk) {
            if (std::optional<std::string> source = disk(name))
                return source;
        }
        if (const EmbeddedShader* embedded = findEmbeddedShader(name))
            return std::string(embedded->source);
        return std::nullopt;
    };
}

Result<ShaderText> loadShader(std::string_view name, const std::string& overrideDirectory) {
    return flattenShader(name, libraryReader(overrideDirectory));
}

} // namespace gl
} // namespace lamina
