#include "gl/host_texture.hpp"

#include <cmath>
#include <string>

namespace lamina::gl {

Result<double> depthStep(const DeviceState& device, GLuint texture, const glm::uvec2& size,
                         std::string_view operation) {
    const GladGLContext& gl = device.gl;
    const auto invalid = [&](const std::string& found) {
        return Error{ErrorCode::InvalidArgument,
                     std::string(operation) + ": expected the depths in a 2D texture of " +
                         std::to_string(size.x) + " x " + std::to_string(size.y) +
                         " texels, of a depth format or one with real red values, found " + found};
    };
    if (!gl.IsTexture(texture))
        return invalid("no texture of name " + std::to_string(texture));
    GLint target = 0;
    gl.GetTextureParameteriv(texture, GL_TEXTURE_TARGET, &target);
    if (target != GL_TEXTURE_2D)
        return invalid("a texture of target " + std::to_string(target));
    const auto level = [&](GLenum name) {
        GLint value = 0;
        gl.GetTextureLevelParameteriv(texture, 0, name, &value);
        return value;
    };
    const auto width = static_cast<GLuint>(level(GL_TEXTURE_WIDTH));
    const auto height = static_cast<GLuint>(level(GL_TEXTURE_HEIGHT));
    if (width != size.x || height != size.y)
        return invalid(std::to_string(width) + " x " + std::to_string(height) + " texels");
    // A depth format's type, else the red values'.
    const bool isDepth = level(GL_TEXTURE_DEPTH_TYPE) != GL_NONE;
    const GLint type = level(isDepth ? GL_TEXTURE_DEPTH_TYPE : GL_TEXTURE_RED_TYPE);
    if (type != GL_FLOAT && type != GL_UNSIGNED_NORMALIZED)
        return invalid("another format");
    GLint mode = GL_DEPTH_COMPONENT;
    if (isDepth && level(GL_TEXTURE_STENCIL_SIZE) > 0)
        gl.GetTextureParameteriv(texture, GL_DEPTH_STENCIL_TEXTURE_MODE, &mode);
    if (mode != GL_DEPTH_COMPONENT)
        return invalid("one whose stencil values shaders read (GL_DEPTH_STENCIL_TEXTURE_MODE)");
    if (type == GL_FLOAT)
        return 0.0;
    return std::ldexp(1.0, -level(isDepth ? GL_TEXTURE_DEPTH_SIZE : GL_TEXTURE_RED_SIZE));
}

} // namespace lamina::gl
