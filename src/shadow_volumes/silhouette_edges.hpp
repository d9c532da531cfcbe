#pragma once

#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include <cstdint>
#include <span>
#include <vector>

namespace lamina {

/// A mesh as shadow volumes are built from it.
struct SilhouetteMesh {
    /// Vertices of equal position are one: the first of them.
    std::vector<glm::uvec3> triangles;
    /// (a, b, c, d) as GL_LINES_ADJACENCY wants it: an edge from b to c, of triangles a, b, c and
    /// d, c, b; d is b for an edge of one triangle. An edge of more than two triangles is there
    /// more than once, each triangle in one of them.
    std::vector<glm::uvec4> edges;
    /// Edges of one triangle alone, or of two of one direction.
    std::uint32_t openEdgeCount = 0;

    [[nodiscard]] bool isClosed() const { return !triangles.empty() && openEdgeCount == 0; }
};

/// indices: three a triangle, each below positions.size(). Triangles that are degenerate or not
/// finite are left out.
/// Cost: O(n log n).
[[nodiscard]] SilhouetteMesh findSilhouetteMesh(std::span<const glm::vec3> positions,
                                                std::span<const std::uint32_t> indices);

} // namespace lamina
