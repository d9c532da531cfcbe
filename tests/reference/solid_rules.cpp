#include <reference/solid_rules.hpp>

#include <reference/crossings.hpp>

#include <glm/common.hpp>
#include <glm/ext/matrix_transform.hpp>
#include <glm/mat4x4.hpp>
#include <glm/vector_relational.hpp>

#include <algorithm>
#include <array>
#include <cassert>

namespace lamina::reference {
namespace {

/// From the voxel's centre to where its rays start.
const glm::dvec3 kNudge{0x1p-26, -0x1p-34, 0x1p-18};

std::size_t indexOf(const glm::ivec3& voxel, const glm::ivec3& size) {
    return (static_cast<std::size_t>(voxel.z) * static_cast<std::size_t>(size.y) +
            static_cast<std::size_t>(voxel.y)) *
               static_cast<std::size_t>(size.x) +
           static_cast<std::size_t>(voxel.x);
}

bool isInside(const glm::ivec3& voxel, const glm::ivec3& size) {
    return glm::all(glm::greaterThanEqual(voxel, glm::ivec3(0))) &&
           glm::all(glm::lessThan(voxel, size));
}

glm::dmat4 worldToGrid(const GridTransform& transform) {
    const glm::dvec3 origin = transform.worldToGrid({0, 0, 0});
    glm::dmat4 matrix(1.0);
    for (int axis = 0; axis < 3; ++axis) {
        glm::dvec3 unit(0.0);
        unit[axis] = 1.0;
        matrix[axis] = glm::dvec4(transform.worldToGrid(unit) - origin, 0.0);
    }
    matrix[3] = glm::dvec4(origin, 1.0);
    return matrix;
}

/// All lines of one direction: voxels v, v + step, v + 2 step and so on, seen as the columns of a
/// skewed camera that looks along `step`, one slice to a voxel.
class Direction {
public:
    Direction(const TriangleMesh& mesh, const GridTransform& transform, const glm::ivec3& step)
        : mSize(transform.size())
        , mStep(step)
        , mAlong(step.x != 0   ? 0
                 : step.y != 0 ? 1
                               : 2)
        , mAcross((mAlong + 1) % 3, (mAlong + 2) % 3)
        , mLow(columnOf(glm::ivec3(0)))
        , mHigh(mLow)
        , mCrossings(mesh, camera(transform)) {
        assert(step[mAlong] == 1);
    }

    void addVotes(std::vector<SolidVotes>& votes) const {
        for (int y = mLow.y; y <= mHigh.y; ++y)
            for (int x = mLow.x; x <= mHigh.x; ++x)
                addVotesOfLine({x, y}, votes);
    }

private:
    /// The line's voxel in the plane where the coordinate along it is 0.
    [[nodiscard]] glm::ivec2 columnOf(const glm::ivec3& voxel) const {
        const glm::ivec3 start = voxel - mStep * voxel[mAlong];
        return {start[mAcross.x], start[mAcross.y]};
    }

    [[nodiscard]] GridTransform camera(const GridTransform& transform) {
        for (int corner = 0; corner < 8; ++corner) {
            const glm::ivec3 bits(corner & 1, (corner >> 1) & 1, corner >> 2);
            mLow = glm::min(mLow, columnOf(bits * (mSize - 1)));
            mHigh = glm::max(mHigh, columnOf(bits * (mSize - 1)));
        }
        // Columns are the two coordinates across, sheared so that centres stay on centres; eye
        // space looks along -z.
        glm::dmat4 shear(0.0);
        for (int i = 0; i < 2; ++i) {
            shear[mAcross[i]][i] = 1.0;
            shear[mAlong][i] = -mStep[mAcross[i]];
            shear[3][i] = 0.5 * mStep[mAcross[i]];
        }
        shear[mAlong][2] = -1.0;
        shear[3][3] = 1.0;
        GridCamera camera;
        camera.worldToEye =
            shear * glm::translate(glm::dmat4(1.0), -kNudge) * worldToGrid(transform);
        camera.left = mLow.x;
        camera.right = mHigh.x + 1;
        camera.bottom = mLow.y;
        camera.top = mHigh.y + 1;
        camera.near = 0.0;
        camera.far = mSize[mAlong];
        const glm::uvec3 size(mHigh - mLow + 1, mSize[mAlong]);
        return GridTransform::camera(camera, size).value();
    }

