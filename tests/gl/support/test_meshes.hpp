#pragma once

#include <lamina/core/triangle_mesh.hpp>

#include <string>
#include <vector>

namespace lamina::test {

struct NamedMesh {
    std::string name;
    TriangleMesh mesh;
};

/// Closed, open, thin, concave and chaotic shapes in about [-1,1]^3.
[[nodiscard]] std::vector<NamedMesh> makeShapes();

/// Real meshes: the Debian bunny where installed, and those of `files` that the folder named by the
/// environment variable LAMINA_MESH_DIR holds. A file that is there but cannot be read fails the
/// test.
[[nodiscard]] std::vector<NamedMesh> readRealMeshes(const std::vector<std::string>& files);

} // namespace lamina::test
