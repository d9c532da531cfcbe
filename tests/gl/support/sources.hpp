#pragma once

#include "gl/glad.hpp"

#include <lamina/core/triangle_mesh.hpp>
#include <lamina/voxelize/geometry_source.hpp>

#include <glm/mat4x4.hpp>

#include <functional>
#include <span>
#include <string>
#include <vector>

/// Sources that every voxelizer takes alike.
namespace lamina::test {

/// A knot in about [-0.8,0.8]^3.
[[nodiscard]] TriangleMesh makeKnot();

/// Corners of triangles that no voxelizer of faces along z finds anything of: not finite,
/// collinear, a point, edge-on.
[[nodiscard]] std::vector<glm::vec3> degenerateTriangles();

struct PlacedMesh {
    TriangleMesh mesh;
    glm::mat4 model;
};

/// Three meshes: in place, moved, and turned, scaled and mirrored.
[[nodiscard]] std::vector<PlacedMesh> placedMeshes();

/// Calls `check` with views of one mesh that differ in stride, offset and indices: 32 bits, 16 bits
/// from an offset in buffers of even and odd length, none. `upload` makes a buffer; `layout` names
/// the view in messages. At most 65,535 vertices.
void forEachLayout(const TriangleMesh& mesh,
                   const std::function<GLuint(std::span<const std::byte>)>& upload,
                   const std::function<void(const MeshView&, const std::string& layout)>& check);

} // namespace lamina::test
