#include "grid_io/box_voxels.hpp"

#include "grid/bit_transpose.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <cstring>
#include <string>

namespace lamina::detail {

Result<BoxVoxels> BoxVoxels::create(const BitGrid& grid, const AttributeGrid* attributes) {
    const GridTransform& transform = grid.transform();
    if (grid.hasLocalRanges())
        return Error{ErrorCode::Unsupported,
                     "voxels: expected one range of depths for all columns, found a " +
                         transform.describe() +
                         " grid with local ranges; resample it by BitGrid::toUniform()"};
    if (!transform.boxAxis() || transform.distribution().kind() != SliceDistribution::Kind::Linear)
        return Error{ErrorCode::Unsupported,
                     "voxels: expected a grid over a world box with slices of equal depth, found " +
                         transform.describe() +
                         (transform.boxAxis() ? " with other slices" : " camera grid") +
                         "; voxelize into GridTransform::box() with linear slices"};
    BoxVoxels voxels(grid);
    if (attributes == nullptr)
        return voxels;
    auto rank = BitRank::create(grid);
    if (!rank)
        return rank.error();
    for (const std::size_t size :
         {attributes->colors.size(), attributes->normals.size(), attributes->hits.size()})
        if (size != 0 && size != rank->count())
            return Error{ErrorCode::InvalidArgument,
                         "voxels: expected attributes of " + std::to_string(rank->count()) +
                             " set voxels, found " + std::to_string(size) +
                             "; give those of the same grid"};
    voxels.mAttributes = attributes;
    voxels.mRank = std::make_unique<const BitRank>(std::move(*rank));
    return voxels;
}

std::size_t BoxVoxels::index(const glm::uvec3& voxel) const {
    const glm::uvec3 axes = boxGridAxes(*mGrid->transform().boxAxis());
    return (*mRank)({voxel[axes.x], voxel[axes.y], voxel[axes.z]});
}

glm::u8vec4 BoxVoxels::color(const glm::uvec3& voxel) const {
    const std::size_t i = index(voxel);
    return isKnown(i) ? mAttributes->colors[i] : glm::u8vec4(0);
}

glm::vec3 BoxVoxels::normal(const glm::uvec3& voxel) const {
    const std::size_t i = index(voxel);
    return isKnown(i) ? mAttributes->normals[i] : glm::vec3(0.0f);
}

BoxVoxels::BoxVoxels(const BitGrid& grid)
    : mGrid(&grid) {
    const glm::uvec3 axes = boxGridAxes(*grid.transform().boxAxis());
    for (int i = 0; i < 3; ++i)
        mSize[static_cast<int>(axes[i])] = grid.size()[i];
    mSliceAxis = static_cast<int>(axes.z);
    mStride[axes.x] = 4;
    mStride[axes.y] = std::size_t{4} * grid.size().x;
    mStride[axes.z] = 0;
    mGroupStride = mStride[axes.y] * grid.size().y;
}

void BoxVoxels::load(AxisOrder order, const glm::uvec3& low, const glm::uvec3& extent,
                     BitBlock& block) const {
    assert(low.x % 32 == 0);
    block.extent = extent;
    block.rowWords = (extent.x + 31) / 32;
    block.words.assign(static_cast<std::size_t>(block.rowWords) * extent.y * extent.z, 0);
    const std::uint32_t* source = mGrid->words().data();
    const auto wordOffset = [&](std::uint32_t slice) {
        return (slice >> 7u) * mGroupStride + ((slice >> 5u) & 3u);
    };

    if (mSliceAxis == order.fast) {
        const std::uint32_t tail = extent.x % 32;
        const std::uint32_t tailMask = tail == 0 ? ~0u : (1u << tail) - 1u;
        std::uint32_t* target = block.words.data();
        for (std::uint32_t s = 0; s < extent.z; ++s)
            for (std::uint32_t m = 0; m < extent.y; ++m, target += block.rowWords) {
                const std::uint32_t* column = source + (low.y + m) * mStride[order.middle] +
                                              (low.z + s) * mStride[order.slow];
                for (std::uint32_t w = 0; w < block.rowWords; ++w)
                    target[w] = column[wordOffset(low.x + 32 * w)];
                target[block.rowWords - 1] &= tailMask;
            }
        return;
    }

    // A column's bits run along the middle or the slowest axis: 32 columns that are neighbours
    // along the fastest axis are transposed, 32 slices at a time.
    const bool slicesAreSlow = mSliceAxis == order.slow;
    const std::uint32_t firstSlice = slicesAreSlow ? low.z : low.y;
    const std::uint32_t endSlice = firstSlice + (slicesAreSlow ? extent.z : extent.y);
    const int otherAxis = slicesAreSlow ? order.middle : order.slow;
    const std::uint32_t otherLow = slicesAreSlow ? low.y : low.z;
    const std::uint32_t otherCount = slicesAreSlow ? extent.y : extent.z;
    const std::size_t rowWords = block.rowWords;
    const std::size_t sliceStride = slicesAreSlow ? rowWords * extent.y : rowWords;
    const std::size_t otherStride = slicesAreSlow ? rowWords : rowWords * extent.y;
    const std::size_t fastStride = mStride[order.fast];
    for (std::uint32_t other = 0; other < otherCount; ++other)
        for (std::uint32_t w = 0; w < block.rowWords; ++w) {
            const std::uint32_t columns = std::min(32u, extent.x - 32 * w);
            const std::uint32_t* first =
                source + (otherLow + other) * mStride[otherAxis] + (low.x + 32 * w) * fastStride;
            for (std::uint32_t base = firstSlice & ~31u; base < endSlice; base += 32) {
                std::uint32_t bits[32] = {};
                std::uint32_t any = 0;
                for (std::uint32_t c = 0; c < columns; ++c)
                    any |= bits[c] = first[c * fastStride + wordOffset(base)];
                if (any == 0)
                    continue;
                transpose32(bits);
                const std::uint32_t begin = std::max(base, firstSlice);
                const std::uint32_t end = std::min(base + 32, endSlice);
                for (std::uint32_t slice = begin; slice < end; ++slice)
                    block.words[(slice - firstSlice) * sliceStride + other * otherStride + w] =
                        bits[slice - base];
            }
        }
}

namespace {

constexpr std::array<std::array<std::uint8_t, 8>, 256> kExpanded = [] {
    std::array<std::array<std::uint8_t, 8>, 256> table{};
    for (unsigned value = 0; value < 256; ++value)
        for (unsigned bit = 0; bit < 8; ++bit)
            table[value][bit] = (value >> bit) & 1u;
    return table;
}();

} // namespace

void expandBits(std::span<const std::uint32_t> words, std::size_t count, std::uint8_t* bytes) {
    for (std::size_t done = 0; done < count; done += 8) {
        const auto& expanded = kExpanded[(words[done / 32] >> (done % 32)) & 0xffu];
        std::memcpy(bytes + done, expanded.data(), std::min<std::size_t>(8, count - done));
    }
}

} // namespace lamina::detail
