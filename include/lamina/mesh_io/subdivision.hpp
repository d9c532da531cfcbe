#pragma once

#include <lamina/core/export.hpp>
#include <lamina/core/result.hpp>
#include <lamina/core/triangle_mesh.hpp>

namespace lamina {

/// Splits each triangle into 4^levels by Loop's subdivision scheme; boundaries stay boundaries.
/// Vertices at identical positions are welded first; degenerate triangles and colours are dropped;
/// normals are computed anew. levels 0 welds only.
/// Errors: InvalidArgument (more than 2^30 triangles would result), InvalidMesh (see validate(); or
/// an edge of more than two triangles, or of two that face opposite sides), OutOfMemory.
/// Cost: about 200 bytes a resulting triangle while it runs. Threads: any.
[[nodiscard]] LAMINA_API Result<TriangleMesh> subdivide(const TriangleMesh& mesh, unsigned levels);

} // namespace lamina