    void addVotesOfLine(const glm::ivec2& column, std::vector<SolidVotes>& votes) const {
        const std::span<const Crossing> crossings = mCrossings.at(column - mLow);
        const auto signOf = [](const Crossing& crossing) { return crossing.frontFacing ? 1 : -1; };
        int total = 0;
        for (const Crossing& crossing : crossings)
            total += signOf(crossing);
        const bool byParity = total % 2 == 0 && total != 0;
        const auto vote = [byParity](int count) { return byParity ? count % 2 != 0 : count != 0; };
        int before = 0;
        std::size_t next = 0;
        for (int step = 0; step < mSize[mAlong]; ++step) {
            glm::ivec3 voxel = mStep * step;
            voxel[mAcross.x] += column.x;
            voxel[mAcross.y] += column.y;
            for (; next < crossings.size() && crossings[next].depth <= step + 0.5; ++next)
                before += signOf(crossings[next]);
            if (!isInside(voxel, mSize))
                continue;
            SolidVotes& mine = votes[indexOf(voxel, mSize)];
            std::uint8_t& sum = mStep[mAcross.x] == 0 ? mine.axes : mine.diagonals;
            sum = static_cast<std::uint8_t>(sum + (vote(before) ? 1 : 0) +
                                            (vote(total - before) ? 1 : 0));
        }
    }

    glm::ivec3 mSize;
    glm::ivec3 mStep;
    int mAlong;
    glm::ivec2 mAcross;
    glm::ivec2 mLow, mHigh; ///< Columns of the lines that meet the grid.
    ColumnCrossings mCrossings;
};

} // namespace

std::vector<SolidVotes> solidVotes(const TriangleMesh& mesh, const GridTransform& transform) {
    const glm::uvec3 size = transform.size();
    std::vector<SolidVotes> votes(std::size_t{size.x} * size.y * size.z);
    constexpr std::array<glm::ivec3, 7> kSteps{
        glm::ivec3(1, 0, 0),  glm::ivec3(0, 1, 0),  glm::ivec3(0, 0, 1),  glm::ivec3(1, 1, 1),
        glm::ivec3(1, 1, -1), glm::ivec3(1, -1, 1), glm::ivec3(1, -1, -1)};
    for (const glm::ivec3& step : kSteps)
        Direction(mesh, transform, step).addVotes(votes);
    return votes;
}

Result<BitGrid> unreached(const BitGrid& surface) {
    auto solid = BitGrid::create(surface.transform());
    if (!solid)
        return solid;
    const glm::ivec3 size(surface.size());
    std::vector<glm::ivec3> waiting;
    const auto reach = [&](const glm::ivec3& voxel) {
        if (isInside(voxel, size) && solid->test(voxel) && !surface.test(voxel)) {
            solid->set(voxel, false);
            waiting.push_back(voxel);
        }
    };
    for (int z = 0; z < size.z; ++z)
        for (int y = 0; y < size.y; ++y)
            for (int x = 0; x < size.x; ++x)
                solid->set({x, y, z});
    for (int z = 0; z < size.z; ++z)
        for (int y = 0; y < size.y; ++y)
            for (int x = 0; x < size.x; ++x)
                if (glm::any(glm::equal(glm::ivec3(x, y, z), glm::ivec3(0))) ||
                    glm::any(glm::equal(glm::ivec3(x, y, z), size - 1)))
                    reach({x, y, z});
    while (!waiting.empty()) {
        const glm::ivec3 voxel = waiting.back();
        waiting.pop_back();
        for (int axis = 0; axis < 3; ++axis)
            for (const int side : {-1, 1}) {
                glm::ivec3 neighbour = voxel;
                neighbour[axis] += side;
                reach(neighbour);
            }
    }
    return solid;
}

} // namespace lamina::reference
