#pragma once

#include <lamina/core/export.hpp>
#include <lamina/core/result.hpp>
#include <lamina/grid/bit_grid.hpp>

#include <glm/gtc/type_precision.hpp>
#include <glm/vec3.hpp>

#include <cstddef>
#include <cstdint>
#include <vector>

namespace lamina {

/// What surfaces leave in the set voxels of a BitGrid, in host memory: arrays with one value a set
/// voxel, in the order of BitGrid::forEachSet(); an empty array: not known.
struct AttributeGrid {
    std::vector<glm::u8vec4> colors; ///< RGBA; zero without hits.
    std::vector<glm::vec3> normals;  ///< World, unit length; zero without, or where they cancel.
    std::vector<std::uint32_t> hits; ///< Triangles that touch the voxel; 0 e.g. inside solids.
    std::vector<std::uint16_t> materials; ///< Of the triangle with the largest area in the voxel.
};

/// Gives the set voxels without hits, the inside of solids, the colour of the nearest one with
/// hits: the fewest steps from face to face of set voxels away, of several such always the same
/// one. What no step leads to keeps its colour. Hits, normals and materials stay. For files whose
/// users cut models open; writeGrid() leaves out voxels known to have no hits: drop `hits` before.
/// attributes: colours and hits, a value for each set voxel of `grid`.
/// Errors: InvalidArgument (other numbers of values), OutOfMemory; `attributes` is then unchanged.
/// Cost: some passes over the set voxels, about a second for ten million; a copy of the colours.
[[nodiscard]] LAMINA_API Result<void> spreadColors(const BitGrid& grid, AttributeGrid& attributes);

/// Finds a set voxel's place in the order of BitGrid::forEachSet(). Movable.
class LAMINA_API BitRank {
public:
    /// `grid` is borrowed and must outlive this object unchanged. Memory: 8 bytes for each 128
    /// slices of each column. Cost: one pass over the words.
    /// Errors: OutOfMemory.
    [[nodiscard]] static Result<BitRank> create(const BitGrid& grid);

    /// Number of set voxels before `voxel`, which must lie in the grid (asserted).
    [[nodiscard]] std::size_t operator()(const glm::uvec3& voxel) const;
    /// Number of set voxels.
    [[nodiscard]] std::size_t count() const { return mCount; }

private:
    explicit BitRank(const BitGrid& grid)
        : mGrid(&grid) {}

    const BitGrid* mGrid;
    std::vector<std::uint64_t> mTexels; ///< Set voxels before each texel of four words.
    std::size_t mCount = 0;
};

} // namespace lamina
