#pragma once

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

#include <algorithm>
#include <array>
#include <cmath>

namespace lamina::reference {

/// What of a voxel a triangle must meet for the voxel to count.
enum class VoxelShape {
    Cube,      ///< The closed unit cube: conservative coverage.
    Crosshair, ///< The octahedron around the three axis segments through the centre: the thin,
               ///< 6-separating coverage of Schwarz and Seidel (2010).
};

/// A block of voxels, both ends inclusive; empty if first > last on any axis.
struct VoxelBox {
    glm::ivec3 first, last;
};

/// The voxels, each grown by `grow`, whose shadows on the grid axes overlap the triangle's.
template<class Scalar>
[[nodiscard]] VoxelBox voxelsAround(const std::array<glm::vec<3, Scalar>, 3>& triangle,
                                    Scalar grow) {
    using Vec3 = glm::vec<3, Scalar>;
    const Vec3 low = glm::min(triangle[0], glm::min(triangle[1], triangle[2]));
    const Vec3 high = glm::max(triangle[0], glm::max(triangle[1], triangle[2]));
    const Vec3 base = glm::floor(low);
    return {glm::ivec3(base) + glm::ivec3(glm::ceil(low - base - static_cast<Scalar>(1) - grow)),
            glm::ivec3(base) + glm::ivec3(glm::floor(high - base + grow))};
}

/// Which voxels a triangle meets, by separating axes, in grid coordinates (voxel (i,j,k) is the
/// closed cube [i,i+1] x [j,j+1] x [k,k+1]).
///
/// A triangle and a voxel are apart if and only if their shadows on one of 13 axes are: the 3 grid
/// axes, the triangle's normal, and the 9 cross products of a triangle edge with a grid axis. Each
/// shadow of the triangle is the range of its three vertices, so segments, points and rounded
/// normals need no special case. Shadows that touch overlap.
template<class Scalar>
class TriangleBoxTest {
public:
    using Vec3 = glm::vec<3, Scalar>;

    /// triangle: grid coordinates below 2^30; grow: enlarges the voxels on every side, in voxels.
    TriangleBoxTest(const std::array<Vec3, 3>& triangle, VoxelShape shape, Scalar grow = 0);

    /// The voxels whose shadows on the grid axes overlap the triangle's, both inclusive.
    [[nodiscard]] const glm::ivec3& first() const { return mBounds.first; }
    [[nodiscard]] const glm::ivec3& last() const { return mBounds.last; }

    /// Do the shadows on the axes at right angles to z overlap? Same for all voxels of a column.
    [[nodiscard]] bool overlapsColumn(int x, int y) const {
        const Scalar u = static_cast<Scalar>(x - mBase.x);
        const Scalar v = static_cast<Scalar>(y - mBase.y);
        return holds(mEdgeAxes[2], u, v);
    }

    /// Narrows [first, last] to the voxels of a column that the triangle's plane can meet; never
    /// drops one that overlapsVoxel() would accept.
    void narrow(int x, int y, int& first, int& last) const {
        if (mNormal.z == 0)
            return;
        const Scalar rest = mNormal.x * static_cast<Scalar>(x - mBase.x) +
                            mNormal.y * static_cast<Scalar>(y - mBase.y);
        const Scalar a = (mNormalLow - rest) / mNormal.z;
        const Scalar b = (mNormalHigh - rest) / mNormal.z;
        const Scalar low = std::max(std::min(a, b) - 1, static_cast<Scalar>(first - mBase.z));
        const Scalar high = std::min(std::max(a, b) + 1, static_cast<Scalar>(last - mBase.z));
        if (!(low <= high)) {
            last = first - 1;
            return;
        }
        first = mBase.z + static_cast<int>(std::floor(low));
        last = mBase.z + static_cast<int>(std::ceil(high));
    }

