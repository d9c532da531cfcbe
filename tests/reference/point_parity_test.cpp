#include <reference/point_parity.hpp>

#include <reference/shapes.hpp>
#include <reference/winding_number.hpp>

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace lamina::reference {
namespace {

TEST(PointParity, AgreesWithTheWindingNumber) {
    std::mt19937 random(3);
    std::uniform_real_distribution<float> place(-1.1f, 1.1f);
    std::vector<glm::vec3> points(2000);
    for (glm::vec3& point : points)
        point = {place(random), place(random), place(random)};
    const TriangleMesh knot = makeTorusKnot({0, 0, 0}, 0.55f, 0.12f, 2, 3, 64, 12);
    for (const Axis axis : {Axis::X, Axis::Y, Axis::Z}) {
        const std::vector<char> parity = pointParity(knot, points, axis);
        for (std::size_t i = 0; i < points.size(); ++i)
            EXPECT_EQ(parity[i] != 0, windingNumber(knot, points[i]) > 0.5) << i;
    }
}

TEST(PointParity, RaysThroughEdgesAndCornersCountOnce) {
    const TriangleMesh box = makeBox({0, 0, 0}, {2, 2, 2});
    // The diagonals of the faces meet the rays through these points.
    const std::vector<glm::vec3> points = {
        {1, 1, 1}, {0.5f, 0.5f, 0.5f}, {1.5f, 0.5f, 1}, {3, 1, 1}};
    for (const Axis axis : {Axis::X, Axis::Y, Axis::Z})
        EXPECT_EQ(pointParity(box, points, axis), (std::vector<char>{1, 1, 1, 0}));
}

TEST(SurfaceWithin, KnowsFacesEdgesAndCorners) {
    const TriangleMesh box = makeBox({0, 0, 0}, {2, 2, 2});
    const std::pair<glm::dvec3, double> cases[] = {{{1.2, 0.7, 3}, 1},
                                                   {{3, 1, 3}, std::sqrt(2)},
                                                   {{3, 3, 3}, std::sqrt(3)},
                                                   {{1, 1, 0.25}, 0.25}};
    for (const auto& [point, distance] : cases) {
        EXPECT_TRUE(surfaceWithin(box, point, distance + 1e-9));
        EXPECT_FALSE(surfaceWithin(box, point, distance - 1e-9));
    }
}

} // namespace
} // namespace lamina::reference
