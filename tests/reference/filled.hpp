#pragma once

#include <lamina/core/triangle_mesh.hpp>
#include <lamina/grid/bit_grid.hpp>

#include <reference/options.hpp>

namespace lamina::reference {

/// Filled columns: for each triangle and each column whose centre it owns (see owns()), every slice
/// that the part of the triangle inside the column's closed unit square touches. Slices are
/// half-open (a depth on boundary k is in slice k, see kDepthSnap); far belongs to the last one.
/// Parts outside [near, far] set nothing. Contains sampled().
///
/// Options::grow enlarges the square and the slices; a centre then counts if it lies within `grow`
/// columns of the projected triangle (even one of zero area). Negative: the centre must lie at
/// least that far inside, and the smaller square's part must reach that far into the slice.
/// Errors: InvalidMesh, OutOfMemory.
[[nodiscard]] Result<BitGrid> filled(const TriangleMesh& mesh, const GridTransform& transform,
                                     const Options& options = {});

/// As filled(), without asking for the centre: every voxel whose closed column and half-open slice
/// the triangle touches. Serves perspective grids and any slice distribution.
/// Errors: InvalidMesh, OutOfMemory.
[[nodiscard]] Result<BitGrid> touched(const TriangleMesh& mesh, const GridTransform& transform,
                                      const Options& options = {});

} // namespace lamina::reference
