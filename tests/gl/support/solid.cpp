#include "gl/support/solid.hpp"

#include <reference/column_triangle.hpp>
#include <reference/crossings.hpp>

#include <gtest/gtest.h>

#include <cmath>

namespace lamina::test {

namespace ref = reference;

namespace {

/// Does a triangle's edge pass within `tolerance` columns of the voxel's column centre, or a
/// crossing within `tolerance` slices of the voxel's centre?
bool isRounding(const std::vector<ref::ColumnTriangle>& triangles, const GridTransform& transform,
                const glm::uvec3& voxel, double tolerance) {
    const glm::dvec2 center = glm::dvec2(voxel.x, voxel.y) + 0.5;
    for (const ref::ColumnTriangle& triangle : triangles) {
        const glm::dvec2 low = triangle.min() - tolerance;
        const glm::dvec2 high = triangle.max() + tolerance;
        if (center.x < low.x || center.y < low.y || center.x > high.x || center.y > high.y)
            continue;
        if (ref::outlineDistance(triangle, center) <= tolerance)
            return true;
        const double slice = transform.sliceCoordinate(ref::depthAt(triangle, center));
        if (ref::owns(triangle, center) && std::abs(slice - (voxel.z + 0.5)) <= tolerance)
            return true;
    }
    return false;
}

} // namespace

Solid voxelizeSolid(const Device& device, const TriangleMesh& mesh, const GridTransform& transform,
                    SolidRule rule, Backend backend) {
    auto voxelizer =
        Voxelizer::create(device,
                          {.backend = backend, .coverage = Coverage::Solid, .solidRule = rule})
            .value();
    auto buffers = MeshBuffers::upload(device, mesh).value();
    auto grid = VoxelGrid::create(device).value();
    const GeometrySource source = buffers.view();
    const auto stats = voxelizer->voxelize({&source, 1}, transform, grid);
    EXPECT_TRUE(stats) << stats.error().text;
    return {grid.download().value(), voxelizer->downloadSolidReport().value(), stats.value(),
            rule == SolidRule::Voted ? voxelizer->downloadDoubtfulVoxels().value()
                                     : BitGrid::create(transform).value()};
}

void expectInside(const BitGrid& found, const TriangleMesh& mesh, const GridTransform& transform,
                  const std::string& name) {
    const BitGrid expected = ref::inside(mesh, transform).value();
    const BitGridComparison comparison = compare(found, expected).value();
    const std::uint64_t differing = comparison.onlyFirst + comparison.onlySecond;
    ASSERT_LE(differing * 100000, expected.count())
        << name << ": " << differing << " voxels differ";
    EXPECT_GT(expected.count(), 0u) << name;
    if (differing == 0)
        return;
    const auto triangles = ref::columnTriangles(mesh, transform, glm::dmat4(1.0));
    const auto expectRounding = [&](const BitGrid& set, const BitGrid& clear) {
        set.forEachSet([&](const glm::uvec3& voxel) {
            if (!clear.test(voxel)) {
                EXPECT_TRUE(isRounding(triangles, transform, voxel, 1e-9))
                    << name << ": voxel " << voxel.x << ", " << voxel.y << ", " << voxel.z;
            }
        });
    };
    expectRounding(found, expected);
    expectRounding(expected, found);
}

} // namespace lamina::test
