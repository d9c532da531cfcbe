#pragma once

#include <lamina/core/triangle_mesh.hpp>
#include <lamina/grid/bit_grid.hpp>

#include <cstdint>
#include <vector>

namespace lamina::reference {

/// Votes for inside of a voxel, one for each end of the lines through its centre.
struct SolidVotes {
    std::uint8_t axes = 0;      ///< Of 6: the lines along the grid's axes.
    std::uint8_t diagonals = 0; ///< Of 8: those along its diagonals.
};

/// The votes of each voxel, x fastest, then y, then z, by the rules of SolidRule::Voted. Crossings
/// are sorted lists, signs are added up as whole numbers. Rays start some 1e-6 voxels from the
/// centre, the same way for all. The mesh must be valid (asserted); the grid orthographic with
/// linear slices. Cost: all lines that meet the grid.
[[nodiscard]] std::vector<SolidVotes> solidVotes(const TriangleMesh& mesh,
                                                 const GridTransform& transform);

/// The voxels that a flood from the grid's faces through faces of clear voxels does not reach.
/// Errors: OutOfMemory.
[[nodiscard]] Result<BitGrid> unreached(const BitGrid& surface);

} // namespace lamina::reference
