#pragma once

#include <lamina/core/export.hpp>
#include <lamina/core/triangle_mesh.hpp>

namespace lamina {

/// Sets mesh.normals to unit vertex normals: the mean of the normals of a vertex's triangles, each
/// weighted by its angle there. A vertex without a direction (unused, or its triangles are
/// degenerate or cancel out) gets (0,0,1). Vertices are not welded.
/// `mesh`: indices in range, finite positions (see validate()).
/// Cost: one pass over the triangles, 24 bytes a vertex.
LAMINA_API void computeNormals(TriangleMesh& mesh);

} // namespace lamina
