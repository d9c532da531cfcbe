#pragma once

#include <lamina/core/box.hpp>
#include <lamina/core/result.hpp>
#include <lamina/grid/attribute_grid.hpp>
#include <lamina/grid/bit_grid.hpp>

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace lamina::detail {

/// Which world axes run fastest, second and slowest in a block of bits.
struct AxisOrder {
    int fast = 0, middle = 1, slow = 2;
};

/// Bits of a box of voxels in world-axis order: rows of whole words along the fastest axis, then
/// the middle, then the slowest. Bits past the extent are zero. Counts are in the block's order.
struct BitBlock {
    glm::uvec3 extent{0};
    std::uint32_t rowWords = 0;
    std::vector<std::uint32_t> words;

    [[nodiscard]] std::span<const std::uint32_t> row(std::uint32_t middle,
                                                     std::uint32_t slow) const {
        return std::span(words).subspan(
            (static_cast<std::size_t>(slow) * extent.y + middle) * rowWords, rowWords);
    }
};

/// What a writer sees of a grid: voxels (i,j,k) along world x, y, z, whichever axis the BitGrid's
/// columns follow, and their attributes.
class BoxVoxels {
public:
    /// `grid` and `attributes` (null: none) are borrowed and must outlive this object.
    /// Errors: Unsupported for grids that are not from GridTransform::box() with linear slices;
    /// InvalidArgument for attributes of another number of voxels; OutOfMemory.
    [[nodiscard]] static Result<BoxVoxels> create(const BitGrid& grid,
                                                  const AttributeGrid* attributes = nullptr);

    [[nodiscard]] const glm::uvec3& size() const { return mSize; } ///< Along world x, y, z.
    [[nodiscard]] const Box3& bounds() const { return mGrid->transform().boxBounds(); }
    [[nodiscard]] glm::dvec3 voxelSize() const { return bounds().size() / glm::dvec3(mSize); }
    [[nodiscard]] std::uint64_t count() const { return mGrid->count(); }

    [[nodiscard]] bool hasColors() const {
        return mAttributes != nullptr && !mAttributes->colors.empty();
    }
    [[nodiscard]] bool hasNormals() const {
        return mAttributes != nullptr && !mAttributes->normals.empty();
    }
    /// Of a set voxel (along world x, y, z); zero, alpha too, where no surface is known.
    [[nodiscard]] glm::u8vec4 color(const glm::uvec3& voxel) const;
    [[nodiscard]] glm::vec3 normal(const glm::uvec3& voxel) const;

    /// The voxels [low, low + extent), both in the order of `order`, inside the grid. low.x is a
    /// multiple of 32. `block` is reused between calls.
    void load(AxisOrder order, const glm::uvec3& low, const glm::uvec3& extent,
              BitBlock& block) const;

private:
    explicit BoxVoxels(const BitGrid& grid);

    /// A set voxel's place in the attributes.
    [[nodiscard]] std::size_t index(const glm::uvec3& voxel) const;
    [[nodiscard]] bool isKnown(std::size_t index) const {
        return mAttributes->hits.empty() || mAttributes->hits[index] != 0;
    }

    const BitGrid* mGrid;
    const AttributeGrid* mAttributes = nullptr;
    std::unique_ptr<const BitRank> mRank; ///< With attributes.
    glm::uvec3 mSize;
    int mSliceAxis;           ///< The world axis along which a column's bits run.
    std::size_t mStride[3];   ///< Words between neighbours along a world axis; not for mSliceAxis.
    std::size_t mGroupStride; ///< Words between groups of slices.
};

/// Writes one byte, 0 or 1, for each of the first `count` bits.
void expandBits(std::span<const std::uint32_t> words, std::size_t count, std::uint8_t* bytes);

} // namespace lamina::detail
