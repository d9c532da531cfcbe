#include "gl/support/host_draw.hpp"

#include <glm/gtc/type_ptr.hpp>

namespace lamina::test {

const char* const kWorldVertexShader = R"(#version 450 core
layout(location = 0) uniform mat4 worldToClip;
layout(location = 0) in vec3 position;
out vec3 world;
void main() {
    world = position;
    gl_Position = worldToClip * vec4(position, 1.0);
}
)";

gl::Texture makeTexture(const Device& device, GLenum format, const glm::uvec2& size) {
    auto texture = gl::Texture::create(device.state(), "test", GL_TEXTURE_2D);
    device.state()->gl.TextureStorage2D(texture.id(), 1, format, static_cast<GLsizei>(size.x),
                                        static_cast<GLsizei>(size.y));
    return texture;
}

gl::Framebuffer makeFramebuffer(const Device& device, GLuint depth,
                                std::span<const GLuint> colors) {
    const GladGLContext& gl = device.state()->gl;
    auto framebuffer = gl::Framebuffer::create(device.state(), "test");
    if (depth != 0)
        gl.NamedFramebufferTexture(framebuffer.id(), GL_DEPTH_ATTACHMENT, depth, 0);
    std::vector<GLenum> outputs;
    for (const GLuint color : colors) {
        outputs.push_back(GL_COLOR_ATTACHMENT0 + static_cast<GLenum>(outputs.size()));
        gl.NamedFramebufferTexture(framebuffer.id(), outputs.back(), color, 0);
    }
    if (outputs.empty())
        gl.NamedFramebufferDrawBuffer(framebuffer.id(), GL_NONE);
    else
        gl.NamedFramebufferDrawBuffers(framebuffer.id(), static_cast<GLsizei>(outputs.size()),
                                       outputs.data());
    return framebuffer;
}

gl::VertexArray makeVertexArray(const Device& device, const MeshView& mesh) {
    const GladGLContext& gl = device.state()->gl;
    auto vertexArray = gl::VertexArray::create(device.state(), "test");
    gl.VertexArrayVertexBuffer(vertexArray.id(), 0, mesh.vertexBuffer,
                               static_cast<GLintptr>(mesh.positionOffsetBytes),
                               static_cast<GLsizei>(mesh.vertexStrideBytes));
    gl.VertexArrayElementBuffer(vertexArray.id(), mesh.indexBuffer);
    gl.EnableVertexArrayAttrib(vertexArray.id(), 0);
    gl.VertexArrayAttribFormat(vertexArray.id(), 0, 3, GL_FLOAT, GL_FALSE, 0);
    gl.VertexArrayAttribBinding(vertexArray.id(), 0, 0);
    return vertexArray;
}

void drawMesh(const Device& device, GLuint program, GLuint framebuffer, const glm::uvec2& size,
              const glm::dmat4& worldToClip, const MeshView& mesh) {
    const GladGLContext& gl = device.state()->gl;
    const gl::VertexArray vertexArray = makeVertexArray(device, mesh);
    gl.BindVertexArray(vertexArray.id());
    gl.BindFramebuffer(GL_DRAW_FRAMEBUFFER, framebuffer);
    gl.Viewport(0, 0, static_cast<GLsizei>(size.x), static_cast<GLsizei>(size.y));
    gl.Enable(GL_DEPTH_TEST);
    constexpr GLfloat kFarthest = 1.0f;
    gl.ClearNamedFramebufferfv(framebuffer, GL_DEPTH, 0, &kFarthest);
    gl.UseProgram(program);
    const glm::mat4 matrix(worldToClip);
    gl.ProgramUniformMatrix4fv(program, 0, 1, GL_FALSE, glm::value_ptr(matrix));
    gl.DrawElements(GL_TRIANGLES, static_cast<GLsizei>(mesh.indexCount), GL_UNSIGNED_INT,
                    reinterpret_cast<const void*>(mesh.indexOffsetBytes));
    gl.Disable(GL_DEPTH_TEST);
    gl.BindFramebuffer(GL_DRAW_FRAMEBUFFER, 0);
    gl.UseProgram(0);
    gl.BindVertexArray(0);
}

std::vector<glm::vec4> readPixels(const Device& device, GLuint texture, const glm::uvec2& size) {
    std::vector<glm::vec4> pixels(std::size_t{size.x} * size.y, glm::vec4(-7.0f));
    device.state()->gl.GetTextureImage(texture, 0, GL_RGBA, GL_FLOAT,
                                       static_cast<GLsizei>(pixels.size() * sizeof(glm::vec4)),
                                       pixels.data());
    return pixels;
}

} // namespace lamina::test
