#pragma once

#include "gl/program_cache.hpp"

#include <glm/vec2.hpp>

#include <span>

namespace lamina::gl {

/// Runs a fragment shader once for each pixel of textures: the full-screen pass of the effects.
class ScreenPass {
public:
    /// `label` names the framebuffer in captures.
    LAMINA_API ScreenPass(std::shared_ptr<DeviceState> device, std::string_view label);

    /// Draws `program` (vertex stage "gl/screen.vert") over level 0 of `targets`, 2D textures of
    /// `size` pixels, as colour outputs 0, 1, ... Blending off. The caller binds what the program
    /// reads, and guards these bindings; all else is put back.
    LAMINA_API void draw(GLuint program, std::span<const GLuint> targets, const glm::uvec2& size);

private:
    std::shared_ptr<DeviceState> mDevice;
    Framebuffer mFramebuffer;
    VertexArray mVertexArray;
};

} // namespace lamina::gl
