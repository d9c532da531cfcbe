#pragma once

#include <lamina/core/export.hpp>
#include <lamina/core/result.hpp>
#include <lamina/grid/grid_transform.hpp>

#include <bit>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace lamina {

/// How two grids of equal size differ.
struct BitGridComparison {
    std::uint64_t both = 0;       ///< Voxels set in both.
    std::uint64_t onlyFirst = 0;  ///< Voxels set in the first alone.
    std::uint64_t onlySecond = 0; ///< Voxels set in the second alone.

    [[nodiscard]] bool equal() const { return onlyFirst == 0 && onlySecond == 0; }
    /// Intersection over union; 1 for two empty grids.
    [[nodiscard]] double iou() const {
        const std::uint64_t either = both + onlyFirst + onlySecond;
        return either == 0 ? 1.0 : static_cast<double>(both) / static_cast<double>(either);
    }
};

/// One bit per voxel in host memory, with the transform that says where the voxels are.
///
/// Words stand as in VoxelGrid's texture: groups of 128 slices, in each the columns row by row, in
/// each column four 32-bit words; bit (k & 31) of word (k >> 5) & 3 of group k >> 7 is slice k.
/// Bits past the last slice are zero. Movable and copyable.
///
/// A grid has one range of depths, that of its transform, or local ranges: each column's slices
/// then divide a range of its own ([ED06] 2.3), and an empty column holds nothing.
class LAMINA_API BitGrid {
public:
    static constexpr std::uint32_t kSlicesPerGroup = 128;

    /// All voxels clear. Memory: wordCount() * 4 bytes.
    /// Errors: OutOfMemory.
    [[nodiscard]] static Result<BitGrid> create(const GridTransform& transform);

    /// The same with local ranges. ranges: one a column, row by row.
    /// Errors: InvalidArgument (another number of ranges), OutOfMemory.
    [[nodiscard]] static Result<BitGrid> create(const GridTransform& transform,
                                                std::vector<ColumnRange> ranges);

    [[nodiscard]] const GridTransform& transform() const { return mTransform; }
    /// Columns in x, columns in y, slices.
    [[nodiscard]] const glm::uvec3& size() const { return mTransform.size(); }

    /// Is the voxel set? `voxel` must lie in the grid (asserted).
    [[nodiscard]] bool test(const glm::uvec3& voxel) const {
        return (mWords[wordIndex(voxel)] >> (voxel.z & 31u)) & 1u;
    }
    /// Sets or clears one voxel inside the grid (asserted).
    void set(const glm::uvec3& voxel, bool value = true) {
        const std::uint32_t bit = 1u << (voxel.z & 31u);
        std::uint32_t& word = mWords[wordIndex(voxel)];
        word = value ? word | bit : word & ~bit;
    }
    [[nodiscard]] bool hasLocalRanges() const { return !mRanges.empty(); }
    /// One range a column, row by row; empty for a grid without local ranges.
    [[nodiscard]] std::span<const ColumnRange> ranges() const { return mRanges; }
    /// The depths that the slices of a column inside the grid (asserted) divide; in a grid without
    /// local ranges, those of the transform.
    [[nodiscard]] ColumnRange columnRange(const glm::uvec2& column) const;
    /// Eye depth at a slice coordinate in [0, slices] (clamped) of a column that is not empty
    /// (asserted), world units.
    [[nodiscard]] double depthAt(const glm::uvec2& column, double sliceCoordinate) const;

    /// The voxel that holds a world point, or nothing outside the grid or the column's range.
    [[nodiscard]] std::optional<glm::uvec3> voxelAt(const glm::dvec3& world) const;
    /// Is the world point in a set voxel? False outside the grid.
    [[nodiscard]] bool at(const glm::dvec3& world) const;

    /// Number of set voxels. Cost: one pass over the words.
    [[nodiscard]] std::uint64_t count() const;
    /// Set voxels of column (x,y) in slices nearer than `slice` (any value; clamped to the slices).
    [[nodiscard]] std::uint32_t countNearer(const glm::uvec2& column, std::uint32_t slice) const;

    /// Set voxels nearer to the grid's camera than the slice that holds a world point, in the
    /// point's column ([ED06] 3.1). 0 for points before the column's range or outside the columns;
    /// all of the column's voxels for points beyond its range.
    [[nodiscard]] std::uint32_t countNearer(const glm::dvec3& world) const;

    /// Calls visit(glm::uvec3 voxel) for each set voxel, by group, row, column, slice.
    template<class Visitor>
    void forEachSet(Visitor&& visit) const {
        const glm::uvec3 dims = size();
        std::size_t index = 0;
        for (std::uint32_t group = 0; group < groupCount(); ++group)
            for (std::uint32_t y = 0; y < dims.y; ++y)
                for (std::uint32_t x = 0; x < dims.x; ++x)
                    for (std::uint32_t word = 0; word < 4; ++word)
                        for (std::uint32_t bits = mWords[index++]; bits != 0; bits &= bits - 1)
                            visit(
                                glm::uvec3(x, y,
                                           group * kSlicesPerGroup + word * 32 +
                                               static_cast<std::uint32_t>(std::countr_zero(bits))));
    }

    /// Groups of 128 slices: the layers of VoxelGrid's texture.
    [[nodiscard]] std::uint32_t groupCount() const {
        return (size().z + kSlicesPerGroup - 1) / kSlicesPerGroup;
    }
    /// Index of the word that holds `voxel`.
    [[nodiscard]] std::size_t wordIndex(const glm::uvec3& voxel) const {
        assert(voxel.x < size().x && voxel.y < size().y && voxel.z < size().z);
        const std::size_t row = static_cast<std::size_t>(voxel.z >> 7u) * size().y + voxel.y;
        return (row * size().x + voxel.x) * 4 + ((voxel.z >> 5u) & 3u);
    }
    [[nodiscard]] std::span<const std::uint32_t> words() const { return mWords; }
    /// Writable words; keep the bits past the last slice zero.
    [[nodiscard]] std::span<std::uint32_t> words() { return mWords; }

    /// The same voxels with columns along `axis`. This grid must come from GridTransform::box()
    /// with a linear distribution, without local ranges. Cost: one pass over the words of both.
    /// Errors: InvalidArgument for other grids, OutOfMemory.
    [[nodiscard]] Result<BitGrid> reoriented(Axis axis) const;

    /// The grid cut into `slices` slices of equal depth over the transform's whole range: every
    /// voxel that overlaps a set voxel of this one, beyond rounding, is set. For uses that know one
    /// range only, voxel files above all.
    /// Errors: InvalidArgument (no slices), OutOfMemory.
    [[nodiscard]] Result<BitGrid> toUniform(std::uint32_t slices) const;

private:
    explicit BitGrid(const GridTransform& transform)
        : mTransform(transform) {}

    GridTransform mTransform;
    std::vector<std::uint32_t> mWords;
    std::vector<ColumnRange> mRanges;
};

/// Compares voxel by voxel.
/// Errors: InvalidArgument if the sizes differ (the transforms and local ranges may).
[[nodiscard]] LAMINA_API Result<BitGridComparison> compare(const BitGrid& first,
                                                           const BitGrid& second);

} // namespace lamina
