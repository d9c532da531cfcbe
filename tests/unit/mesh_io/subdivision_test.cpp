#include "mesh_samples.hpp"

#include <lamina/mesh_io/mesh_report.hpp>
#include <lamina/mesh_io/subdivision.hpp>

#include <glm/geometric.hpp>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

namespace lamina {
namespace {

TriangleMesh octahedron() {
    return {
        {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}},
        {},
        {},
        {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4}, {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}}};
}

TEST(Subdivision, LoopRulesOnAnOctahedron) {
    const Result<TriangleMesh> fine = subdivide(octahedron(), 1);
    ASSERT_TRUE(fine) << fine.error().text;
    ASSERT_TRUE(validate(*fine));
    EXPECT_EQ(fine->triangles.size(), 32u);
    EXPECT_EQ(fine->positions.size(), 18u);
    EXPECT_EQ(fine->normals.size(), 18u);
    // Loop's weight for valence 4: alpha = (40 - (3 + 2 cos(pi/2))^2) / 64 = 31/64; the four
    // neighbours of a corner cancel out. An edge's middle: 3/8 of its ends, 1/8 of the two others.
    int corners = 0, middles = 0;
    for (const glm::vec3& p : fine->positions) {
        const float longest = std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)});
        const float sum = std::abs(p.x) + std::abs(p.y) + std::abs(p.z);
        corners += std::abs(longest - (1 - 31.0f / 64)) < 1e-6f && std::abs(sum - longest) < 1e-6f;
        middles += std::abs(longest - 0.375f) < 1e-6f && std::abs(sum - 0.75f) < 1e-6f;
    }
    EXPECT_EQ(corners, 6);
    EXPECT_EQ(middles, 12);
    for (std::size_t i = 0; i < fine->positions.size(); ++i)
        EXPECT_GT(glm::dot(fine->normals[i], glm::normalize(fine->positions[i])), 0.9f);
}

TEST(Subdivision, KeepsAClosedMeshClosedAndScalesByFour) {
    TriangleMesh soup; // unwelded on purpose
    for (const glm::uvec3& t : samples::cubeTriangles()) {
        const auto first = static_cast<unsigned>(soup.positions.size());
        for (int corner = 0; corner < 3; ++corner)
            soup.positions.push_back(samples::cubePositions()[t[corner]]);
        soup.triangles.emplace_back(first, first + 1, first + 2);
    }
    for (const unsigned levels : {0u, 1u, 4u}) {
        const Result<TriangleMesh> fine = subdivide(soup, levels);
        ASSERT_TRUE(fine) << fine.error().text;
        EXPECT_EQ(fine->triangles.size(), 12u << (2 * levels));
        const Result<MeshReport> report = inspect(*fine);
        ASSERT_TRUE(report);
        EXPECT_TRUE(report->watertight());
        EXPECT_GT(report->signedVolume, 0.2);
    }
}

TEST(Subdivision, KeepsBoundariesAndSplitsTouchingFans) {
    const TriangleMesh bowTie{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {-1, 0, 0}, {0, -1, 0}},
                              {},
                              {},
                              {{0, 1, 2}, {0, 3, 4}, {3, 3, 4}}};
    const Result<TriangleMesh> fine = subdivide(bowTie, 2);
    ASSERT_TRUE(fine) << fine.error().text;
    EXPECT_EQ(fine->triangles.size(), 32u);
    EXPECT_EQ(inspect(*fine)->openEdges, 24u);

    // Two closed fans in one vertex: cubes that touch in a corner.
    TriangleMesh cubes = samples::cube();
    for (const glm::vec3& p : samples::cubePositions())
        cubes.positions.push_back(p + glm::vec3(1));
    for (const glm::uvec3& t : samples::cubeTriangles())
        cubes.triangles.push_back(t + 8u);
    testing::internal::CaptureStderr();
    const Result<TriangleMesh> both = subdivide(cubes, 1);
    EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
    ASSERT_TRUE(both) << both.error().text;
    EXPECT_EQ(both->triangles.size(), 96u);
    EXPECT_TRUE(inspect(*both)->watertight());
}

TEST(Subdivision, RefusesWhatItCannotDo) {
    TriangleMesh flipped = samples::cube();
    std::swap(flipped.triangles[0].x, flipped.triangles[0].y);
    testing::internal::CaptureStderr();
    const Result<TriangleMesh> refused = subdivide(flipped, 1);
    EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().code, ErrorCode::InvalidMesh);
    EXPECT_THAT(refused.error().text, testing::HasSubstr("found 3 others"));

    const Result<TriangleMesh> huge = subdivide(samples::cube(), 14);
    ASSERT_FALSE(huge);
    EXPECT_EQ(huge.error().code, ErrorCode::InvalidArgument);
    EXPECT_THAT(huge.error().text, testing::HasSubstr("12 x 4^14"));
    EXPECT_FALSE(subdivide(samples::cube(), 4000000000u));
    EXPECT_FALSE(subdivide({}, 0));
    EXPECT_FALSE(subdivide({{{0, 0, 0}}, {}, {}, {{0, 0, 0}}}, 1));
}

} // namespace
} // namespace lamina
