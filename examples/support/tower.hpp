#pragma once

#include <lamina/core/triangle_mesh.hpp>

namespace example {

/// A round tower with windows, floors, columns, a winding stair and a dome, around the y axis from
/// y = 0 to about 9.4, 3.6 in radius. Closed parts that touch but do not overlap: ray parity finds
/// their inside.
[[nodiscard]] lamina::TriangleMesh makeTower();

} // namespace example
