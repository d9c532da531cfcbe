#include <reference/overlap.hpp>

#include <glm/vector_relational.hpp>

#include <algorithm>
#include <atomic>
#include <thread>
#include <vector>

namespace lamina::reference {
namespace {

/// More slabs than threads, so that a crowded part of the grid is shared too.
constexpr std::uint32_t kSlabCount = 16;

/// World to grid coordinates as one matrix; for orthographic grids with linear slices.
glm::dmat4 worldToGrid(const GridTransform& transform) {
    const double scale = transform.size().z / (transform.farDepth() - transform.nearDepth());
    glm::dmat4 depthToSlice(1.0);
    depthToSlice[2][2] = scale;
    depthToSlice[3][2] = -transform.nearDepth() * scale;
    return depthToSlice * transform.worldToColumn();
}

template<class Scalar>
std::vector<glm::vec<3, Scalar>> gridPositions(const TriangleMesh& mesh,
                                               const glm::dmat4& meshToGrid) {
    std::vector<glm::vec<3, Scalar>> positions;
    positions.reserve(mesh.positions.size());
    for (const glm::vec3& position : mesh.positions)
        positions.emplace_back(meshToGrid * glm::dvec4(position, 1.0));
    return positions;
}

/// TriangleBoxTest's limit; NaN fails too.
template<class Vec3>
bool isWithinReach(const std::vector<Vec3>& positions) {
    return std::all_of(positions.begin(), positions.end(), [](const Vec3& position) {
        return glm::all(glm::lessThan(glm::abs(position), Vec3(1 << 30)));
    });
}

template<class Scalar>
void addTriangle(BitGrid& grid, const std::array<glm::vec<3, Scalar>, 3>& triangle,
                 VoxelShape shape, Scalar grow, const glm::ivec3& low, const glm::ivec3& high) {
    const VoxelBox bounds = voxelsAround(triangle, grow);
    const glm::ivec3 first = glm::max(bounds.first, low);
    const glm::ivec3 last = glm::min(bounds.last, high);
    // A triangle that stays within one row of whole cubes meets every cube of the row it spans.
    const glm::ivec3 more = glm::sign(bounds.last - bounds.first);
    if (shape == VoxelShape::Cube && grow >= 0 && more.x + more.y + more.z <= 1) {
        for (int y = first.y; y <= last.y; ++y)
            for (int x = first.x; x <= last.x; ++x)
                for (int z = first.z; z <= last.z; ++z)
                    grid.set({x, y, z});
        return;
    }
    const TriangleBoxTest<Scalar> test(triangle, shape, grow);
    for (int y = first.y; y <= last.y; ++y)
        for (int x = first.x; x <= last.x; ++x) {
            if (!test.overlapsColumn(x, y))
                continue;
            int front = first.z;
            int back = last.z;
            test.narrow(x, y, front, back);
            for (int z = std::max(front, first.z); z <= std::min(back, last.z); ++z)
                if (test.overlapsVoxel(x, y, z))
                    grid.set({x, y, z});
        }
}

} // namespace

template<class Scalar>
Result<void> addOverlap(BitGrid& grid, const TriangleMesh& mesh, VoxelShape shape,
                        const Options& options, unsigned threads) {
    const GridTransform& transform = grid.transform();
    if (transform.projection() != Projection::Orthographic ||
        transform.distribution().kind() != SliceDistribution::Kind::Linear)
        return Error{ErrorCode::Unsupported,
                     "reference overlap: expected an orthographic grid with linear slices, found " +
                         transform.describe() + "; use touched()"};
    if (auto valid = validate(mesh); !valid)
        return valid;

    using Vec3 = glm::vec<3, Scalar>;
    const auto positions = gridPositions<Scalar>(mesh, worldToGrid(transform) * options.model);
    if (!isWithinReach(positions))
        return Error{ErrorCode::InvalidArgument,
                     "reference overlap: expected vertices within 2^30 voxels of the grid"};
    const auto grow = static_cast<Scalar>(options.grow);
    const Vec3 gridLow = Vec3(-1) - grow;
    const Vec3 gridHigh = Vec3(grid.size()) + static_cast<Scalar>(1) + grow;

    const auto addRows = [&](std::int64_t firstRow, std::int64_t lastRow) {
        const glm::ivec3 low(0, firstRow, 0);
        const glm::ivec3 high(grid.size().x - 1, lastRow, grid.size().z - 1);
        const Scalar rowsLow = static_cast<Scalar>(firstRow) - 1 - grow;
        const Scalar rowsHigh = static_cast<Scalar>(lastRow) + 2 + grow;
        for (const glm::uvec3& indices : mesh.triangles) {
            const std::array<Vec3, 3> triangle = {positions[indices.x], positions[indices.y],
                                                  positions[indices.z]};
            const Vec3 min = glm::min(triangle[0], glm::min(triangle[1], triangle[2]));
            const Vec3 max = glm::max(triangle[0], glm::max(triangle[1], triangle[2]));
            if (max.y < rowsLow || min.y > rowsHigh || glm::any(glm::lessThan(max, gridLow)) ||
                glm::any(glm::greaterThan(min, gridHigh)))
                continue;
            addTriangle(grid, triangle, shape, grow, low, high);
        }
    };

    // Rows never share a word, so threads that own different rows need no locks.
    std::atomic<std::uint32_t> nextSlab{0};
    const std::uint64_t rows = grid.size().y;
    const auto work = [&] {
        for (std::uint64_t slab; (slab = nextSlab++) < kSlabCount;) {
            const auto begin = static_cast<std::int64_t>(slab * rows / kSlabCount);
            const auto end = static_cast<std::int64_t>((slab + 1) * rows / kSlabCount);
            if (begin < end)
                addRows(begin, end - 1);
        }
    };
    std::vector<std::jthread> helpers;
    for (unsigned i = 1; i < threads; ++i)
        helpers.emplace_back(work);
    work();
    return {};
}

template Result<void> addOverlap<double>(BitGrid&, const TriangleMesh&, VoxelShape, const Options&,
                                         unsigned);
template Result<void> addOverlap<float>(BitGrid&, const TriangleMesh&, VoxelShape, const Options&,
                                        unsigned);

namespace {

Result<BitGrid> newOverlap(const TriangleMesh& mesh, const GridTransform& transform,
                           VoxelShape shape, const Options& options) {
    auto grid = BitGrid::create(transform);
    if (!grid)
        return grid;
    if (auto added = addOverlap<double>(*grid, mesh, shape, options); !added)
        return added.error();
    return grid;
}

} // namespace

Result<BitGrid> overlap(const TriangleMesh& mesh, const GridTransform& transform,
                        const Options& options) {
    return newOverlap(mesh, transform, VoxelShape::Cube, options);
}

Result<BitGrid> separating6(const TriangleMesh& mesh, const GridTransform& transform,
                            const Options& options) {
    return newOverlap(mesh, transform, VoxelShape::Crosshair, options);
}

} // namespace lamina::reference
