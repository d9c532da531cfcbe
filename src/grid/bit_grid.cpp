#include <lamina/grid/bit_grid.hpp>

#include "grid/bit_transpose.hpp"

#include <algorithm>
#include <cmath>
#include <new>
#include <numeric>

namespace lamina {
namespace {

/// Where the words of a box grid's columns stand.
struct TransposeSide {
    glm::uvec3 axes;          ///< World axes of columns x, columns y, slices.
    std::size_t strides[3]{}; ///< Words between neighbours along a world axis; 0 along the slices.

    TransposeSide(const glm::uvec3& worldAxes, const glm::uvec3& size)
        : axes(worldAxes) {
        strides[axes.x] = 4;
        strides[axes.y] = std::size_t{4} * size.x;
        mGroupWords = strides[axes.y] * size.y;
    }

    /// Of the word that holds a voxel along world x, y, z.
    [[nodiscard]] std::size_t wordIndex(const glm::uvec3& voxel) const {
        const std::uint32_t slice = voxel[axes.z];
        return voxel[axes.x] * strides[axes.x] + voxel[axes.y] * strides[axes.y] +
               (slice >> 7u) * mGroupWords + ((slice >> 5u) & 3u);
    }

private:
    std::size_t mGroupWords;
};

/// Moves 128 slices of 128 columns from one grid to another of which they are 128 columns of 128
/// slices: whole texels on both sides. corner: the tile's low voxel along world x, y, z. `to` is
/// clear there.
void transposeTile(const std::uint32_t* from, const TransposeSide& source, std::uint32_t* to,
                   const TransposeSide& target, const glm::uvec3& corner, std::uint32_t rowEnd) {
    const unsigned rows = target.axes.z, columns = source.axes.z;
    glm::uvec3 voxel = corner;
    for (; voxel[rows] < std::min(rowEnd, corner[rows] + 128); voxel[rows] += 32) {
        const std::uint32_t* texels = from + source.wordIndex(voxel);
        const std::size_t texelStride = source.strides[rows];
        const std::uint32_t count = std::min(32u, rowEnd - voxel[rows]);
        // Most words of a surface's grid are clear, seen with one look at each texel.
        std::uint32_t any[4] = {};
        for (std::uint32_t row = 0; row < count; ++row)
            for (int word = 0; word < 4; ++word)
                any[word] |= texels[row * texelStride + word];
        std::uint32_t* out = to + target.wordIndex(voxel);
        for (std::uint32_t word = 0; word < 4; ++word) {
            if (any[word] == 0)
                continue;
            std::uint32_t bits[32] = {};
            for (std::uint32_t row = 0; row < count; ++row)
                bits[row] = texels[row * texelStride + word];
            detail::transpose32(bits);
            // Past the last slice, which is the last column here, bits are clear.
            for (std::uint32_t column = 0; column < 32; ++column)
                if (bits[column] != 0)
                    out[(32 * word + column) * target.strides[columns]] = bits[column];
        }
    }
}

} // namespace

Result<BitGrid> BitGrid::create(const GridTransform& transform) {
    BitGrid grid(transform);
    const glm::uvec3 size = transform.size();
    const double words = 4.0 * size.x * size.y * grid.groupCount();
    try {
        if (words > static_cast<double>(grid.mWords.max_size()))
            throw std::bad_alloc();
        grid.mWords.resize(static_cast<std::size_t>(words));
    } catch (const std::bad_alloc&) {
        return Error{ErrorCode::OutOfMemory,
                     "bit grid: " + transform.describe() + " needs " +
                         std::to_string(static_cast<std::uint64_t>(words * 4.0 / (1 << 20))) +
                         " MiB, which the host could not give; use fewer voxels"};
    }
    return grid;
}

Result<BitGrid> BitGrid::create(const GridTransform& transform, std::vector<ColumnRange> ranges) {
    const std::size_t columns = std::size_t{transform.size().x} * transform.size().y;
    if (ranges.size() != columns)
        return Error{ErrorCode::InvalidArgument, "bit grid: expected a range for each of " +
                                                     std::to_string(columns) + " columns, found " +
                                                     std::to_string(ranges.size())};
    auto grid = create(transform);
    if (grid)
        grid->mRanges = std::move(ranges);
    return grid;
}

ColumnRange BitGrid::columnRange(const glm::uvec2& column) const {
    assert(column.x < size().x && column.y < size().y);
    if (hasLocalRanges())
        return mRanges[std::size_t{column.y} * size().x + column.x];
    return {static_cast<float>(mTransform.nearDepth()), static_cast<float>(mTransform.farDepth())};
}

double BitGrid::depthAt(const glm::uvec2& column, double sliceCoordinate) const {
    return hasLocalRanges() ? mTransform.depthAtSlice(sliceCoordinate, columnRange(column))
                            : mTransform.depthAtSlice(sliceCoordinate);
}

std::optional<glm::uvec3> BitGrid::voxelAt(const glm::dvec3& world) const {
    if (!hasLocalRanges())
        return mTransform.voxelAt(world);
    const auto place = mTransform.columnAt(world);
    if (!place)
        return std::nullopt;
    const auto slice = mTransform.sliceAt(place->depth, columnRange(place->column));
    if (!slice)
        return std::nullopt;
    return glm::uvec3(place->column, *slice);
}

bool BitGrid::at(const glm::dvec3& world) const {
    const auto voxel = voxelAt(world);
    return voxel && test(*voxel);
}

std::uint32_t BitGrid::countNearer(const glm::dvec3& world) const {
    if (const auto voxel = voxelAt(world))
        return countNearer({voxel->x, voxel->y}, voxel->z);
    const auto place = mTransform.columnAt(world);
    if (!place)
        return 0;
    const bool isBeyond = hasLocalRanges() ? place->depth > columnRange(place->column).far
                                           : place->depth > mTransform.farDepth();
    return isBeyond ? countNearer(place->column, size().z) : 0;
}

std::uint64_t BitGrid::count() const {
    return std::transform_reduce(
        mWords.begin(), mWords.end(), std::uint64_t{0}, std::plus<>(),
        [](std::uint32_t word) { return static_cast<std::uint64_t>(std::popcount(word)); });
}

std::uint32_t BitGrid::countNearer(const glm::uvec2& column, std::uint32_t slice) const {
    const std::uint32_t limit = std::min(slice, size().z);
    std::uint32_t count = 0;
    for (std::uint32_t first = 0; first < limit; first += 32) {
        std::uint32_t word = mWords[wordIndex({column.x, column.y, first})];
        if (limit - first < 32)
            word &= (1u << (limit - first)) - 1u;
        count += static_cast<std::uint32_t>(std::popcount(word));
    }
    return count;
}

Result<BitGrid> BitGrid::reoriented(Axis axis) const {
    const auto from = mTransform.boxAxis();
    if (hasLocalRanges() || !from ||
        mTransform.distribution().kind() != SliceDistribution::Kind::Linear)
        return Error{ErrorCode::InvalidArgument,
                     "bit grid: expected a box grid with linear slices to reorient, found " +
                         mTransform.describe() +
                         (hasLocalRanges() ? " with local ranges; use toUniform() first" : "")};
    if (*from == axis)
        return *this;
    const glm::uvec3 fromAxes = boxGridAxes(*from);
    glm::uvec3 worldCounts;
    for (int i = 0; i < 3; ++i)
        worldCounts[fromAxes[i]] = size()[i];
    auto transform = GridTransform::box(mTransform.boxBounds(), worldCounts, axis);
    if (!transform)
        return transform.error();
    auto target = create(*transform);
    if (!target)
        return target;
    const glm::uvec3 toAxes = boxGridAxes(axis);
    const TransposeSide source{fromAxes, size()};
    const TransposeSide sink{toAxes, target->size()};
    // The axis that is neither's slices.
    const unsigned other = 3 - fromAxes.z - toAxes.z;
    for (std::uint32_t row = 0; row < worldCounts[toAxes.z]; row += kSlicesPerGroup)
        for (std::uint32_t slice = 0; slice < worldCounts[fromAxes.z]; slice += kSlicesPerGroup)
            for (std::uint32_t layer = 0; layer < worldCounts[other]; ++layer) {
                glm::uvec3 corner;
                corner[toAxes.z] = row;
                corner[fromAxes.z] = slice;
                corner[other] = layer;
                transposeTile(mWords.data(), source, target->mWords.data(), sink, corner,
                              worldCounts[toAxes.z]);
            }
    return target;
}

Result<BitGrid> BitGrid::toUniform(std::uint32_t slices) const {
    auto transform = mTransform.withSlices(slices);
    if (!transform)
        return transform.error();
    auto target = create(*transform);
    if (!target)
        return target;
    // Rounding alone must not reach into a neighbour that a voxel only touches.
    constexpr double kRounding = 1e-9;
    const double last = slices - 1;
    forEachSet([&](const glm::uvec3& voxel) {
        const glm::uvec2 column(voxel);
        const double front = transform->sliceCoordinate(depthAt(column, voxel.z));
        const double back = transform->sliceCoordinate(depthAt(column, voxel.z + 1.0));
        const double low = std::clamp(std::floor(front + kRounding), 0.0, last);
        const double high = std::clamp(std::ceil(back - kRounding) - 1.0, low, last);
        for (auto k = static_cast<std::uint32_t>(low); k <= static_cast<std::uint32_t>(high); ++k)
            target->set({column, k});
    });
    return target;
}

Result<BitGridComparison> compare(const BitGrid& first, const BitGrid& second) {
    if (first.size() != second.size())
        return Error{ErrorCode::InvalidArgument, "compare: expected grids of equal size, found " +
                                                     first.transform().describe() + " and " +
                                                     second.transform().describe()};
    BitGridComparison result;
    const auto a = first.words();
    const auto b = second.words();
    for (std::size_t i = 0; i < a.size(); ++i) {
        result.both += static_cast<std::uint64_t>(std::popcount(a[i] & b[i]));
        result.onlyFirst += static_cast<std::uint64_t>(std::popcount(a[i] & ~b[i]));
        result.onlySecond += static_cast<std::uint64_t>(std::popcount(b[i] & ~a[i]));
    }
    return result;
}

} // namespace lamina
