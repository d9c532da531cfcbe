#include <reference/sampled.hpp>
#include <reference/shapes.hpp>
#include <reference/test_support.hpp>
#include <reference/volume.hpp>

#include <gtest/gtest.h>

#include <glm/geometric.hpp>
#include <glm/gtc/matrix_transform.hpp>

#include <algorithm>
#include <numeric>

namespace lamina::reference {
namespace {

std::uint64_t hits(const Volume& volume) {
    return std::accumulate(volume.counts.begin(), volume.counts.end(), std::uint64_t{0});
}

/// Is the point of the column plane inside the convex polygon? Its outline is no question here.
bool contains(const std::vector<glm::dvec3>& polygon, const glm::dvec2& point) {
    int left = 0;
    for (std::size_t i = 0; i < polygon.size(); ++i) {
        const glm::dvec2 a(polygon[i]);
        const glm::dvec2 b(polygon[(i + 1) % polygon.size()]);
        left += (b.x - a.x) * (point.y - a.y) - (b.y - a.y) * (point.x - a.x) > 0.0 ? 1 : 0;
    }
    return !polygon.empty() && (left == 0 || left == static_cast<int>(polygon.size()));
}

/// The definition taken literally: clip each triangle to each slab and test the centres.
std::vector<std::uint32_t> clippedCounts(const TriangleMesh& mesh, const glm::uvec3& size,
                                         double overlap) {
    std::vector<std::uint32_t> counts;
    for (unsigned z = 0; z < size.z; ++z)
        for (unsigned y = 0; y < size.y; ++y)
            for (unsigned x = 0; x < size.x; ++x) {
                std::uint32_t count = 0;
                for (const glm::uvec3& triangle : mesh.triangles) {
                    std::vector<glm::dvec3> polygon;
                    for (int i = 0; i < 3; ++i)
                        polygon.emplace_back(mesh.positions[triangle[i]]);
                    polygon = clipped(polygon, {0, 0, 1}, std::max(z - overlap, 0.0));
                    polygon =
                        clipped(polygon, {0, 0, -1}, -std::min(z + 1 + overlap, double(size.z)));
                    count += contains(polygon, {x + 0.5, y + 0.5});
                }
                counts.push_back(count);
            }
    return counts;
}

TEST(Volume, EqualsClippingToEachSlab) {
    const glm::uvec3 size{11, 9, 13};
    const TriangleMesh mesh = makeTriangleSoup({{0, 0, -3}, {11, 9, 16}}, 150, 6.0f, 5);
    for (const double overlap : {0.0, 0.25, 1.0}) {
        const Volume found = volume(mesh, unitGrid(size), {.slabOverlap = overlap});
        EXPECT_EQ(found.counts, clippedCounts(mesh, size, overlap)) << overlap;
        EXPECT_GT(hits(found), 200u);
    }
}

TEST(Volume, VoxelsWithHitsAreTheSampledOnes) {
    const TriangleMesh mesh = makeTorusKnot({8, 8, 8}, 3.5f, 1.2f, 2, 3, 60, 12);
    const GridTransform transform = unitGrid(glm::uvec3(16), Axis::X);
    const Volume found = volume(mesh, transform);
    EXPECT_EQ(differences(sampled(mesh, transform).value(),
                          [&](const glm::ivec3& v) { return found.counts[found.index(v)] > 0; }),
              0u);
}

TEST(Volume, ParallelQuadsCountOncePerSheet) {
    const Volume found =
        volume(makeParallelQuads({4, 4, 2.25f}, 8.0f, 3, 0.25f), unitGrid(glm::uvec3(8)));
    EXPECT_EQ(hits(found), 3u * 64u);
    EXPECT_EQ(found.counts[found.index({3, 5, 2})], 3u);
    EXPECT_EQ(found.normalSums[found.index({3, 5, 2})], glm::dvec3(0, 0, 3));
}

TEST(Volume, OverlapAddsTheNeighbourNearABoundary) {
    const TriangleMesh mesh = makePlane({4, 4, 3.125f}, {0, 0, 1}, 8.0f);
    const auto slices = [&](double overlap) {
        const Volume found = volume(mesh, unitGrid(glm::uvec3(8)), {.slabOverlap = overlap});
        std::vector<unsigned> set;
        for (unsigned z = 0; z < 8; ++z)
            if (found.counts[found.index({2, 2, z})] == 1)
                set.push_back(z);
        return set;
    };
    EXPECT_EQ(slices(0.0), (std::vector<unsigned>{3}));
    EXPECT_EQ(slices(0.1), (std::vector<unsigned>{3}));
    EXPECT_EQ(slices(0.25), (std::vector<unsigned>{2, 3}));
    EXPECT_EQ(slices(0.9), (std::vector<unsigned>{2, 3, 4}));
}

TEST(Volume, NormalsOfASphereAreRadialAndColoursInterpolate) {
    TriangleMesh mesh = makeIcosphere({8, 8, 8}, 6.0f, 4);
    for (const glm::vec3& position : mesh.positions) {
        mesh.normals.push_back((position - glm::vec3(8)) / 6.0f);
        mesh.colors.emplace_back(position / 16.0f, 1.0f);
    }
    const GridTransform transform = unitGrid(glm::uvec3(16));
    const Volume found = volume(mesh, transform);
    std::size_t checked = 0;
    for (unsigned z = 0; z < 16; ++z)
        for (unsigned y = 0; y < 16; ++y)
            for (unsigned x = 0; x < 16; ++x) {
                const std::size_t voxel = found.index({x, y, z});
                if (found.counts[voxel] != 1)
                    continue;
                // The hit lies on the column's centre line; the sphere gives its height.
                const glm::dvec2 offset = glm::dvec2(x, y) + 0.5 - 8.0;
                const double height = std::sqrt(36.0 - glm::dot(offset, offset));
                const glm::dvec3 radial(offset, z < 8 ? -height : height);
                EXPECT_GT(glm::dot(found.normalSums[voxel], radial) / 6.0, 0.999);
                EXPECT_LT(glm::length(found.colorSums[voxel] - (radial + 8.0) / 16.0), 0.01);
                ++checked;
            }
    EXPECT_GT(checked, 150u);
}

TEST(Volume, PerspectiveAndModelMatrix) {
    const GridCamera camera =
        GridCamera::perspective(glm::dmat4(1.0), std::acos(0.0), 1.0, 1.0, 9.0);
    const GridTransform transform = GridTransform::camera(camera, {8, 8, 8}).value();
    // A wall at depth 4.5, scaled up from a unit square and moved there; colours run along x.
    TriangleMesh wall = makePlane({0, 0, 0}, {0, 0, 1}, 2.0f);
    for (const glm::vec3& position : wall.positions)
        wall.colors.emplace_back(position.x, 0.0f, 0.0f, 1.0f);
    glm::dmat4 model = glm::translate(glm::dmat4(1.0), {0.0, 0.0, -4.5});
    model = glm::scale(model, glm::dvec3(9.0, 9.0, 1.0));
    const Volume found = volume(wall, transform, {.model = model});
    EXPECT_EQ(hits(found), 64u);
    for (unsigned x = 0; x < 8; ++x) {
        const std::size_t voxel = found.index({x, 3, 3});
        EXPECT_EQ(found.counts[voxel], 1u);
        EXPECT_NEAR(found.normalSums[voxel].z, 1.0, 1e-9);
        EXPECT_NEAR(found.colorSums[voxel].x, (x + 0.5 - 4.0) / 8.0, 1e-6);
    }
}

} // namespace
} // namespace lamina::reference
