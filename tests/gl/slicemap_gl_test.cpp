// The slicemap backend against the double-precision references.

#include "gl/support/gl_test.hpp"
#include "gl/support/grids.hpp"
#include "gl/support/test_meshes.hpp"
#include "gl/support/voxelize.hpp"

#include <lamina/voxelize/voxelizer.hpp>

#include <reference/column_triangle.hpp>
#include <reference/filled.hpp>
#include <reference/sampled.hpp>
#include <reference/shapes.hpp>

#include <cmath>

namespace lamina {
namespace {

namespace ref = reference;
using test::makeShapes;
using test::NamedMesh;

class SlicemapGlTest : public test::GlTest {
protected:
    BitGrid voxelize(Coverage coverage, const TriangleMesh& mesh, const GridTransform& transform) {
        return test::voxelize(device(), {Backend::Slicemap, coverage}, mesh, transform);
    }
};

/// Why device and reference may disagree on a voxel: within `tolerance` columns of the column's
/// centre runs an edge of a triangle, or within `tolerance` slices of a slice boundary lies its
/// depth.
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
        if (!ref::owns(triangle, center))
            continue;
        const double slice = transform.sliceCoordinate(ref::depthAt(triangle, center));
        if (std::abs(slice - std::round(slice)) <= tolerance &&
            std::abs(slice - (voxel.z + 0.5)) <= 0.5 + tolerance)
            return true;
    }
    return false;
}

/// Every difference is double rounding; at most one voxel in a thousand differs.
void expectSampled(const BitGrid& device, const TriangleMesh& mesh, const GridTransform& transform,
                   const std::string& name) {
    constexpr double kRounding = 1e-9;
    const BitGrid expected = ref::sampled(mesh, transform).value();
    const BitGridComparison comparison = compare(device, expected).value();
    const std::uint64_t differing = comparison.onlyFirst + comparison.onlySecond;
    EXPECT_LE(differing * 1000, expected.count()) << name;
    EXPECT_GT(expected.count(), 0u) << name;
    if (differing == 0)
        return;
    const auto triangles = ref::columnTriangles(mesh, transform, glm::dmat4(1.0));
    const auto expectRounding = [&](const BitGrid& set, const BitGrid& clear) {
        set.forEachSet([&](const glm::uvec3& voxel) {
            if (!clear.test(voxel)) {
                EXPECT_TRUE(isRounding(triangles, transform, voxel, kRounding))
                    << name << ": voxel " << voxel.x << ", " << voxel.y << ", " << voxel.z;
            }
        });
    };
    expectRounding(device, expected);
    expectRounding(expected, device);
}

/// Nothing missing, nothing that a voxel grown by 1e-4 would not touch.
void expectFilled(const BitGrid& device, const TriangleMesh& mesh, const GridTransform& transform,
                  const std::string& name) {
    // Shrunk by what double rounding may decide either way.
    const BitGrid must = ref::filled(mesh, transform, {.grow = -1e-9}).value();
    const BitGrid may = ref::filled(mesh, transform, {.grow = 1e-4}).value();
    EXPECT_EQ(compare(must, device)->onlyFirst, 0u) << name << ": missing voxels";
    EXPECT_EQ(compare(device, may)->onlyFirst, 0u) << name << ": superfluous voxels";
    EXPECT_GT(must.count(), 0u) << name;
}

TEST_F(SlicemapGlTest, SampledIsExactOnVerticesAtPowerOfTwoFractions) {
    for (const NamedMesh& shape : makeShapes())
        for (const Axis axis : {Axis::X, Axis::Y, Axis::Z}) {
            const GridTransform transform =
                ref::makeDyadicGrid({{-1, -1, -1}, {1, 1, 1}}, {64, 48, 57}, axis);
            const TriangleMesh mesh = ref::snapped(shape.mesh, transform);
            const BitGrid expected = ref::sampled(mesh, transform).value();
            const BitGrid found = voxelize(Coverage::Sampled, mesh, transform);
            EXPECT_TRUE(compare(found, expected)->equal())
                << shape.name << " along axis " << static_cast<int>(axis);
            // Snapped, the steep plane stands edge-on in places.
            if (shape.name != "steep plane") {
                EXPECT_GT(expected.count(), 0u) << shape.name;
            }
        }
}

TEST_F(SlicemapGlTest, SampledAgreesWithTheReferenceOnAllShapes) {
    const GridTransform transform = test::shapesGrid({101, 83, 128});
    for (const NamedMesh& shape : makeShapes())
        expectSampled(voxelize(Coverage::Sampled, shape.mesh, transform), shape.mesh, transform,
                      shape.name);
}

TEST_F(SlicemapGlTest, FilledAgreesWithTheReferenceOnAllShapes) {
    const GridTransform transform = test::shapesGrid({101, 83, 128});
    for (const NamedMesh& shape : makeShapes()) {
        const BitGrid filled = voxelize(Coverage::Filled, shape.mesh, transform);
        expectFilled(filled, shape.mesh, transform, shape.name);
        const BitGrid sampled = voxelize(Coverage::Sampled, shape.mesh, transform);
        EXPECT_EQ(compare(sampled, filled)->onlyFirst, 0u)
            << shape.name << ": filled misses sampled";
    }
}

