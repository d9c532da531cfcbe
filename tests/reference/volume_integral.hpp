#pragma once

#include <reference/crossings.hpp>

#include <cstdint>
#include <span>
#include <vector>

/// The volume integral of [ED06] 3.3, step by step, and its exact counterpart.
namespace lamina::reference {

/// The faces in a voxel of a column.
enum class Facing : std::uint8_t { Empty, Front, Back, Both };

/// Inner voxels of a column, eye first: voxels with front faces, the last voxel that is not empty,
/// and empty voxels by the rules of [ED06] 3.3.
[[nodiscard]] unsigned countInner(std::span<const Facing> column);

/// Does the column look like one of a closed surface, entered before it is left?
[[nodiscard]] bool looksClosed(std::span<const Facing> column);

/// Exact crossings, nearest first, quantised into `slices` slices of the range [near, far].
[[nodiscard]] std::vector<Facing> quantised(std::span<const Crossing> sorted, double near,
                                            double far, unsigned slices);

} // namespace lamina::reference
