#pragma once

#include "grid_io/box_voxels.hpp"

#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

namespace lamina::detail {

/// A ray in voxel coordinates. `direction` need not have unit length: distances count its
/// multiples.
struct VoxelRay {
    glm::dvec3 origin;
    glm::dvec3 direction;
};

struct VoxelHit {
    double distance = 0.0;
    glm::ivec3 voxel{0};
    int axis = 0;  ///< The axis of the face that the ray enters.
    int side = -1; ///< That face's outward normal along the axis: -1 or 1.
};

/// Voxels as a sparse tree for fast ray casts: bricks of 4, nodes of 16 and cells of 64 voxels a
/// side, each of 4 x 4 x 4 children. Coordinates follow world x, y, z.
class VoxelTree {
public:
    explicit VoxelTree(const BoxVoxels& voxels);

    [[nodiscard]] bool isEmpty() const { return mLow.x >= mHigh.x; }
    /// The set voxels' box [low, high).
    [[nodiscard]] const glm::ivec3& low() const { return mLow; }
    [[nodiscard]] const glm::ivec3& high() const { return mHigh; }

    /// Any integer voxel; false outside the grid.
    [[nodiscard]] bool test(const glm::ivec3& voxel) const;

    /// The first set voxel whose box the ray enters at a distance in (0, limit). The voxel that
    /// holds the origin counts, at the distance 0.
    [[nodiscard]] std::optional<VoxelHit> cast(const VoxelRay& ray, double limit) const;

private:
    /// 64 children, of which child (x,y,z) stands at x + 4y + 16z.
    template<class Child>
    using Children = std::array<Child, 64>;

    std::uint32_t buildCell(const BitBlock& block);
    void extendBounds(const BitBlock& block, const glm::uvec3& low);
    /// Where the ray enters the box of set voxels, or is in it; nothing if it passes by.
    [[nodiscard]] std::optional<VoxelHit> enter(const VoxelRay& ray, double limit) const;
    [[nodiscard]] bool inBox(const glm::ivec3& voxel) const;
    /// The side of the largest empty aligned cube around a voxel of the grid that the tree knows;
    /// 0 if the voxel is set.
    [[nodiscard]] int emptySide(int x, int y, int z) const;

    glm::ivec3 mCellCounts{0};
    // Index 0 stands for a child without a set voxel.
    std::vector<std::uint32_t> mCells;            ///< Into mNodes; x fastest.
    std::vector<Children<std::uint32_t>> mNodes;  ///< A cell's nodes, into mBricks.
    std::vector<Children<std::uint64_t>> mBricks; ///< A node's bricks, a bit a voxel.
    glm::ivec3 mLow{std::numeric_limits<int>::max()}, mHigh{0};
};

} // namespace lamina::detail
