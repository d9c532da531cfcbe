#include <reference/column_triangle.hpp>
#include <reference/filled.hpp>
#include <reference/sampled.hpp>
#include <reference/shapes.hpp>
#include <reference/test_support.hpp>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace lamina::reference {
namespace {

GridTransform perspectiveGrid(const glm::uvec3& size, double near, double far) {
    const GridCamera camera =
        GridCamera::perspective(glm::dmat4(1.0), std::acos(0.0), 1.0, near, far);
    return *GridTransform::camera(camera, size, SliceDistribution::linear());
}

TriangleMesh quad(const glm::vec3& a, const glm::vec3& b, const glm::vec3& c, const glm::vec3& d) {
    TriangleMesh mesh;
    mesh.positions = {a, b, c, d};
    mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
    return mesh;
}

TEST(Filled, SlopedPlaneSpansItsRiseExactly) {
    // z = 1 + 3 y: a column's square rises from 1 + 3 j to 4 + 3 j, whose slice counts too.
    TriangleMesh mesh;
    mesh.positions = {{-16, 0, 1}, {32, 0, 1}, {8, 8, 25}};
    mesh.triangles = {{0, 1, 2}};
    const auto bits = filled(mesh, unitGrid({16, 8, 32}));
    for (int y = 0; y < 7; ++y)
        for (int z = 0; z < 32; ++z)
            EXPECT_EQ(bits->test({8, y, z}), 1 + 3 * y <= z && z <= 4 + 3 * y) << y << " " << z;
}

TEST(Filled, OnlyThePartInsideTheSquareCounts) {
    // Covers the centre of column (1,1) but only x in [1, 1.75] of it: z = 4 x from 4 to 7.
    const TriangleMesh mesh = quad({0.75f, 0, 3}, {1.75f, 0, 7}, {1.75f, 3, 7}, {0.75f, 3, 3});
    const auto bits = filled(mesh, unitGrid({4, 4, 16}));
    for (int z = 0; z < 16; ++z)
        EXPECT_EQ(bits->test({1, 1, z}), 4 <= z && z <= 7) << z;
    for (int z = 0; z < 16; ++z)
        EXPECT_FALSE(bits->test({0, 1, z})) << "the centre of column 0 is not covered";
    const auto all = touched(mesh, unitGrid({4, 4, 16}));
    for (int z = 0; z < 16; ++z)
        EXPECT_EQ(all->test({0, 1, z}), z == 3 || z == 4) << z;
}

TEST(Filled, FlatPlanesOnBoundariesBelongToOneSlice) {
    const GridTransform transform = unitGrid({4, 4, 8});
    for (int k = 0; k <= 8; ++k) {
        const auto bits = filled(makePlane({2, 2, k}, {0, 0, 1}, 4), transform);
        EXPECT_EQ(differences(*bits, [&](const glm::ivec3& v) { return v.z == std::min(k, 7); }),
                  0u);
    }
    EXPECT_EQ(filled(makePlane({2, 2, -0.01f}, {0, 0, 1}, 4), transform)->count(), 0u);
    EXPECT_EQ(filled(makePlane({2, 2, 8.01f}, {0, 0, 1}, 4), transform)->count(), 0u);
}

TEST(Filled, RangesAreClampedToNearAndFar) {
    const TriangleMesh steep = quad({0, 0, -20}, {4, 0, 60}, {4, 4, 60}, {0, 4, -20});
    const SliceDistribution custom = SliceDistribution::custom({0.0f, 0.125f, 0.25f, 1.0f});
    const GridTransform linear = unitGrid({4, 4, 8});
    const GridTransform uneven =
        *GridTransform::box({glm::dvec3(0), glm::dvec3(4, 4, 8)}, {4, 4, 3}, Axis::Z, custom);
    // Column 1 rises from 0 to 20, column 0 ends at 0, column 2 begins beyond far.
    for (const GridTransform& transform : {linear, uneven}) {
        const auto bits = filled(steep, transform);
        const int slices = static_cast<int>(transform.size().z);
        for (int z = 0; z < slices; ++z) {
            EXPECT_TRUE(bits->test({1, 1, z}));
            EXPECT_EQ(bits->test({0, 1, z}), z == 0);
            EXPECT_FALSE(bits->test({2, 1, z}));
        }
    }
}

/// Depth range of a mesh triangle inside the solid of a column, by clipping in the world.
std::optional<DepthSpan> clippedSpan(const TriangleMesh& mesh, std::size_t index,
                                     const GridTransform& grid, int x, int y) {
    // The worldToColumn rows give the column's four planes: X - x w >= 0 and so on.
    const glm::dmat4 rows = glm::transpose(grid.worldToColumn());
    std::vector<glm::dvec3> polygon;
    for (int i = 0; i < 3; ++i)
        polygon.emplace_back(mesh.positions[mesh.triangles[index][i]]);
    const auto clipTo = [&](const glm::dvec4& plane) {
        polygon = clipped(polygon, glm::dvec3(plane), -plane.w);
    };
    if (grid.projection() == Projection::Perspective)
        clipTo(rows[2] - glm::dvec4(0, 0, 0, grid.nearDepth() * kEyeCut));
    clipTo(rows[0] - rows[3] * static_cast<double>(x));
    clipTo(rows[3] * (x + 1.0) - rows[0]);
    clipTo(rows[1] - rows[3] * static_cast<double>(y));
    clipTo(rows[3] * (y + 1.0) - rows[1]);
    if (polygon.empty())
        return std::nullopt;
    DepthSpan span{INFINITY, -INFINITY};
    for (const glm::dvec3& point : polygon) {
        const double depth = glm::dot(rows[2], glm::dvec4(point, 1.0));
        span = {std::min(span.min, depth), std::max(span.max, depth)};
    }
    return span;
}

void expectSpansMatchClipping(const TriangleMesh& mesh, const GridTransform& grid) {
    const auto triangles = columnTriangles(mesh, grid, glm::dmat4(1.0));
    int compared = 0, steep = 0;
    for (const ColumnTriangle& triangle : triangles)
        for (int y = 0; y < static_cast<int>(grid.size().y); ++y)
            for (int x = 0; x < static_cast<int>(grid.size().x); ++x) {
                const auto expected = clippedSpan(mesh, triangle.source, grid, x, y);
                const auto found = depthSpan(triangle, {x, y}, {x + 1.0, y + 1.0});
                ASSERT_EQ(expected.has_value(), found.has_value());
                if (!found)
                    continue;
                ++compared;
                steep += found->max - found->min > 1.0;
                const double tolerance = 1e-9 * std::max(1.0, found->max * found->max);
                EXPECT_NEAR(expected->min, found->min, tolerance);
                EXPECT_NEAR(expected->max, found->max, tolerance);
            }
    EXPECT_GT(compared, 1000);
    EXPECT_GT(steep, 100);
}

TEST(Filled, DepthSpansEqualThoseOfClippingInTheWorld) {
    expectSpansMatchClipping(makeTriangleSoup({glm::dvec3(-2), glm::dvec3(14)}, 400, 5.0f, 3),
                             unitGrid(glm::uvec3(12)));
    expectSpansMatchClipping(makeTriangleSoup({glm::dvec3(-9), glm::dvec3(9)}, 400, 8.0f, 4),
                             perspectiveGrid({14, 14, 16}, 1.0, 9.0));
}

TEST(Filled, CutTrianglesKeepTheirWholeSpan) {
    // A floor below the eye that reaches behind it: the ray slope s has depth 1 / s.
    const GridTransform grid = perspectiveGrid({9, 32, 40}, 1.5, 12.0);
    TriangleMesh floor;
    floor.positions = {{-500, -1, 300}, {500, -1, 300}, {0, -1, -800}};
    floor.triangles = {{0, 1, 2}};
    const auto bits = filled(floor, grid);
    for (int y = 0; y < 32; ++y) {
        const double low = -(2.0 * y / 32 - 1.0);
        const double high = -(2.0 * (y + 1) / 32 - 1.0);
        const bool covered = low + high > 0.0;
        const double front = covered ? grid.sliceCoordinate(1.0 / low) : 100.0;
        const double back = covered && high > 0.0 ? grid.sliceCoordinate(1.0 / high) : 100.0;
        for (int z = 0; z < 40; ++z)
            EXPECT_EQ(bits->test({4, y, z}), front < z + 1 && back >= z) << y << " " << z;
    }
}

TEST(Filled, ContainsSampledAndIsContainedInTouched) {
    const TriangleMesh meshes[] = {
        makeTorusKnot({8, 8, 8}, 4.0f, 1.0f, 2, 3, 200, 12),
        makeTriangleSoup({glm::dvec3(-2), glm::dvec3(18)}, 2000, 6.0f, 5),
        makeSlivers({glm::dvec3(0), glm::dvec3(16)}, 5000, 3.0f, 0.05f, 6),
        makeMengerSponge({8, 8, 8}, 9.0f, 2)};
    GridCamera camera = GridCamera::perspective(glm::dmat4(1.0), 0.9, 1.0, 1.0, 25.0);
    camera.worldToEye[3] = glm::dvec4(-8, -7, -20, 1);
    const GridTransform grids[] = {unitGrid(glm::uvec3(16)), unitGrid(glm::uvec3(16), Axis::X),
                                   *GridTransform::camera(camera, {30, 30, 50})};
    for (const TriangleMesh& mesh : meshes)
        for (const GridTransform& grid : grids) {
            const auto points = sampled(mesh, grid);
            const auto columns = filled(mesh, grid);
            const auto all = touched(mesh, grid);
            EXPECT_GT(points->count(), 10u);
            EXPECT_GE(columns->count(), points->count());
            EXPECT_GT(all->count(), columns->count());
            EXPECT_TRUE(isSubset(*points, *columns));
            EXPECT_TRUE(isSubset(*columns, *all));
        }
}

TEST(Filled, GrowEnclosesFromBothSides) {
    const TriangleMesh mesh = makeTorusKnot({8, 8, 8}, 4.0f, 1.0f, 2, 3, 200, 12);
    const GridTransform grid = *GridTransform::box({glm::dvec3(0), glm::dvec3(16)}, glm::uvec3(64));
    const auto must = filled(mesh, grid, {.grow = -1e-3});
    const auto exact = filled(mesh, grid);
    const auto may = filled(mesh, grid, {.grow = 1e-3});
    EXPECT_TRUE(isSubset(*must, *exact));
    EXPECT_TRUE(isSubset(*exact, *may));
    EXPECT_LT(must->count(), exact->count());
    EXPECT_LT(exact->count(), may->count());
    EXPECT_GT(compare(*must, *may)->iou(), 0.97);
}

TEST(Filled, GrowDecidesTouchesAsItSays) {
    const GridTransform grid = unitGrid({8, 8, 8});
    // A plane at z = 4 + 5e-5 whose left edge misses the centres of column 2 by 5e-5.
    const float e = 1.0f / 16384;
    const TriangleMesh mesh =
        quad({2.5f + e, 0, 4 + e}, {6, 0, 4 + e}, {6, 8, 4 + e}, {2.5f + e, 8, 4 + e});
    const auto columns = [&](double grow, int x, int z) {
        return filled(mesh, grid, {.grow = grow})->test({x, 3, z});
    };
    EXPECT_FALSE(columns(0.0, 2, 4));
    EXPECT_FALSE(columns(0.5 * e, 2, 4));
    EXPECT_TRUE(columns(1.5 * e, 2, 4));
    EXPECT_FALSE(columns(0.5 * e, 4, 3));
    EXPECT_TRUE(columns(1.5 * e, 4, 3));
    EXPECT_TRUE(columns(-0.5 * e, 4, 4));
    EXPECT_FALSE(columns(-1.5 * e, 4, 4));
    EXPECT_TRUE(columns(-0.5 * e, 5, 4));
    // Its right edge passes the centres of column 5 by e.
    const TriangleMesh right =
        quad({0, 0, 4.5f}, {5.5f + e, 0, 4.5f}, {5.5f + e, 8, 4.5f}, {0, 8, 4.5f});
    EXPECT_TRUE(filled(right, grid, {.grow = -0.5 * e})->test({5, 3, 4}));
    EXPECT_FALSE(filled(right, grid, {.grow = -1.5 * e})->test({5, 3, 4}));
    // Without the centre rule the square alone decides.
    const TriangleMesh beside =
        quad({3 + e, 0, 4.5f}, {6 + e, 0, 4.5f}, {6 + e, 8, 4.5f}, {3 + e, 8, 4.5f});
    const auto isTouched = [&](double grow, int x) {
        return touched(beside, grid, {.grow = grow})->test({x, 3, 4});
    };
    EXPECT_FALSE(isTouched(0.5 * e, 2));
    EXPECT_TRUE(isTouched(1.5 * e, 2));
    EXPECT_TRUE(isTouched(-0.5 * e, 6));
    EXPECT_FALSE(isTouched(-1.5 * e, 6));
    // Edge-on triangles cover no centre, but may with some slack.
    TriangleMesh edgeOn;
    edgeOn.positions = {{0, 3.5f, 1}, {8, 3.5f, 1}, {8, 3.5f, 5}};
    edgeOn.triangles = {{0, 1, 2}};
    EXPECT_EQ(filled(edgeOn, grid)->count(), 0u);
    EXPECT_TRUE(filled(edgeOn, grid, {.grow = 1e-6})->test({7, 3, 4}));
    EXPECT_TRUE(touched(edgeOn, grid)->test({7, 3, 4}));
}

} // namespace
} // namespace lamina::reference
