#include "gl/screen_pass.hpp"

#include "gl/fragment_guards.hpp"
#include "gl/state_guard.hpp"

namespace lamina::gl {

ScreenPass::ScreenPass(std::shared_ptr<DeviceState> device, std::string_view label)
    : mDevice(std::move(device))
    , mFramebuffer(Framebuffer::create(mDevice, label))
    , mVertexArray(VertexArray::create(mDevice, label)) {}

void ScreenPass::draw(GLuint program, std::span<const GLuint> targets, const glm::uvec2& size) {
    const GladGLContext& gl = mDevice->gl;
    RasterStateGuard guard(*mDevice, 0);
    const auto count = static_cast<GLuint>(targets.size());
    const BlendStateGuard blendGuard(*mDevice, count, Blending::Off);
    guard.setHostPrimitiveRestart(false);
    std::vector<GLenum> outputs;
    for (GLuint i = 0; i < count; ++i) {
        gl.NamedFramebufferTexture(mFramebuffer.id(), GL_COLOR_ATTACHMENT0 + i, targets[i], 0);
        outputs.push_back(GL_COLOR_ATTACHMENT0 + i);
    }
    gl.NamedFramebufferDrawBuffers(mFramebuffer.id(), static_cast<GLsizei>(count), outputs.data());
    gl.BindFramebuffer(GL_DRAW_FRAMEBUFFER, mFramebuffer.id());
    gl.ViewportIndexedf(0, 0.0f, 0.0f, static_cast<float>(size.x), static_cast<float>(size.y));
    gl.BindVertexArray(mVertexArray.id());
    gl.UseProgram(program);
    gl.DrawArrays(GL_TRIANGLES, 0, 3);
    // The host may delete its textures; the framebuffer must not keep them.
    for (GLuint i = 0; i < count; ++i)
        gl.NamedFramebufferTexture(mFramebuffer.id(), GL_COLOR_ATTACHMENT0 + i, 0, 0);
}

} // namespace lamina::gl
