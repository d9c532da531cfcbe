#pragma once

#include <lamina/core/box.hpp>
#include <lamina/core/export.hpp>
#include <lamina/core/result.hpp>

#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include <vector>

namespace lamina {

/// Triangles in host memory.
struct TriangleMesh {
    std::vector<glm::vec3> positions; ///< World (or model) units, one per vertex.
    std::vector<glm::vec3> normals;   ///< Unit length, one per vertex, or empty.
    std::vector<glm::vec4>
        colors; ///< RGBA in [0,1] as the file stores them, one per vertex, or empty.
    std::vector<glm::uvec3> triangles; ///< Vertex indices, counter-clockwise seen from outside.

    /// The box around the vertices that triangles use; empty without triangles. Cost: one pass.
    [[nodiscard]] LAMINA_API Box3 bounds() const;
};

/// Checks what every consumer of a mesh relies on: at least one triangle, indices in range, finite
/// positions, attribute arrays empty or of the vertex count.
/// Errors: InvalidMesh, naming the first offending triangle or vertex.
[[nodiscard]] LAMINA_API Result<void> validate(const TriangleMesh& mesh);

} // namespace lamina
