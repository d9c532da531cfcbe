#include "mesh_io/polygon_triangulator.hpp"

#include <glm/geometric.hpp>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <numeric>

namespace lamina::detail {
namespace {

std::vector<glm::uvec3> cut(const std::vector<glm::vec3>& polygon) {
    std::vector<std::uint32_t> indices(polygon.size());
    std::iota(indices.begin(), indices.end(), 0u);
    std::vector<glm::uvec3> triangles;
    PolygonTriangulator().append(polygon, indices, triangles);
    return triangles;
}

glm::dvec3 areaVector(const std::vector<glm::vec3>& polygon, const glm::uvec3& t) {
    const glm::dvec3 a(polygon[t.x]), b(polygon[t.y]), c(polygon[t.z]);
    return glm::cross(b - a, c - a) * 0.5;
}

/// No triangle turned over, and the areas add up: a tiling without overlap.
void expectTiling(const std::vector<glm::vec3>& polygon, double area) {
    const std::vector<glm::uvec3> triangles = cut(polygon);
    ASSERT_EQ(triangles.size(), polygon.size() - 2);
    glm::dvec3 sum(0.0);
    double total = 0;
    for (const glm::uvec3& t : triangles) {
        sum += areaVector(polygon, t);
        total += glm::length(areaVector(polygon, t));
    }
    EXPECT_NEAR(glm::length(sum), area, 1e-6 * area);
    EXPECT_NEAR(total, area, 1e-6 * area);
}

TEST(PolygonTriangulator, ConvexPolygonsAreFans) {
    EXPECT_THAT(cut({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}),
                testing::ElementsAre(glm::uvec3(0, 1, 2), glm::uvec3(0, 2, 3)));
    EXPECT_THAT(cut({{0, 0, 0}, {0, 0, 1}, {0, 1, 0}}), testing::ElementsAre(glm::uvec3(0, 1, 2)));
}

TEST(PolygonTriangulator, ConcavePolygonsAreTiled) {
    const std::vector<glm::vec3> arrow = {{0, 0, 0}, {2, -1, 0}, {1, 0, 0}, {2, 1, 0}};
    expectTiling(arrow, 1.0);
    for (std::size_t shift = 0; shift < 4; ++shift)
        for (int axis = 0; axis < 3; ++axis)
            for (const bool mirrored : {false, true}) {
                std::vector<glm::vec3> turned;
                for (std::size_t i = 0; i < 4; ++i) {
                    const glm::vec3 p = arrow[(mirrored ? 8 - shift - i : i + shift) % 4];
                    turned.emplace_back(p[axis], p[(axis + 1) % 3], p[(axis + 2) % 3]);
                }
                expectTiling(turned, 1.0);
            }
    // A comb of 40 teeth, tilted.
    std::vector<glm::vec3> comb;
    for (int i = 0; i < 40; ++i) {
        comb.emplace_back(i, 0, i);
        comb.emplace_back(i + 0.5, 5, i + 0.5);
    }
    comb.emplace_back(40, 0, 40);
    comb.emplace_back(40, -1, 40);
    comb.emplace_back(0, -1, 0);
    expectTiling(comb, (40 * 2.5 + 40) * std::sqrt(2.0));
}

TEST(PolygonTriangulator, OddPolygonsGiveTheirTriangles) {
    const float nan = std::nanf("");
    EXPECT_EQ(cut({{0, 0, 0}, {0, 0, 0}, {0, 0, 0}, {0, 0, 0}}).size(), 2u);
    EXPECT_EQ(cut({{0, 0, 0}, {1, 1, 0}, {1, 0, 0}, {0, 1, 0}}).size(), 2u); // crosses itself
    EXPECT_EQ(cut({{0, 0, 0}, {nan, 1, 0}, {1, 0, 0}, {0, 1, 0}, {2, 2, 2}}).size(), 3u);
    std::vector<glm::uvec3> triangles;
    PolygonTriangulator().append({}, std::vector<std::uint32_t>{9, 8, 7, 6}, triangles);
    EXPECT_THAT(triangles, testing::ElementsAre(glm::uvec3(0, 1, 2), glm::uvec3(0, 2, 3)));
}

TEST(PolygonTriangulator, HugePolygonsCostBoundedTime) {
    // A disc with one notch: each ear is found at once, and checked against all other corners.
    std::vector<glm::vec3> disc = {{0, 0, 0}};
    constexpr int kCorners = 200'000;
    for (int i = 0; i < kCorners; ++i)
        disc.emplace_back(std::cos(6.0 * i / kCorners), std::sin(6.0 * i / kCorners), 0);
    const auto start = std::chrono::steady_clock::now();
    EXPECT_EQ(cut(disc).size(), disc.size() - 2);
    EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(10));
}

} // namespace
} // namespace lamina::detail
