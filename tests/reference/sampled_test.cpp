#include <reference/sampled.hpp>
#include <reference/shapes.hpp>
#include <reference/test_support.hpp>

#include <gtest/gtest.h>

#include <glm/gtc/matrix_transform.hpp>

#include <cmath>

namespace lamina::reference {
namespace {

bool isBetween(int low, int value, int high) {
    return low <= value && value <= high;
}

/// A camera at the origin of eye space = world, looking along -z; 90 degrees.
GridTransform perspectiveGrid(const glm::uvec3& size, double near, double far,
                              const SliceDistribution& slices = SliceDistribution::linear()) {
    const GridCamera camera =
        GridCamera::perspective(glm::dmat4(1.0), std::acos(0.0), 1.0, near, far);
    return *GridTransform::camera(camera, size, slices);
}

/// Direction per unit of depth of the ray through a column's centre of perspectiveGrid().
glm::dvec3 rayThrough(const GridTransform& grid, int x, int y) {
    return {2.0 * (x + 0.5) / grid.size().x - 1.0, 2.0 * (y + 0.5) / grid.size().y - 1.0, -1.0};
}

/// The slice an exact depth must be in, or -1. Fails the test if rounding could decide.
int sliceOf(const GridTransform& grid, double depth) {
    if (depth < grid.nearDepth() || depth > grid.farDepth())
        return -1;
    double boundary = 0.0;
    for (std::uint32_t k = 1; k <= grid.size().z; ++k) {
        boundary = grid.depthAtSlice(k);
        EXPECT_GT(std::abs(depth - boundary), 1e-9) << "choose another plane";
        if (depth < boundary)
            return static_cast<int>(k) - 1;
    }
    return -1;
}

TEST(Sampled, BoxOnVoxelBoundariesHasTwoFaces) {
    const auto grid = sampled(makeBox(glm::vec3(2), glm::vec3(6)), unitGrid(glm::uvec3(8)));
    ASSERT_TRUE(grid);
    EXPECT_EQ(differences(*grid,
                          [](const glm::ivec3& v) {
                              return isBetween(2, v.x, 5) && isBetween(2, v.y, 5) &&
                                     (v.z == 2 || v.z == 6);
                          }),
              0u);
}

TEST(Sampled, BoxOffVoxelBoundaries) {
    const GridTransform transform = unitGrid({8, 9, 10});
    const auto covering = sampled(makeBox(glm::vec3(2.25f), glm::vec3(5.75f)), transform);
    EXPECT_EQ(differences(*covering,
                          [](const glm::ivec3& v) {
                              return isBetween(2, v.x, 5) && isBetween(2, v.y, 5) &&
                                     (v.z == 2 || v.z == 5);
                          }),
              0u);
    const auto missing = sampled(makeBox(glm::vec3(2.6f), glm::vec3(5.4f)), transform);
    EXPECT_EQ(differences(*missing,
                          [](const glm::ivec3& v) {
                              return isBetween(3, v.x, 4) && isBetween(3, v.y, 4) &&
                                     (v.z == 2 || v.z == 5);
                          }),
              0u);
}

TEST(Sampled, EdgesThroughCentersFollowTheTopLeftRule) {
    const auto grid = sampled(makeBox(glm::vec3(2.5f), glm::vec3(5.5f)), unitGrid(glm::uvec3(8)));
    EXPECT_EQ(differences(*grid,
                          [](const glm::ivec3& v) {
                              return isBetween(2, v.x, 4) && isBetween(3, v.y, 5) &&
                                     (v.z == 2 || v.z == 5);
                          }),
              0u);
}

TEST(Sampled, ColumnsRunAlongTheGridsAxis) {
    const TriangleMesh mesh = makeBox({2, 1, 4}, {6, 3, 7});
    const auto alongX = sampled(mesh, unitGrid(glm::uvec3(8), Axis::X));
    EXPECT_EQ(differences(*alongX,
                          [](const glm::ivec3& v) {
                              return isBetween(1, v.x, 2) && isBetween(4, v.y, 6) &&
                                     (v.z == 2 || v.z == 6);
                          }),
              0u);
    const auto alongY = sampled(mesh, unitGrid(glm::uvec3(8), Axis::Y));
    EXPECT_EQ(differences(*alongY,
                          [](const glm::ivec3& v) {
                              return isBetween(4, v.x, 6) && isBetween(2, v.y, 5) &&
                                     (v.z == 1 || v.z == 3);
                          }),
              0u);
}

TEST(Sampled, NearAndFarBelongToTheGridAndNothingBeyond) {
    const GridTransform transform = unitGrid({4, 4, 8});
    const auto sliceCount = [&](float z) {
        return sampled(makePlane({2, 2, z}, {0, 0, 1}, 4), transform)->count();
    };
    EXPECT_EQ(sliceCount(0.0f), 16u);
    EXPECT_EQ(sliceCount(-1e-6f), 0u);
    EXPECT_EQ(sliceCount(8.0f), 16u);
    EXPECT_EQ(sliceCount(std::nextafter(8.0f, 9.0f)), 0u);
    const auto last = sampled(makePlane({2, 2, 8}, {0, 0, 1}, 4), transform);
    EXPECT_TRUE(last->test({1, 1, 7}));
}

TEST(Sampled, SlopedPlaneIsExactOnDyadicCoordinates) {
    // z = 1 + x / 2 + y / 4 over [0,16]^2: a quarter of the centres lie on slice boundaries.
    const auto height = [](double x, double y) { return 1.0 + x / 2.0 + y / 4.0; };
    TriangleMesh mesh;
    mesh.positions = {{0, 0, height(0, 0)},
                      {16, 0, height(16, 0)},
                      {16, 16, height(16, 16)},
                      {0, 16, height(0, 16)}};
    mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
    for (const TriangleMesh& wound : {mesh, flipped(mesh)}) {
        const auto grid = sampled(wound, unitGrid({16, 16, 16}));
        EXPECT_EQ(differences(*grid,
                              [&](const glm::ivec3& v) {
                                  return v.z == std::floor(height(v.x + 0.5, v.y + 0.5));
                              }),
                  0u);
    }
}

TEST(Sampled, SliversCountOnlyAtCenters) {
    const GridTransform transform = unitGrid(glm::uvec3(8));
    TriangleMesh sliver;
    sliver.positions = {{1.49f, 2.4f, 3.1f}, {1.51f, 2.4f, 3.1f}, {1.5f, 2.6f, 3.3f}};
    sliver.triangles = {{0, 1, 2}};
    const auto hit = sampled(sliver, transform);
    EXPECT_EQ(hit->count(), 1u);
    EXPECT_TRUE(hit->test({1, 2, 3}));
    for (glm::vec3& position : sliver.positions)
        position.x += 0.25f;
    EXPECT_EQ(sampled(sliver, transform)->count(), 0u);

    TriangleMesh edgeOn;
    edgeOn.positions = {{0.5f, 0.5f, 1}, {7.5f, 7.5f, 1}, {7.5f, 7.5f, 5}};
    edgeOn.triangles = {{0, 1, 2}};
    EXPECT_EQ(sampled(edgeOn, transform)->count(), 0u);
}

TEST(Sampled, ModelMatrixMovesTheMesh) {
    const TriangleMesh mesh = makeIcosphere(glm::vec3(0), 1, 2);
    glm::dmat4 model = glm::translate(glm::dmat4(1.0), glm::dvec3(8.25, 8.5, 9.0));
    model = glm::scale(model, glm::dvec3(6.0, 4.0, 5.0));
    const GridTransform transform = unitGrid(glm::uvec3(16));
    const auto moved = sampled(transformed(mesh, model), transform);
    const auto byModel = sampled(mesh, transform, {.model = model});
    EXPECT_GT(moved->count(), 100u);
    EXPECT_GT(compare(*moved, *byModel)->iou(), 0.995);
    EXPECT_EQ(sampled(mesh, transform)->count(),
              sampled(mesh, transform, {.model = glm::dmat4(1.0)})->count());
}

TEST(Sampled, PerspectivePlaneAtConstantDepthIsExact) {
    // Slice boundaries at whole depths; 49 is one of those where 1 / (1 / d) != d.
    const GridTransform grid = perspectiveGrid({16, 16, 64}, 1.0, 65.0);
    for (int depth = 1; depth <= 65; ++depth) {
        const TriangleMesh mesh =
            makePlane({0, 0, -static_cast<float>(depth)}, {0, 0, 1}, 4.0f * depth, 3);
        const auto bits = sampled(mesh, grid);
        const int slice = std::min(depth - 1, 63);
        EXPECT_EQ(differences(*bits, [&](const glm::ivec3& v) { return v.z == slice; }), 0u)
            << "depth " << depth;
    }
}

TEST(Sampled, PerspectiveSlopedPlaneFollowsTheRay) {
    const SliceDistribution custom = SliceDistribution::custom({0.0f, 0.1f, 0.5f, 0.625f, 1.0f});
    const GridTransform grids[] = {
        perspectiveGrid({20, 20, 32}, 1.0, 12.0),
        perspectiveGrid({20, 20, 32}, 1.0, 12.0, SliceDistribution::logarithmic()),
        perspectiveGrid({20, 20, 4}, 1.0, 12.0, custom)};
    for (const GridTransform& grid : grids) {
        // Large enough to fill the view where it is between near and far.
        TriangleMesh mesh = makePlane({0.3f, -0.2f, -4.1f}, {0.55f, -0.3f, 1.0f}, 400.0f);
        mesh.positions[1] += 2.0f * (mesh.positions[1] - mesh.positions[0]);
        mesh.positions[2] += 2.0f * (mesh.positions[2] - mesh.positions[0]);
        mesh.triangles = {{0, 1, 2}};
        const auto bits = sampled(mesh, grid);
        EXPECT_GT(bits->count(), 300u);
        // The plane that the float vertices really span.
        const glm::dvec3 p(mesh.positions[0]);
        const glm::dvec3 n =
            glm::cross(glm::dvec3(mesh.positions[1]) - p, glm::dvec3(mesh.positions[2]) - p);
        std::uint64_t wrong = 0;
        for (int y = 0; y < 20; ++y)
            for (int x = 0; x < 20; ++x) {
                const double depth = glm::dot(n, p) / glm::dot(n, rayThrough(grid, x, y));
                const int slice = depth > 0.0 ? sliceOf(grid, depth) : -1;
                for (int z = 0; z < static_cast<int>(grid.size().z); ++z)
                    wrong += bits->test({x, y, z}) != (z == slice);
            }
        EXPECT_EQ(wrong, 0u);
    }
}

TEST(Sampled, TrianglesThroughTheEyePlaneAreCut) {
    // A floor one unit below the eye, from far behind it to far before it.
    const GridTransform grid = perspectiveGrid({17, 32, 40}, 1.5, 12.0);
    TriangleMesh floor;
    floor.positions = {{-500, -1, 300}, {500, -1, 300}, {0, -1, -800}};
    floor.triangles = {{0, 1, 2}};
    const auto bits = sampled(floor, grid);
    std::uint64_t set = 0;
    for (int y = 0; y < 32; ++y)
        for (int x = 0; x < 17; ++x) {
            const double slope = -rayThrough(grid, x, y).y;
            const int slice = slope > 0.0 ? sliceOf(grid, 1.0 / slope) : -1;
            set += slice >= 0;
            for (int z = 0; z < 40; ++z)
                EXPECT_EQ(bits->test({x, y, z}), z == slice) << x << " " << y << " " << z;
        }
    EXPECT_GT(set, 100u);

    TriangleMesh behind = floor;
    for (glm::vec3& position : behind.positions)
        position.z += 900.0f;
    EXPECT_EQ(sampled(behind, grid)->count(), 0u);
}

TEST(Sampled, RefusesInvalidMeshes) {
    const auto result = sampled(TriangleMesh{}, unitGrid(glm::uvec3(4)));
    ASSERT_FALSE(result);
    EXPECT_EQ(result.error().code, ErrorCode::InvalidMesh);
}

} // namespace
} // namespace lamina::reference
