#pragma once

#include <lamina/core/triangle_mesh.hpp>
#include <lamina/grid/bit_grid.hpp>
#include <lamina/voxelize/voxelizer.hpp>

#include <string>

namespace lamina::test {

struct Solid {
    BitGrid bits;
    SolidReport report;
    VoxelizeStats stats;
    BitGrid doubtful; ///< Empty but for SolidRule::Voted.
};

/// A mesh by a new voxelizer of Coverage::Solid; an error fails the test.
[[nodiscard]] Solid voxelizeSolid(const Device& device, const TriangleMesh& mesh,
                                  const GridTransform& transform,
                                  SolidRule rule = SolidRule::Parity,
                                  Backend backend = Backend::Automatic);

/// Expects the inside of a mesh, by ray parity in double precision: at most one voxel in 100,000
/// differs, each by rounding.
void expectInside(const BitGrid& found, const TriangleMesh& mesh, const GridTransform& transform,
                  const std::string& name);

} // namespace lamina::test
