#pragma once

#include <lamina/core/triangle_mesh.hpp>
#include <lamina/grid/bit_grid.hpp>

#include <reference/options.hpp>
#include <reference/triangle_box.hpp>

namespace lamina::reference {

/// Every voxel whose closed cube a triangle touches, by TriangleBoxTest in double precision.
/// A face on a voxel boundary sets the voxels on both sides. Honours Options::grow.
/// The grid must be orthographic with linear slices, so that voxels are unit cubes in grid
/// coordinates. Two threads.
/// Errors: Unsupported (other grids), InvalidMesh, InvalidArgument (a vertex more than 2^30 voxels
/// away), OutOfMemory.
[[nodiscard]] Result<BitGrid> overlap(const TriangleMesh& mesh, const GridTransform& transform,
                                      const Options& options = {});

/// The thin, 6-separating surface of Schwarz and Seidel (2010): as overlap(), with the voxel's
/// cube replaced by its crosshair on all axes but the grid's. Subset of overlap().
[[nodiscard]] Result<BitGrid> separating6(const TriangleMesh& mesh, const GridTransform& transform,
                                          const Options& options = {});

/// What overlap() and separating6() do, into a grid that exists: sets more bits, clears none.
/// Scalar: double, or float for benchmarks of the plain host voxelizer.
/// threads: at least 1; they share the rows of the grid.
/// Errors: as overlap(); `grid` is then unchanged.
template<class Scalar>
[[nodiscard]] Result<void> addOverlap(BitGrid& grid, const TriangleMesh& mesh, VoxelShape shape,
                                      const Options& options = {}, unsigned threads = 2);

extern template Result<void> addOverlap<double>(BitGrid&, const TriangleMesh&, VoxelShape,
                                                const Options&, unsigned);
extern template Result<void> addOverlap<float>(BitGrid&, const TriangleMesh&, VoxelShape,
                                               const Options&, unsigned);

} // namespace lamina::reference
