#include "grid_io/voxel_tree.hpp"

#include <algorithm>
#include <bit>

#include <glm/common.hpp>

namespace lamina::detail {
namespace {

constexpr int kCellSide = 64;
constexpr int kNodeSide = 16;
constexpr int kBrickSide = 4;

/// Which child holds voxel (x,y,z) in a parent whose children have sides of 2^shift.
std::uint32_t childIndex(int x, int y, int z, int shift) {
    return static_cast<std::uint32_t>((x >> shift & 3) | (y >> shift & 3) << 2 |
                                      (z >> shift & 3) << 4);
}

glm::ivec3 childLow(std::uint32_t index, int side) {
    return side * glm::ivec3(index & 3u, index >> 2u & 3u, index >> 4u);
}

/// std::floor for values in the range of int: without SSE 4.1 that is a call, in the innermost
/// loop.
int floorToInt(double value) {
    const int truncated = static_cast<int>(value);
    return truncated - (value < truncated);
}

/// The brick whose low corner is `low` in a block whose rows are one or two words.
std::uint64_t brickMask(const BitBlock& block, const glm::ivec3& low) {
    std::uint64_t mask = 0;
    const int rows = std::min(kBrickSide, static_cast<int>(block.extent.y) - low.y);
    const int layers = std::min(kBrickSide, static_cast<int>(block.extent.z) - low.z);
    for (int z = 0; z < layers; ++z)
        for (int y = 0; y < rows; ++y) {
            const auto row = block.row(static_cast<std::uint32_t>(low.y + y),
                                       static_cast<std::uint32_t>(low.z + z));
            const std::uint64_t bits =
                row[static_cast<std::size_t>(low.x / 32)] >> (low.x % 32) & 15u;
            mask |= bits << (4 * y + 16 * z);
        }
    return mask;
}

} // namespace

VoxelTree::VoxelTree(const BoxVoxels& voxels)
    : mNodes(1)
    , mBricks(1) {
    const glm::uvec3 size = voxels.size();
    mCellCounts = glm::ivec3((size + glm::uvec3(kCellSide - 1)) / glm::uvec3(kCellSide));
    mCells.reserve(static_cast<std::size_t>(mCellCounts.x) * mCellCounts.y * mCellCounts.z);
    BitBlock block;
    glm::ivec3 cell;
    for (cell.z = 0; cell.z < mCellCounts.z; ++cell.z)
        for (cell.y = 0; cell.y < mCellCounts.y; ++cell.y)
            for (cell.x = 0; cell.x < mCellCounts.x; ++cell.x) {
                const glm::uvec3 low(cell * kCellSide);
                voxels.load({0, 1, 2}, low, glm::min(size - low, glm::uvec3(kCellSide)), block);
                mCells.push_back(buildCell(block));
                if (mCells.back() != 0)
                    extendBounds(block, low);
            }
}

std::uint32_t VoxelTree::buildCell(const BitBlock& block) {
    if (std::all_of(block.words.begin(), block.words.end(), [](std::uint32_t w) { return w == 0; }))
        return 0;
    const glm::ivec3 extent(block.extent);
    Children<std::uint32_t> nodes{};
    for (std::uint32_t n = 0; n < 64; ++n) {
        Children<std::uint64_t> bricks{};
        std::uint64_t any = 0;
        for (std::uint32_t b = 0; b < 64; ++b) {
            const glm::ivec3 low = childLow(n, kNodeSide) + childLow(b, kBrickSide);
            if (low.x < extent.x && low.y < extent.y && low.z < extent.z)
                any |= bricks[b] = brickMask(block, low);
        }
        if (any != 0) {
            nodes[n] = static_cast<std::uint32_t>(mBricks.size());
            mBricks.push_back(bricks);
        }
    }
    mNodes.push_back(nodes);
    return static_cast<std::uint32_t>(mNodes.size() - 1);
}

void VoxelTree::extendBounds(const BitBlock& block, const glm::uvec3& low) {
    for (std::uint32_t z = 0; z < block.extent.z; ++z)
        for (std::uint32_t y = 0; y < block.extent.y; ++y)
            for (std::uint32_t w = 0; w < block.rowWords; ++w)
                if (const std::uint32_t bits = block.row(y, z)[w]; bits != 0) {
                    const glm::ivec3 row(low + glm::uvec3(32 * w, y, z));
                    mLow = glm::min(mLow, row + glm::ivec3(std::countr_zero(bits), 0, 0));
                    mHigh = glm::max(mHigh, row + glm::ivec3(32 - std::countl_zero(bits), 1, 1));
                }
}

inline bool VoxelTree::inBox(const glm::ivec3& voxel) const {
    return voxel.x >= mLow.x && voxel.x < mHigh.x && voxel.y >= mLow.y && voxel.y < mHigh.y &&
           voxel.z >= mLow.z && voxel.z < mHigh.z;
}

inline int VoxelTree::emptySide(int x, int y, int z) const {
    const std::uint32_t cell = mCells[static_cast<std::size_t>(
        ((z >> 6) * mCellCounts.y + (y >> 6)) * mCellCounts.x + (x >> 6))];
    if (cell == 0)
        return kCellSide;
    const std::uint32_t node = mNodes[cell][childIndex(x, y, z, 4)];
    if (node == 0)
        return kNodeSide;
    const std::uint64_t brick = mBricks[node][childIndex(x, y, z, 2)];
    if (brick == 0)
        return kBrickSide;
    return (brick >> childIndex(x, y, z, 0) & 1u) == 0;
}

bool VoxelTree::test(const glm::ivec3& voxel) const {
    return inBox(voxel) && emptySide(voxel.x, voxel.y, voxel.z) == 0;
}

std::optional<VoxelHit> VoxelTree::enter(const VoxelRay& ray, double limit) const {
    if (isEmpty())
        return std::nullopt;
    // The box of set voxels is entered at the latest of the three near planes.
    VoxelHit hit;
    double leave = limit;
    for (int i = 0; i < 3; ++i) {
        const double direction = ray.direction[i];
        const double toLow = mLow[i] - ray.origin[i];
        const double toHigh = mHigh[i] - ray.origin[i];
        if (direction == 0.0) {
            if (toLow > 0.0 || toHigh <= 0.0)
                return std::nullopt;
            continue;
        }
        const double first = (direction > 0.0 ? toLow : toHigh) / direction;
        leave = std::min(leave, (direction > 0.0 ? toHigh : toLow) / direction);
        if (first > hit.distance) {
            hit.distance = first;
            hit.axis = i;
        }
    }
    if (hit.distance >= leave)
        return std::nullopt;
    const glm::dvec3 entry = ray.origin + hit.distance * ray.direction;
    for (int i = 0; i < 3; ++i)
        hit.voxel[i] = std::clamp(floorToInt(entry[i]), mLow[i], mHigh[i] - 1);
    return hit;
}

std::optional<VoxelHit> VoxelTree::cast(const VoxelRay& ray, double limit) const {
    auto hit = enter(ray, limit);
    if (!hit)
        return std::nullopt;
    const glm::dvec3 origin = ray.origin;
    const glm::dvec3 direction = ray.direction;
    glm::dvec3 inverse,
        never;          // Along an axis without motion: 0 and infinity, so that no exit is there.
    glm::ivec3 forward; // All bits or none.
    for (int i = 0; i < 3; ++i) {
        inverse[i] = direction[i] == 0.0 ? 0.0 : 1.0 / direction[i];
        never[i] = direction[i] == 0.0 ? std::numeric_limits<double>::infinity() : 0.0;
        forward[i] = direction[i] > 0.0 ? ~0 : 0;
    }

    // From one empty cube to the next. The voxel stays an integer: along the axis of the exit it is
    // exact, along the others it is kept inside the cube that is left, so that no rounding of the
    // position can skip a voxel or stand still.
    // Written out by axis: this loop takes most of a picture's time.
    int x = hit->voxel.x, y = hit->voxel.y, z = hit->voxel.z;
    while (const int side = emptySide(x, y, z)) {
        const int mask = ~(side - 1);
        const int lowX = x & mask, lowY = y & mask, lowZ = z & mask;
        const double exitX = (lowX + (forward.x & side) - origin.x) * inverse.x + never.x;
        const double exitY = (lowY + (forward.y & side) - origin.y) * inverse.y + never.y;
        const double exitZ = (lowZ + (forward.z & side) - origin.z) * inverse.z + never.z;
        const double exit = std::min({exitX, exitY, exitZ});
        if (exit >= limit)
            return std::nullopt;
        if (side > 1) {
            x = std::clamp(floorToInt(origin.x + exit * direction.x), lowX, lowX + side - 1);
            y = std::clamp(floorToInt(origin.y + exit * direction.y), lowY, lowY + side - 1);
            z = std::clamp(floorToInt(origin.z + exit * direction.z), lowZ, lowZ + side - 1);
        }
        if (exit == exitX) {
            hit->axis = 0;
            x = forward.x ? lowX + side : lowX - 1;
            if (x < mLow.x || x >= mHigh.x)
                return std::nullopt;
        } else if (exit == exitY) {
            hit->axis = 1;
            y = forward.y ? lowY + side : lowY - 1;
            if (y < mLow.y || y >= mHigh.y)
                return std::nullopt;
        } else {
            hit->axis = 2;
            z = forward.z ? lowZ + side : lowZ - 1;
            if (z < mLow.z || z >= mHigh.z)
                return std::nullopt;
        }
        hit->distance = std::max(exit, hit->distance);
    }
    hit->voxel = {x, y, z};
    hit->side = forward[hit->axis] ? -1 : 1;
    return hit;
}

} // namespace lamina::detail
