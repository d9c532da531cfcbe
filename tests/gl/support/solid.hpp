#pragma once

#include <lamina/core/triangle_mesh.hpp>
#include <lamina/grid/bit_grid.hpp>

#include <string>

namespace lamina::test {

/// Expects the inside of a mesh, by ray parity in double precision: at most one voxel in 100,000
/// differs, each by rounding.
void expectInside(const BitGrid& found, const TriangleMesh& mesh, const GridTransform& transform,
                  const std::string& name);

} // namespace lamina::test
