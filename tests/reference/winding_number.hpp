#pragma once

#include <lamina/core/triangle_mesh.hpp>

namespace lamina::reference {

/// Generalized winding number of a mesh around a world point: the sum of the triangles' signed
/// solid angles over 4 pi. 1 inside and 0 outside a closed, outward-oriented mesh; in between near
/// holes; undefined on the surface. Cost: all triangles.
[[nodiscard]] double windingNumber(const TriangleMesh& mesh, const glm::dvec3& point);

} // namespace lamina::reference
