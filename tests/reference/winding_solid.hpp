#pragma once

#include <lamina/core/triangle_mesh.hpp>
#include <lamina/grid/bit_grid.hpp>

namespace lamina::reference {

/// Triangles that close a mesh: with them, every directed edge between two positions occurs as
/// often as its opposite. Cones over the open edges, one apex for each connected group of them, at
/// the mean of its vertices. Empty for closed meshes. The mesh must be valid (asserted).
[[nodiscard]] TriangleMesh closure(const TriangleMesh& mesh);

/// The voxels whose centres have a generalized winding number above 1/2 [Jacobson et al. 2013]:
/// inside for open and dirty meshes whose orientation can be trusted. The grid must be
/// right-handed, orthographic.
///
/// The winding number of a mesh is that of the mesh with its closure, a whole number that the
/// signed crossings beyond a point give, less that of the closure; the latter is summed where it is
/// large enough to matter, triangle by triangle (windingNumber()).
/// Errors: InvalidMesh, OutOfMemory.
[[nodiscard]] Result<BitGrid> insideByWinding(const TriangleMesh& mesh,
                                              const GridTransform& transform);

} // namespace lamina::reference
