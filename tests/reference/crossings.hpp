#pragma once

#include <lamina/core/triangle_mesh.hpp>
#include <lamina/grid/bit_grid.hpp>

#include <reference/options.hpp>

#include <cstdint>
#include <span>
#include <vector>

namespace lamina::reference {

/// Where the ray through a column's centre meets a triangle.
struct Crossing {
    double depth = 0.0;         ///< World units, as GridTransform's depths.
    std::uint32_t triangle = 0; ///< Index in the mesh.
    bool frontFacing = false;   ///< Counter-clockwise in the world, seen from the grid's camera.
};

/// All crossings of the ray through the centre of `column` with the triangles that own the centre,
/// nearest first, before near and beyond far too (perspective: from kEyeCut * near on). A closed
/// mesh gives an even number in an orthographic grid. The mesh must be valid (asserted).
/// Cost: all triangles. Honours Options::model only.
[[nodiscard]] std::vector<Crossing> crossings(const TriangleMesh& mesh,
                                              const GridTransform& transform,
                                              const glm::uvec2& column,
                                              const Options& options = {});

/// The crossings of every column: what crossings() gives, all at once.
class ColumnCrossings {
public:
    ColumnCrossings(const TriangleMesh& mesh, const GridTransform& transform,
                    const Options& options = {});

    [[nodiscard]] std::span<const Crossing> at(const glm::uvec2& column) const {
        return mLists[static_cast<std::size_t>(column.y) * mWidth + column.x];
    }

private:
    std::size_t mWidth;
    std::vector<std::vector<Crossing>> mLists;
};

/// Number of crossings with depth < `depth`: leaves in front of a point. `sorted`: nearest first.
[[nodiscard]] std::size_t crossingsNearer(std::span<const Crossing> sorted, double depth);

/// Length of the part of depth range [from, to] that lies inside a closed mesh: where an odd number
/// of crossings lies beyond. Multiply by rayLengthPerDepth() for the path length.
[[nodiscard]] double depthInside(std::span<const Crossing> sorted, double from, double to);

/// World length of the ray through a column's centre per unit of depth; 1 for box grids.
[[nodiscard]] double rayLengthPerDepth(const GridTransform& transform, const glm::uvec2& column);

/// The solid: voxels whose centre (slice coordinate k + 0.5) has an odd number of crossings beyond
/// it. Crossings are owned by the fill rule, so they pair up for closed meshes and no voxel row is
/// ever filled to the border by a ray through an edge. A centre on the surface counts as inside
/// where the solid begins and as outside where it ends. Honours Options::model only.
/// Errors: InvalidMesh, OutOfMemory.
[[nodiscard]] Result<BitGrid> inside(const TriangleMesh& mesh, const GridTransform& transform,
                                     const Options& options = {});

} // namespace lamina::reference
