#pragma once

#include <lamina/core/triangle_mesh.hpp>
#include <lamina/grid/grid_transform.hpp>

#include <glm/vec3.hpp>

#include <span>
#include <vector>

namespace lamina::reference {

/// Ray parity in double precision: for each point 1 if the ray from it along +axis crosses an odd
/// number of triangles, else 0. Crossings are owned by the fill rule, so a ray through an edge of
/// a closed mesh crosses one of its two triangles. Cost: points times triangles above them.
[[nodiscard]] std::vector<char> pointParity(const TriangleMesh& mesh,
                                            std::span<const glm::vec3> points, Axis axis);

/// Is a triangle of the mesh nearer to the point than `distance` (world units)? Cost: all
/// triangles.
[[nodiscard]] bool surfaceWithin(const TriangleMesh& mesh, const glm::dvec3& point,
                                 double distance);

} // namespace lamina::reference
