#include "engine_mesh.hpp"

#include <span>

namespace example {

EngineMesh upload(const HostGl& gl, const lamina::TriangleMesh& mesh) {
    EngineMesh made;
    made.view.vertexBuffer = makeBuffer(gl, std::as_bytes(std::span(mesh.positions)));
    made.view.vertexCount = static_cast<std::uint32_t>(mesh.positions.size());
    made.view.indexBuffer = makeBuffer(gl, std::as_bytes(std::span(mesh.triangles)));
    made.view.indexType = lamina::IndexType::UInt32;
    made.view.indexCount = static_cast<std::uint32_t>(3 * mesh.triangles.size());
    gl.CreateVertexArrays(1, &made.vertexArray);
    gl.VertexArrayVertexBuffer(made.vertexArray, 0, made.view.vertexBuffer, 0, sizeof(glm::vec3));
    gl.VertexArrayElementBuffer(made.vertexArray, made.view.indexBuffer);
    gl.EnableVertexArrayAttrib(made.vertexArray, 0);
    gl.VertexArrayAttribFormat(made.vertexArray, 0, 3, GL_FLOAT, GL_FALSE, 0);
    gl.VertexArrayAttribBinding(made.vertexArray, 0, 0);
    return made;
}

void draw(const HostGl& gl, const EngineMesh& mesh) {
    gl.BindVertexArray(mesh.vertexArray);
    gl.DrawElements(GL_TRIANGLES, static_cast<GLsizei>(mesh.view.indexCount), GL_UNSIGNED_INT,
                    nullptr);
}

} // namespace example
