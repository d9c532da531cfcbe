#pragma once

#include <lamina/core/triangle_mesh.hpp>
#include <lamina/grid/bit_grid.hpp>

#include <reference/options.hpp>

namespace lamina::reference {

/// Centre-sampled raster: for each triangle and each column whose centre the triangle owns (see
/// owns()), the slice that holds the depth of the triangle's plane at the centre (see
/// kDepthSnap). Depths outside [near, far] set nothing; far sets the last slice. Both windings
/// count. Triangles of zero area in projection set nothing. Honours Options::model only. Errors:
/// InvalidMesh, OutOfMemory.
[[nodiscard]] Result<BitGrid> sampled(const TriangleMesh& mesh, const GridTransform& transform,
                                      const Options& options = {});

} // namespace lamina::reference
