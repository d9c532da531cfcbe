#pragma once

#include "host_gl.hpp"

#include <lamina/core/triangle_mesh.hpp>
#include <lamina/voxelize/geometry_source.hpp>

namespace example {

/// What the engine keeps of a mesh: its buffers, and a vertex array to draw them (positions at
/// location 0).
struct EngineMesh {
    lamina::MeshView view;
    GLuint vertexArray = 0;
};

[[nodiscard]] EngineMesh upload(const HostGl& gl, const lamina::TriangleMesh& mesh);

/// Draws all triangles with the program in use.
void draw(const HostGl& gl, const EngineMesh& mesh);

} // namespace example
