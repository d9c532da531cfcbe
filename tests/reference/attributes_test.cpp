// The attribute reference on shapes whose areas and means are known.

#include <reference/attributes.hpp>
#include <reference/overlap.hpp>
#include <reference/shapes.hpp>
#include <reference/test_support.hpp>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

namespace lamina::reference {
namespace {

BitGrid touched(const TriangleMesh& mesh, const GridTransform& transform) {
    return overlap(mesh, transform).value();
}

TEST(AttributeReference, AreasOfATriangleSumUpToItsOwn) {
    TriangleMesh mesh;
    mesh.positions = {{0.3f, 0.4f, 0.2f}, {6.7f, 1.1f, 3.3f}, {2.2f, 5.9f, 4.8f}};
    mesh.triangles = {{0, 1, 2}};
    const BitGrid bits = touched(mesh, unitGrid({8, 8, 8}));
    double sum = 0.0;
    for (const VoxelSurface& surface : surfaces(mesh, bits))
        sum += surface.area;
    const glm::dvec3 a(mesh.positions[0]), b(mesh.positions[1]), c(mesh.positions[2]);
    EXPECT_NEAR(sum, 0.5 * glm::length(glm::cross(b - a, c - a)), 1e-12);
}

TEST(AttributeReference, AQuarteredSquareHasTheMeansOfItsParts) {
    // z = 0.5; red grows with x from 0 at 0 to 1 at 2.
    TriangleMesh mesh;
    mesh.positions = {{0, 0, 0.5f}, {2, 0, 0.5f}, {2, 2, 0.5f}, {0, 2, 0.5f}};
    mesh.colors = {{0, 0, 1, 1}, {1, 0, 1, 1}, {1, 0, 1, 1}, {0, 0, 1, 1}};
    mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
    const BitGrid bits = touched(mesh, unitGrid({2, 2, 1}));
    ASSERT_EQ(bits.count(), 4u);
    const std::vector<VoxelSurface> found = surfaces(mesh, bits);
    std::size_t i = 0;
    bits.forEachSet([&](const glm::uvec3& voxel) {
        const VoxelSurface& surface = found[i++];
        EXPECT_NEAR(surface.area, 1.0, 1e-12);
        EXPECT_NEAR(surface.color.r, voxel.x == 0 ? 0.25 : 0.75, 1e-12);
        EXPECT_NEAR(surface.color.b, 1.0, 1e-12);
        EXPECT_NEAR(surface.normal.z, 1.0, 1e-12);
        // Both triangles touch the voxels on the diagonal and the corner of the others.
        EXPECT_EQ(surface.hits, 2u);
        EXPECT_NEAR(surface.largestPart, voxel.x == voxel.y ? 0.5 : 1.0, 1e-12);
    });
}

TEST(AttributeReference, ModelMatricesTurnNormalsAndScaleAreas) {
    TriangleMesh mesh = makePlane({0, 0, 0}, {1, 0, 1}, 0.5f);
    glm::dmat4 model(1.0);
    model[0][0] = 4.0;
    model[3] = glm::dvec4(2, 2, 2, 1);
    const BitGrid bits = overlap(mesh, unitGrid({4, 4, 4}), {.model = model}).value();
    double area = 0.0;
    for (const VoxelSurface& surface : surfaces(mesh, bits, {.model = model})) {
        area += surface.area;
        if (surface.area > 0.0) {
            const glm::dvec3 normal = glm::normalize(surface.normal);
            EXPECT_NEAR(glm::dot(normal, glm::normalize(glm::dvec3(0.25, 0, 1))), 1.0, 1e-6);
        }
    }
    EXPECT_NEAR(area, 0.5 * 0.5 * std::sqrt(16.0 + 1.0) / std::sqrt(2.0), 1e-6);
}

} // namespace
} // namespace lamina::reference
