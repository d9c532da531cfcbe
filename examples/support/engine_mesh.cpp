#include "engine_mesh.hpp"

#include <span>

namespace example {

const char* const kWorldVertexShader = R"(#version 450
layout(location = 0) uniform mat4 worldToClip;
layout(location = 0) in vec3 position;
out vec3 world;
void main() {
    world = position;
    gl_Position = worldToClip * vec4(position, 1.0);
}
)";

EngineMesh upload(const HostGl& gl, const lamina::TriangleMesh& mesh) {
    EngineMesh made;
    gl.CreateVertexArrays(1, &made.vertexArray);
    const auto attribute = [&](GLuint location, const std::vector<glm::vec3>& values) {
        const GLuint buffer = makeBuffer(gl, std::as_bytes(std::span(values)));
        gl.VertexArrayVertexBuffer(made.vertexArray, location, buffer, 0, sizeof(glm::vec3));
        gl.EnableVertexArrayAttrib(made.vertexArray, location);
        gl.VertexArrayAttribFormat(made.vertexArray, location, 3, GL_FLOAT, GL_FALSE, 0);
        gl.VertexArrayAttribBinding(made.vertexArray, location, location);
        return buffer;
    };
    made.view.vertexBuffer = attribute(0, mesh.positions);
    made.view.vertexCount = static_cast<std::uint32_t>(mesh.positions.size());
    if (!mesh.normals.empty())
        made.view.normals = {attribute(1, mesh.normals), 0, sizeof(glm::vec3)};
    made.view.indexBuffer = makeBuffer(gl, std::as_bytes(std::span(mesh.triangles)));
    made.view.indexType = lamina::IndexType::UInt32;
    made.view.indexCount = static_cast<std::uint32_t>(3 * mesh.triangles.size());
    gl.VertexArrayElementBuffer(made.vertexArray, made.view.indexBuffer);
    return made;
}

void draw(const HostGl& gl, const EngineMesh& mesh) {
    gl.BindVertexArray(mesh.vertexArray);
    gl.DrawElements(GL_TRIANGLES, static_cast<GLsizei>(mesh.view.indexCount), GL_UNSIGNED_INT,
                    nullptr);
}

} // namespace example