TEST_F(SlicemapGlTest, RealMeshesAgreeWithTheReference) {
    for (const NamedMesh& real : test::readRealMeshes({"bunny.ply", "armadillo.ply"})) {
        const GridTransform transform =
            GridTransform::box(real.mesh.bounds(), {256, 256, 128}).value();
        const BitGrid sampled = voxelize(Coverage::Sampled, real.mesh, transform);
        const BitGrid filled = voxelize(Coverage::Filled, real.mesh, transform);
        expectSampled(sampled, real.mesh, transform, real.name);
        expectFilled(filled, real.mesh, transform, real.name);
        EXPECT_EQ(compare(sampled, filled)->onlyFirst, 0u) << real.name;
    }
}

TEST_F(SlicemapGlTest, CameraGridsAndSliceDistributionsAgreeWithTheReference) {
    for (const GridTransform& transform : test::makeCameraGrids({90, 71, 100}))
        for (const NamedMesh& shape : makeShapes()) {
            const std::string name =
                shape.name + ", " + transform.describe() + ", distribution " +
                std::to_string(static_cast<int>(transform.distribution().kind()));
            expectSampled(voxelize(Coverage::Sampled, shape.mesh, transform), shape.mesh, transform,
                          name);
            expectFilled(voxelize(Coverage::Filled, shape.mesh, transform), shape.mesh, transform,
                         name);
        }
}

TEST_F(SlicemapGlTest, TrianglesAroundTheEyeAgreeWithTheReference) {
    const GridTransform transform = test::eyeGrid({80, 80, 96});
    for (const NamedMesh& shape : makeShapes()) {
        const BitGrid may = ref::filled(shape.mesh, transform, {.grow = 1e-4}).value();
        if (may.count() == 0)
            continue;
        expectSampled(voxelize(Coverage::Sampled, shape.mesh, transform), shape.mesh, transform,
                      shape.name);
        expectFilled(voxelize(Coverage::Filled, shape.mesh, transform), shape.mesh, transform,
                     shape.name);
    }
}

TEST_F(SlicemapGlTest, SliceCountsAroundWordAndGroupEdges) {
    const TriangleMesh mesh = ref::makeIcosphere({0, 0, 0}, 0.97f, 3);
    for (const std::uint32_t slices :
         {1u, 2u, 31u, 32u, 33u, 127u, 128u, 129u, 256u, 300u, 1024u}) {
        const GridTransform transform =
            GridTransform::box({{-1, -1, -1}, {1, 1, 1}}, {40, 24, slices}).value();
        const std::string name = std::to_string(slices) + " slices";
        expectSampled(voxelize(Coverage::Sampled, mesh, transform), mesh, transform, name);
        expectFilled(voxelize(Coverage::Filled, mesh, transform), mesh, transform, name);
    }
}

TEST_F(SlicemapGlTest, GridSizesFromOneColumnToWide) {
    const TriangleMesh mesh = ref::makeTorus({0.69f, 0.03f, 0}, 0.7f, 0.25f, 40, 20);
    for (const glm::uvec2 columns :
         {glm::uvec2{1, 1}, {1, 65}, {63, 2}, {513, 3}, {2049, 5}, {5, 4097}}) {
        const GridTransform transform =
            GridTransform::box({{-1, -1, -0.3}, {1, 1, 0.3}}, {columns.x, columns.y, 64}).value();
        expectFilled(voxelize(Coverage::Filled, mesh, transform), mesh, transform,
                     transform.describe());
    }
}

TEST_F(SlicemapGlTest, TrianglesThatReachFarBeyondTheGridLoseNoColumn) {
    const GridTransform transform =
        GridTransform::box({{0, 0, 0}, {1, 1, 1}}, {64, 64, 64}).value();
    for (const float reach : {1e2f, 1e4f, 1e6f}) {
        // An edge runs through the grid, corners stand up to 64 million columns away.
        TriangleMesh mesh;
        mesh.positions = {{-reach, -0.37f * reach, 0.1f},
                          {reach, 0.37f * reach + 0.5f, 0.7f},
                          {0.3f, reach, 0.4f}};
        mesh.triangles = {{0, 1, 2}};
        const std::string name = "reach " + std::to_string(reach);
        expectSampled(voxelize(Coverage::Sampled, mesh, transform), mesh, transform, name);
    }
}

TEST_F(SlicemapGlTest, FacesOnVoxelBoundariesSetOneLayer) {
    // The box fills the grid exactly; every face lies on a boundary.
    const TriangleMesh mesh = ref::makeBox({0.1f, 0.2f, 0.3f}, {0.9f, 1.0f, 1.1f});
    const GridTransform transform = GridTransform::box(mesh.bounds(), {10, 10, 10}).value();
    for (const Coverage coverage : {Coverage::Sampled, Coverage::Filled}) {
        const BitGrid found = voxelize(coverage, mesh, transform);
        EXPECT_EQ(found.count(), 200u) << name(coverage);
        for (std::uint32_t y = 0; y < 10; ++y)
            for (std::uint32_t x = 0; x < 10; ++x) {
                EXPECT_TRUE(found.test({x, y, 0}));
                EXPECT_TRUE(found.test({x, y, 9}));
            }
    }
}

TEST_F(SlicemapGlTest, AMillionTrianglesInAThousandSlices) {
    const TriangleMesh mesh = ref::makeTorusKnot({0, 0, 0}, 0.6f, 0.15f, 3, 5, 8192, 64);
    ASSERT_GE(mesh.triangles.size(), 1000000u);
    const GridTransform transform =
        GridTransform::box({{-1.1, -1.1, -1.1}, {1.1, 1.1, 1.1}}, {1024, 1024, 1024}).value();
    expectSampled(voxelize(Coverage::Sampled, mesh, transform), mesh, transform, "torus knot");
}

} // namespace
} // namespace lamina
