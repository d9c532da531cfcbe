#include <reference/column_triangle.hpp>
#include <reference/shapes.hpp>
#include <reference/test_support.hpp>

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace lamina::reference {
namespace {

ColumnTriangle triangleOf(const glm::dvec2& a, const glm::dvec2& b, const glm::dvec2& c,
                          const glm::dvec3& depths, Projection projection) {
    ColumnTriangle triangle;
    triangle.corners = {a, b, c};
    triangle.depths = {depths.x, depths.y, depths.z};
    triangle.projection = projection;
    return triangle;
}

TEST(ColumnTriangle, SharedEdgesHaveOneOwner) {
    const GridTransform transform = unitGrid({32, 32, 1});
    const glm::dvec2 middle(16.5, 16.5);
    for (std::uint32_t seed = 1; seed <= 40; ++seed) {
        const unsigned count = 12 + seed % 7;
        const TriangleMesh fan = makeFan({16.5f, 16.5f, 0.5f}, 14.0f, count, seed);
        // On half-pixel vertices many edges run exactly through centres; unsnapped ones round.
        for (const TriangleMesh& mesh : {snapped(fan, transform, 2), fan}) {
            const auto triangles = columnTriangles(mesh, transform, glm::dmat4(1.0));
            for (int y = 0; y < 32; ++y)
                for (int x = 0; x < 32; ++x) {
                    const glm::dvec2 center(x + 0.5, y + 0.5);
                    int owners = 0;
                    for (const ColumnTriangle& triangle : triangles)
                        owners += owns(triangle, center);
                    EXPECT_LE(owners, 1) << x << " " << y;
                    if (glm::length(center - middle) < 9.5) {
                        EXPECT_EQ(owners, 1) << x << " " << y << " seed " << seed;
                    }
                }
        }
    }
}

TEST(ColumnTriangle, RoundingNeverLosesASharedEdge) {
    // Points on the edge up to rounding, edge and points of full double precision.
    std::mt19937_64 engine(11);
    std::uniform_real_distribution<double> uniform(-100.0, 100.0);
    for (int i = 0; i < 100000; ++i) {
        const auto random = [&] { return glm::dvec2(uniform(engine), uniform(engine)); };
        const glm::dvec2 a = random(), b = random();
        const glm::dvec2 along = b - a;
        const glm::dvec2 side(-along.y, along.x);
        ColumnTriangle left, right;
        left.corners = {a, b, a + 0.4 * along + 0.7 * side};
        right.corners = {b, a, a + 0.6 * along - 0.5 * side};
        if (i % 2 == 0)
            std::swap(right.corners[0], right.corners[1]);
        const double t = 0.2 + 0.6 * (uniform(engine) + 100.0) / 200.0;
        const glm::dvec2 point = a + t * along;
        EXPECT_EQ(owns(left, point) + owns(right, point), 1);
    }
}

TEST(ColumnTriangle, DepthIsAffineOrItsInverseIs) {
    const glm::dvec2 a(0, 0), b(4, 0), c(0, 4);
    const auto flat = triangleOf(a, b, c, {2, 4, 8}, Projection::Orthographic);
    EXPECT_EQ(depthAt(flat, a), 2.0);
    EXPECT_EQ(depthAt(flat, {2, 0}), 3.0);
    EXPECT_EQ(depthAt(flat, {1, 1}), 4.0);
    const auto seen = triangleOf(a, b, c, {2, 4, 8}, Projection::Perspective);
    EXPECT_DOUBLE_EQ(depthAt(seen, {2, 0}), 1.0 / (0.5 * (1.0 / 2 + 1.0 / 4)));
    EXPECT_DOUBLE_EQ(depthAt(seen, {2, 2}), 1.0 / (0.5 * (1.0 / 4 + 1.0 / 8)));
    // Equal depths stay exactly equal: 1 / (1 / 49) != 49.
    const auto level = triangleOf(a, b, c, glm::dvec3(49), Projection::Perspective);
    EXPECT_EQ(depthAt(level, {1, 1}), 49.0);
}

TEST(ColumnTriangle, OutlineDistance) {
    const auto triangle =
        triangleOf({0, 0}, {4, 0}, {0, 4}, glm::dvec3(1), Projection::Orthographic);
    EXPECT_EQ(outlineDistance(triangle, {1, 0.5}), 0.5);
    EXPECT_EQ(outlineDistance(triangle, {2, -3}), 3.0);
    EXPECT_EQ(outlineDistance(triangle, {7, -4}), 5.0);
    EXPECT_DOUBLE_EQ(outlineDistance(triangle, {3, 3}), std::sqrt(2.0));
}

TEST(ColumnTriangle, CornersJustBehindTheCutKeepThePlane) {
    // The cut leaves a quad of which two corners nearly coincide, wherever the cut one stands.
    const GridTransform grid = *GridTransform::camera(
        GridCamera::perspective(glm::dmat4(1.0), std::acos(0.0), 1.0, 1.0, 9.0), {8, 8, 8});
    const float justBehind = -static_cast<float>(kEyeCut) * (1.0f - 1e-6f);
    const glm::vec3 corners[] = {{0.001f, -0.002f, justBehind}, {3, 4, -8}, {-5, 1, -6}};
    for (unsigned first = 0; first < 3; ++first) {
        TriangleMesh mesh;
        mesh.positions.assign(std::begin(corners), std::end(corners));
        mesh.triangles = {{first, (first + 1) % 3, (first + 2) % 3}};
        const auto triangles = columnTriangles(mesh, grid, glm::dmat4(1.0));
        ASSERT_EQ(triangles.size(), 1u);
        EXPECT_EQ(triangles[0].cornerCount, 4);
        const glm::dvec3 p(corners[0]);
        const glm::dvec3 normal =
            glm::cross(glm::dvec3(corners[1]) - p, glm::dvec3(corners[2]) - p);
        for (const glm::dvec2 point : {glm::dvec2(4.7, 5.6), glm::dvec2(3.5, 4.4)}) {
            ASSERT_TRUE(owns(triangles[0], point));
            const glm::dvec3 ray(point.x / 4.0 - 1.0, point.y / 4.0 - 1.0, -1.0);
            const double depth = glm::dot(normal, p) / glm::dot(normal, ray);
            EXPECT_NEAR(depthAt(triangles[0], point), depth, 1e-9 * depth);
        }
    }
}

} // namespace
} // namespace lamina::reference
