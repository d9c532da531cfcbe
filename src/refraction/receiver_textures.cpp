#include "refraction/receiver_textures.hpp"

#include "gl/host_texture.hpp"
#include "gl/objects.hpp"

#include <algorithm>
#include <bit>
#include <string>

namespace lamina {
namespace {

enum class Content : std::uint8_t { Colors, Numbers, Target };

std::string size(const glm::uvec2& pixels) {
    return std::to_string(pixels.x) + " x " + std::to_string(pixels.y);
}

const char* nameOf(Content content) {
    return content == Content::Numbers ? "unsigned integers"
           : content == Content::Colors
               ? "floats or normalized numbers"
               : "floats or normalized numbers that framebuffers can be drawn to with";
}

bool isDrawable(const std::shared_ptr<gl::DeviceState>& device, GLuint texture) {
    const auto probe = gl::Framebuffer::create(device, "lamina refraction target");
    device->gl.NamedFramebufferTexture(probe.id(), GL_COLOR_ATTACHMENT0, texture, 0);
    return device->gl.CheckNamedFramebufferStatus(probe.id(), GL_DRAW_FRAMEBUFFER) ==
           GL_FRAMEBUFFER_COMPLETE;
}

bool holds(const std::shared_ptr<gl::DeviceState>& device, GLuint texture, Content content) {
    GLint type = 0;
    device->gl.GetTextureLevelParameteriv(texture, 0, GL_TEXTURE_RED_TYPE, &type);
    if (content == Content::Numbers)
        return type == GL_UNSIGNED_INT;
    if (type != GL_FLOAT && type != GL_UNSIGNED_NORMALIZED && type != GL_SIGNED_NORMALIZED)
        return false;
    return content == Content::Colors || isDrawable(device, texture);
}

/// "4, which is no cube map"; empty if it is one.
std::string notOfTarget(const GladGLContext& gl, GLuint texture, GLenum target) {
    GLint found = 0;
    if (gl.IsTexture(texture))
        gl.GetTextureParameteriv(texture, GL_TEXTURE_TARGET, &found);
    if (static_cast<GLenum>(found) == target)
        return {};
    return std::to_string(texture) + (found == 0                ? ", which is none"
                                      : target == GL_TEXTURE_2D ? ", which is no 2D texture"
                                                                : ", which is no cube map");
}

/// Do look-ups with the texture's own filter find all levels that they need?
bool isComplete(const GladGLContext& gl, GLuint texture) {
    const auto value = [&](GLenum name) {
        GLint value = 0;
        gl.GetTextureParameteriv(texture, name, &value);
        return value;
    };
    const auto sizeOf = [&](GLint level) {
        GLint width = 0, height = 0;
        gl.GetTextureLevelParameteriv(texture, level, GL_TEXTURE_WIDTH, &width);
        gl.GetTextureLevelParameteriv(texture, level, GL_TEXTURE_HEIGHT, &height);
        return std::min(width, height) > 0 ? std::max(width, height) : 0;
    };
    if (value(GL_TEXTURE_IMMUTABLE_FORMAT) == GL_TRUE)
        return true;
    const GLint base = value(GL_TEXTURE_BASE_LEVEL);
    const GLint size = sizeOf(base);
    if (size == 0)
        return false;
    const GLint filter = value(GL_TEXTURE_MIN_FILTER);
    if (filter == GL_NEAREST || filter == GL_LINEAR)
        return true;
    const GLint last =
        std::min(base + static_cast<GLint>(std::bit_width(static_cast<std::uint32_t>(size))) - 1,
                 value(GL_TEXTURE_MAX_LEVEL));
    for (GLint level = base + 1; level <= last; ++level)
        if (sizeOf(level) == 0)
            return false;
    return base <= last;
}

Result<void> checkTexture(const std::shared_ptr<gl::DeviceState>& device, GLuint texture,
                          const glm::uvec2& pixels, std::string_view what, Content content) {
    const GladGLContext& gl = device->gl;
    const auto invalid = [&](const std::string& found) {
        return Error{ErrorCode::InvalidArgument,
                     "refraction: expected " + std::string(what) + " texture, 2D, of " +
                         size(pixels) + " pixels and " + nameOf(content) + ", found " + found};
    };
    if (const std::string found = notOfTarget(gl, texture, GL_TEXTURE_2D); !found.empty())
        return invalid("name " + found);
    GLint width = 0, height = 0;
    gl.GetTextureLevelParameteriv(texture, 0, GL_TEXTURE_WIDTH, &width);
    gl.GetTextureLevelParameteriv(texture, 0, GL_TEXTURE_HEIGHT, &height);
    const glm::uvec2 found(width, height);
    if (found != pixels)
        return invalid(size(found));
    if (!holds(device, texture, content))
        return invalid("another format");
    return {};
}

Result<void> checkDepths(const gl::DeviceState& device, GLuint texture, const glm::uvec2& pixels,
                         const char* operation) {
    const auto step = gl::depthStep(device, texture, pixels, operation);
    return step ? Result<void>{} : step.error();
}

} // namespace

Result<void> checkEnvironmentTexture(const std::shared_ptr<gl::DeviceState>& device, GLuint texture,
                                     GLenum target) {
    const auto invalid = [&](const std::string& found) {
        return Error{ErrorCode::InvalidArgument,
                     "environment: expected the name of a " +
                         std::string(target == GL_TEXTURE_2D ? "2D texture" : "cube map") +
                         ", found " + found};
    };
    if (const std::string found = notOfTarget(device->gl, texture, target); !found.empty())
        return invalid(found);
    const std::string name = std::to_string(texture);
    if (!isComplete(device->gl, texture))
        return invalid(name + ", which is incomplete; give it storage for all levels that its "
                              "GL_TEXTURE_MIN_FILTER asks for");
    if (!holds(device, texture, Content::Colors))
        return invalid(name + ", whose format is none of floats or normalized numbers");
    return {};
}

Result<void> checkReceiverTextures(const std::shared_ptr<gl::DeviceState>& device,
                                   const RefractionReceiver& receiver, GLuint target) {
    const glm::uvec2& pixels = receiver.view.size;
    if (auto fits = checkDepths(*device, receiver.depthTexture, pixels, "refraction"); !fits)
        return fits;
    if (receiver.colorDepthTexture != 0)
        if (auto fits = checkDepths(*device, receiver.colorDepthTexture, pixels,
                                    "refraction, of what lies behind");
            !fits)
            return fits;
    struct Part {
        GLuint texture;
        const char* what;
        Content content;
        bool isNeeded;
    };
    const Part parts[] = {{receiver.normalTexture, "a normal", Content::Colors, true},
                          {receiver.objectTexture, "an object", Content::Numbers, false},
                          {receiver.colorTexture, "a colour", Content::Colors, false},
                          {target, "a target", Content::Target, true}};
    for (const Part& part : parts)
        if (part.isNeeded || part.texture != 0)
            if (auto fits = checkTexture(device, part.texture, pixels, part.what, part.content);
                !fits)
                return fits;
    for (const GLuint read :
         {receiver.depthTexture, receiver.normalTexture, receiver.colorDepthTexture})
        if (read == target)
            return Error{ErrorCode::InvalidArgument,
                         "refraction: expected a target that is none of the textures of depths and "
                         "normals, found name " +
                             std::to_string(target) + " in both places; draw to another texture"};
    return {};
}

} // namespace lamina
