#pragma once

#include "host_gl.hpp"

#include <lamina/core/triangle_mesh.hpp>
#include <lamina/voxelize/geometry_source.hpp>

namespace example {

/// What the engine keeps of a mesh: its buffers, and a vertex array to draw them: positions at
/// location 0, normals, if it has some, at 1.
struct EngineMesh {
    lamina::MeshView view;
    GLuint vertexArray = 0;
};

[[nodiscard]] EngineMesh upload(const HostGl& gl, const lamina::TriangleMesh& mesh);

/// A vertex stage for meshes in the world: uniform 0 is worldToClip, `world` the position.
extern const char* const kWorldVertexShader;

/// Draws all triangles with the program in use.
void draw(const HostGl& gl, const EngineMesh& mesh);

} // namespace example
