#pragma once

#include <lamina/core/triangle_mesh.hpp>

namespace lamina::test {

/// The mesh with every hole closed by a fan of triangles around the middle of its rim. Vertices at
/// identical positions are welded; normals and colours are dropped. Fails the test if the mesh is
/// not manifold.
[[nodiscard]] TriangleMesh withHolesClosed(const TriangleMesh& mesh);

} // namespace lamina::test
