#include <reference/test_support.hpp>
#include <reference/triangle_box.hpp>

#include <gtest/gtest.h>

#include <random>

namespace lamina::reference {
namespace {

using Triangle = std::array<glm::dvec3, 3>;

/// Is anything of the triangle left inside the closed voxel? Knows nothing of separating axes.
bool clippedToVoxel(const Triangle& triangle, const glm::ivec3& voxel) {
    std::vector<glm::dvec3> polygon(triangle.begin(), triangle.end());
    for (int axis = 0; axis < 3; ++axis) {
        glm::dvec3 normal(0.0);
        normal[axis] = 1.0;
        polygon = clipped(polygon, normal, voxel[axis]);
        polygon = clipped(polygon, -normal, -(voxel[axis] + 1.0));
    }
    return !polygon.empty();
}

bool overlaps(const Triangle& triangle, const glm::ivec3& voxel, double grow = 0.0) {
    return TriangleBoxTest<double>(triangle, VoxelShape::Cube, grow).overlaps(voxel);
}

/// Triangles of every kind: large, small, needles, segments, points, on a lattice.
Triangle randomTriangle(std::mt19937& engine, int kind) {
    std::uniform_real_distribution<double> wide(-3.0, 4.0), small(-0.4, 0.4);
    const auto point = [&] { return glm::dvec3(wide(engine), wide(engine), wide(engine)); };
    const auto offset = [&] { return glm::dvec3(small(engine), small(engine), small(engine)); };
    const glm::dvec3 a = point();
    const glm::dvec3 b = point();
    switch (kind % 6) {
    case 0:
        return {a, b, point()};
    case 1:
        return {a, a + offset(), a + offset()};
    case 2:
        return {a, b, a + 0.3 * (b - a) + 1e-3 * offset()};
    case 3:
        return {a, b, a + 1.7 * (b - a)};
    case 4:
        return {a, a, kind % 12 == 4 ? a : b};
    default:
        return {glm::round(4.0 * a) / 4.0, glm::round(4.0 * b) / 4.0,
                glm::round(4.0 * point()) / 4.0};
    }
}

TEST(TriangleBox, AgreesWithClippingOnRandomPairs) {
    std::mt19937 engine(1);
    int overlapping = 0, apart = 0, undecided = 0;
    for (int i = 0; i < 150000; ++i) {
        const Triangle triangle = randomTriangle(engine, i);
        const glm::ivec3 voxel(i % 3 - 1, i / 3 % 3 - 1, i / 9 % 3 - 1);
        const bool surely = overlaps(triangle, voxel, -1e-9);
        if (surely != overlaps(triangle, voxel, 1e-9)) {
            ++undecided; // touches within rounding: clipping may round either way
            continue;
        }
        EXPECT_EQ(overlaps(triangle, voxel), surely);
        ASSERT_EQ(clippedToVoxel(triangle, voxel), surely) << "pair " << i;
        ++(surely ? overlapping : apart);
    }
    EXPECT_GT(overlapping, 10000);
    EXPECT_GT(apart, 50000);
    // Only lattice triangles touch exactly.
    EXPECT_LT(undecided, 150000 / 6 / 4);
}

TEST(TriangleBox, ClosedVoxelsTouch) {
    const Triangle face = {glm::dvec3(0, 0, 1), glm::dvec3(1, 0, 1), glm::dvec3(0, 1, 1)};
    EXPECT_TRUE(overlaps(face, {0, 0, 0}));
    EXPECT_TRUE(overlaps(face, {0, 0, 1}));
    EXPECT_TRUE(overlaps(face, {1, 0, 1}));   // by its corner (1,0,1)
    EXPECT_TRUE(overlaps(face, {-1, -1, 0})); // by its corner (0,0,1)
    EXPECT_FALSE(overlaps(face, {1, 1, 1}));
    EXPECT_FALSE(overlaps(face, {0, 0, 2}));
    EXPECT_FALSE(overlaps(face, {0, 0, 0}, -1e-12));
    // Touching along an edge, in a corner, by a slanted face.
    const Triangle slanted = {glm::dvec3(2, 0, 0), glm::dvec3(0, 2, 0), glm::dvec3(1, 1, 1)};
    EXPECT_TRUE(overlaps(slanted, {0, 0, 0}));
    const Triangle corner = {glm::dvec3(3, 0, 0), glm::dvec3(0, 3, 0), glm::dvec3(0, 0, 3)};
    EXPECT_TRUE(overlaps(corner, {0, 0, 0})); // by the voxel's corner (1,1,1)
    EXPECT_FALSE(overlaps(corner, {0, 0, 0}, -1e-9));
    EXPECT_TRUE(overlaps(corner, {1, 1, 1}));
}

TEST(TriangleBox, DegenerateTrianglesAreSegmentsAndPoints) {
    const glm::dvec3 p(0.25, 0.5, 0.75), q(2.5, 0.5, 0.75);
    EXPECT_TRUE(overlaps({p, p, p}, {0, 0, 0}));
    EXPECT_FALSE(overlaps({p, p, p}, {1, 0, 0}));
    for (const Triangle& segment : {Triangle{p, q, p}, Triangle{p, p, q}, Triangle{q, p, p}})
        for (int x = -1; x < 4; ++x) {
            EXPECT_EQ(overlaps(segment, {x, 0, 0}), 0 <= x && x <= 2) << x;
            EXPECT_FALSE(overlaps(segment, {x, 1, 0})) << x;
        }
    // A diagonal segment passes the voxels beside its path by.
    const Triangle diagonal = {glm::dvec3(0.1, 0.2, 0.5), glm::dvec3(2.9, 2.8, 0.5),
                               glm::dvec3(0.1, 0.2, 0.5)};
    EXPECT_TRUE(overlaps(diagonal, {1, 1, 0}));
    EXPECT_FALSE(overlaps(diagonal, {2, 0, 0}));
    EXPECT_FALSE(overlaps(diagonal, {0, 2, 0}));
}

TEST(TriangleBox, FarFromTheOriginIsAsNear) {
    std::mt19937 engine(2);
    const glm::ivec3 far(1000000, -3000000, 70000);
    int overlapping = 0;
    for (int i = 0; i < 20000; ++i) {
        Triangle triangle = randomTriangle(engine, 5);
        const bool near = overlaps(triangle, {0, 0, 0});
        overlapping += near;
        for (glm::dvec3& corner : triangle)
            corner += glm::dvec3(far);
        EXPECT_EQ(overlaps(triangle, far), near);
    }
    EXPECT_GT(overlapping, 1000);
}

TEST(TriangleBox, NarrowingLosesNothing) {
    std::mt19937 engine(3);
    for (int i = 0; i < 3000; ++i) {
        const TriangleBoxTest<double> test(randomTriangle(engine, i), VoxelShape::Cube);
        for (int y = test.first().y; y <= test.last().y; ++y)
            for (int x = test.first().x; x <= test.last().x; ++x) {
                int first = test.first().z, last = test.last().z;
                test.narrow(x, y, first, last);
                for (int z = test.first().z; z <= test.last().z; ++z) {
                    const bool kept = first <= z && z <= last;
                    EXPECT_TRUE(kept || !test.overlaps({x, y, z}));
                }
            }
    }
}

TEST(TriangleBox, CrosshairIsMetWhereItsAxesAre) {
    const auto meets = [](const Triangle& triangle, const glm::ivec3& voxel) {
        return TriangleBoxTest<double>(triangle, VoxelShape::Crosshair).overlaps(voxel);
    };
    // x + y + z = s meets the crosshair of voxel 0 for s within 1/2 of 3/2.
    const auto slanted = [](double s) {
        return Triangle{glm::dvec3(s + 20, -10, -10), glm::dvec3(-10, s + 20, -10),
                        glm::dvec3(-10, -10, s + 20)};
    };
    EXPECT_FALSE(meets(slanted(0.99), {0, 0, 0}));
    EXPECT_TRUE(meets(slanted(1.01), {0, 0, 0}));
    EXPECT_TRUE(meets(slanted(1.99), {0, 0, 0}));
    EXPECT_FALSE(meets(slanted(2.01), {0, 0, 0}));
    EXPECT_TRUE(overlaps(slanted(0.99), {0, 0, 0}));
}

} // namespace
} // namespace lamina::reference