    /// Given that first() <= (x,y,z) <= last() and overlapsColumn(x, y): does the triangle meet
    /// the voxel?
    [[nodiscard]] bool overlapsVoxel(int x, int y, int z) const {
        const Scalar u = static_cast<Scalar>(x - mBase.x);
        const Scalar v = static_cast<Scalar>(y - mBase.y);
        const Scalar w = static_cast<Scalar>(z - mBase.z);
        const Scalar along = mNormal.x * u + mNormal.y * v + mNormal.z * w;
        return mNormalLow <= along && along <= mNormalHigh && holds(mEdgeAxes[0], v, w) &&
               holds(mEdgeAxes[1], w, u);
    }

    /// Does the triangle meet the voxel? Any voxel.
    [[nodiscard]] bool overlaps(const glm::ivec3& voxel) const {
        return glm::all(glm::lessThanEqual(first(), voxel)) &&
               glm::all(glm::lessThanEqual(voxel, last())) && overlapsColumn(voxel.x, voxel.y) &&
               overlapsVoxel(voxel.x, voxel.y, voxel.z);
    }

private:
    /// The voxels with low corner (p, q) in a coordinate plane whose shadows on the axis (a, b) of
    /// that plane overlap the triangle's: low <= a p + b q <= high.
    struct Strip {
        Scalar a, b, low, high;
    };
    using Strips = std::array<Strip, 3>;

    static bool holds(const Strips& strips, Scalar p, Scalar q) {
        for (const Strip& strip : strips) {
            const Scalar along = strip.a * p + strip.b * q;
            if (!(strip.low <= along && along <= strip.high))
                return false;
        }
        return true;
    }

    /// Half the length of a voxel's shadow on `axis`, times the axis's length.
    static Scalar radius(const Vec3& axis, VoxelShape shape, Scalar grow) {
        const Vec3 sizes = glm::abs(axis);
        const Scalar reach = shape == VoxelShape::Cube
                                 ? sizes.x + sizes.y + sizes.z
                                 : std::max(sizes.x, std::max(sizes.y, sizes.z));
        return reach * (static_cast<Scalar>(0.5) + grow);
    }

    /// The range of axis . corner, for low corners of voxels whose shadow overlaps the triangle's.
    void range(const std::array<Vec3, 3>& local, const Vec3& axis, VoxelShape shape, Scalar grow,
               Scalar& low, Scalar& high) const {
        const Scalar a = glm::dot(axis, local[0]);
        const Scalar b = glm::dot(axis, local[1]);
        const Scalar c = glm::dot(axis, local[2]);
        const Scalar center = static_cast<Scalar>(0.5) * (axis.x + axis.y + axis.z);
        const Scalar reach = radius(axis, shape, grow);
        low = std::min(a, std::min(b, c)) - center - reach;
        high = std::max(a, std::max(b, c)) - center + reach;
    }

    /// Small numbers lose less: everything is relative to this voxel.
    glm::ivec3 mBase;
    VoxelBox mBounds;
    Vec3 mNormal;
    Scalar mNormalLow, mNormalHigh;
    std::array<Strips, 3> mEdgeAxes; ///< Cross products of the edges with x, y and z.
};

template<class Scalar>
TriangleBoxTest<Scalar>::TriangleBoxTest(const std::array<Vec3, 3>& triangle, VoxelShape shape,
                                         Scalar grow)
    : mBounds(voxelsAround(triangle, grow)) {
    mBase = glm::ivec3(glm::floor(glm::min(triangle[0], glm::min(triangle[1], triangle[2]))));
    const Vec3 base(mBase);
    const std::array<Vec3, 3> local = {triangle[0] - base, triangle[1] - base, triangle[2] - base};
    mNormal = glm::cross(local[1] - local[0], local[2] - local[0]);
    range(local, mNormal, shape, grow, mNormalLow, mNormalHigh);
    for (int edge = 0; edge < 3; ++edge) {
        const Vec3 e = local[(edge + 1) % 3] - local[edge];
        for (int axis = 0; axis < 3; ++axis) {
            const int p = (axis + 1) % 3;
            const int q = (axis + 2) % 3;
            Vec3 direction(0);
            direction[p] = -e[q];
            direction[q] = e[p];
            Strip& strip = mEdgeAxes[axis][edge];
            strip.a = direction[p];
            strip.b = direction[q];
            range(local, direction, shape, grow, strip.low, strip.high);
        }
    }
}

} // namespace lamina::reference
