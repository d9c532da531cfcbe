#include "target.hpp"

#include <cstddef>

namespace example {

Target makeTarget(const HostGl& gl, GLsizei width, GLsizei height) {
    constexpr GLsizei kSamples = 4;
    GLuint framebuffers[2], storage[3];
    gl.CreateFramebuffers(2, framebuffers);
    gl.CreateRenderbuffers(3, storage);
    gl.NamedRenderbufferStorageMultisample(storage[0], kSamples, GL_RGBA8, width, height);
    gl.NamedRenderbufferStorageMultisample(storage[1], kSamples, GL_DEPTH_COMPONENT24, width,
                                           height);
    gl.NamedRenderbufferStorageMultisample(storage[2], 0, GL_RGBA8, width, height);
    gl.NamedFramebufferRenderbuffer(framebuffers[0], GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER,
                                    storage[0]);
    gl.NamedFramebufferRenderbuffer(framebuffers[0], GL_DEPTH_ATTACHMENT, GL_RENDERBUFFER,
                                    storage[1]);
    gl.NamedFramebufferRenderbuffer(framebuffers[1], GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER,
                                    storage[2]);
    return {framebuffers[0], framebuffers[1], width, height};
}

void beginFrame(const HostGl& gl, const Target& target) {
    gl.BindFramebuffer(GL_DRAW_FRAMEBUFFER, target.samples);
    gl.Viewport(0, 0, target.width, target.height);
    gl.Enable(GL_DEPTH_TEST);
    const float farthest = 1.0f;
    gl.ClearNamedFramebufferfv(target.samples, GL_DEPTH, 0, &farthest);
}

lamina::Image readBack(const HostGl& gl, const Target& target) {
    // Images have their first row at the top.
    gl.BlitNamedFramebuffer(target.samples, target.resolved, 0, 0, target.width, target.height, 0,
                            target.height, target.width, 0, GL_COLOR_BUFFER_BIT, GL_NEAREST);
    gl.BindFramebuffer(GL_READ_FRAMEBUFFER, target.resolved);
    lamina::Image image{
        static_cast<std::uint32_t>(target.width), static_cast<std::uint32_t>(target.height), {}};
    image.rgba.resize(std::size_t{4} * image.width * image.height);
    gl.ReadPixels(0, 0, target.width, target.height, GL_RGBA, GL_UNSIGNED_BYTE, image.rgba.data());
    return image;
}

} // namespace example
