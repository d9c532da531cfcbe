#pragma once

#include <lamina/grid/grid_transform.hpp>

#include <reference/column_triangle.hpp>
#include <reference/index_range.hpp>

namespace lamina::reference {

/// A depth at most this share of the depth range before a slice boundary, or beyond near or far,
/// counts as on it: the contract of GridTransform::sliceAt(), written down a second time.
inline constexpr double kDepthSnap = 0x1p-40;

/// Continuous slice coordinate of a depth, linear between slice boundaries, exactly k on boundary
/// k (see kDepthSnap); negative before near and above the slice count beyond far.
[[nodiscard]] double openSliceCoordinate(const GridTransform& transform, double depth);

/// The slices k whose depths [k - grow, k + 1 + grow), in slice coordinates, the span touches; far
/// belongs to the last slice. Spans before near or beyond far touch none.
[[nodiscard]] IndexRange slicesTouched(const GridTransform& transform, const DepthSpan& span,
                                       double grow = 0.0);

} // namespace lamina::reference
