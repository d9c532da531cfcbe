#pragma once

#include <lamina/core/triangle_mesh.hpp>
#include <lamina/grid/bit_grid.hpp>

#include <reference/column_triangle.hpp>
#include <reference/options.hpp>

#include <optional>
#include <vector>

namespace lamina::reference {

/// What a triangle gives a column whose centre it owns.
enum class ColumnRule {
    Centre,    ///< The depth at the column's centre, as sampled().
    Footprint, ///< The depths of its part inside the column's closed square, as filled().
    Touch      ///< The same, without asking for the centre, as touched().
};

/// Nearest and farthest depth that the triangles give each column, row by row, cut to [near, far];
/// nothing in columns without. Options::grow enlarges squares and centres as for filled(); negative
/// shrinks: columns on the edge of a triangle may then lose it.
[[nodiscard]] std::vector<std::optional<DepthSpan>> columnSpans(const TriangleMesh& mesh,
                                                                const GridTransform& transform,
                                                                ColumnRule rule,
                                                                const Options& options = {});

/// The voxels of a grid whose columns divide `ranges`, one a column: a depth at fraction f of its
/// column's range is in the slice whose fractions hold f; the far end belongs to the last slice,
/// and a range of no extent is all slice 0. Depths outside the range set nothing. Options::grow as
/// above; depths are moved both ways by `depthTolerance` of the grid's depth range: of the slices
/// that they then reach, those are set that all (negative grow) or any (positive) would set.
/// Errors: InvalidMesh, OutOfMemory.
[[nodiscard]] Result<BitGrid> local(const TriangleMesh& mesh, const GridTransform& transform,
                                    const std::vector<ColumnRange>& ranges, ColumnRule rule,
                                    const Options& options = {}, double depthTolerance = 0.0);

} // namespace lamina::reference
