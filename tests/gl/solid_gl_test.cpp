// Coverage::Solid against ray parity in double precision.

#include "gl/support/gl_test.hpp"
#include "gl/support/grids.hpp"
#include "gl/support/solid.hpp"
#include "gl/support/test_meshes.hpp"
#include "gl/support/voxelize.hpp"

#include <reference/crossings.hpp>
#include <reference/mesh_measures.hpp>
#include <reference/shapes.hpp>

#include <gmock/gmock.h>

namespace lamina {
namespace {

namespace ref = reference;
using test::NamedMesh;
using test::Solid;
using testing::HasSubstr;

const Box3 kUnitBox{{-1, -1, -1}, {1, 1, 1}};

class SolidGlTest : public test::GlTest {
protected:
    Solid voxelize(const TriangleMesh& mesh, const GridTransform& transform) {
        return test::voxelizeSolid(device(), mesh, transform);
    }
};

TEST_F(SolidGlTest, ClosedShapesEqualRayParityAndHaveNoOddColumns) {
    for (const NamedMesh& shape : test::makeShapes()) {
        if (!ref::isWatertight(shape.mesh))
            continue;
        for (const glm::uvec3 size : {glm::uvec3{101, 83, 128}, {300, 280, 290}}) {
            const GridTransform transform = test::shapesGrid(size);
            const Solid solid = voxelize(shape.mesh, transform);
            test::expectInside(solid.bits, shape.mesh, transform, shape.name);
            EXPECT_EQ(solid.report.oddColumns, 0u) << shape.name;
        }
    }
}

TEST_F(SolidGlTest, OrientationAndOverlapFollowParity) {
    const GridTransform transform = GridTransform::box(kUnitBox, {64, 60, 130}).value();
    const TriangleMesh ball = ref::makeIcosphere({0.1f, 0, 0}, 0.7f, 4);
    const BitGrid outward = voxelize(ball, transform).bits;
    EXPECT_TRUE(compare(voxelize(ref::flipped(ball), transform).bits, outward)->equal());
    const TriangleMesh both = ref::merged(ball, ref::makeCube({-0.2f, 0.1f, 0.1f}, 0.9f));
    test::expectInside(voxelize(both, transform).bits, both, transform, "overlapping");
}

TEST_F(SolidGlTest, ABallHasItsVolume) {
    // An oracle that shares nothing with parity.
    const TriangleMesh ball = ref::makeIcosphere({0.013f, -0.021f, 0.034f}, 0.8f, 6);
    const GridTransform transform = GridTransform::box(kUnitBox, glm::uvec3(200)).value();
    const double voxel = 0.01 * 0.01 * 0.01;
    EXPECT_NEAR(static_cast<double>(voxelize(ball, transform).bits.count()) * voxel,
                ref::signedVolume(ball), 2e-4);
}

TEST_F(SolidGlTest, CutOffSolidsKeepTheirInside) {
    // Crossings before, beyond and beside the grid.
    const TriangleMesh knot = ref::makeTorusKnot({0, 0, 0}, 0.55f, 0.3f, 2, 3, 256, 24);
    for (const Axis axis : {Axis::X, Axis::Y, Axis::Z}) {
        const GridTransform transform =
            GridTransform::box({{-0.5, -0.4, -0.1}, {0.45, 0.6, 0.15}}, {77, 66, 55}, axis).value();
        const Solid solid = voxelize(knot, transform);
        test::expectInside(solid.bits, knot, transform, "knot");
        EXPECT_EQ(solid.report.oddColumns, 0u);
    }
}

TEST_F(SolidGlTest, FacesThroughVoxelCentresAreConsistent) {
    // Vertices and edges on column centres, faces on voxel centres: ties everywhere.
    const TriangleMesh box = ref::makeBox({1.5f, 2.5f, 3.5f}, {6.5f, 5.5f, 7.5f});
    const GridTransform transform =
        GridTransform::box({glm::dvec3(0), glm::dvec3(8)}, glm::uvec3(8)).value();
    const Solid solid = voxelize(box, transform);
    EXPECT_EQ(solid.bits.count(), 5u * 3u * 4u);
    EXPECT_TRUE(compare(solid.bits, ref::inside(box, transform).value())->equal());
    EXPECT_EQ(solid.report.oddColumns, 0u);
}

TEST_F(SolidGlTest, OpenMeshesReportOddColumns) {
    // A box without its top, seen along z: every column it covers is odd.
    TriangleMesh open = ref::makeBox({2.25f, 2.25f, 2.25f}, {6.25f, 5.25f, 6.25f});
    std::erase_if(open.triangles, [&](const glm::uvec3& t) {
        return open.positions[t.x].z > 6.0f && open.positions[t.y].z > 6.0f &&
               open.positions[t.z].z > 6.0f;
    });
    ASSERT_EQ(open.triangles.size(), 10u);
    const Box3 box{glm::dvec3(0), glm::dvec3(8)};
    EXPECT_EQ(voxelize(open, GridTransform::box(box, glm::uvec3(8)).value()).report.oddColumns,
              12u);
    EXPECT_EQ(
        voxelize(open, GridTransform::box(box, glm::uvec3(8), Axis::X).value()).report.oddColumns,
        0u);
    // The bottom lies before the grid: still odd.
    const Box3 upper{{0, 0, 4}, {8, 8, 8}};
    EXPECT_EQ(voxelize(open, GridTransform::box(upper, glm::uvec3(8)).value()).report.oddColumns,
              12u);
}

TEST_F(SolidGlTest, RealMeshesEqualRayParity) {
    for (const NamedMesh& mesh : test::readRealMeshes({"armadillo.ply", "dragon.ply"}))
        for (const std::uint32_t size : {256u, 512u}) {
            const GridTransform transform =
                GridTransform::box(mesh.mesh.bounds(), glm::uvec3(size)).value();
            const Solid solid = voxelize(mesh.mesh, transform);
            test::expectInside(solid.bits, mesh.mesh, transform,
                               mesh.name + " " + std::to_string(size));
            if (ref::isWatertight(mesh.mesh)) {
                EXPECT_EQ(solid.report.oddColumns, 0u) << mesh.name;
            }
        }
}

TEST_F(SolidGlTest, ReportsNeedASolid) {
    auto solid = Voxelizer::create(device(), {.coverage = Coverage::Solid}).value();
    EXPECT_THAT(solid->downloadSolidReport().error().text, HasSubstr("voxelize first"));
    auto thin = Voxelizer::create(device(), {.coverage = Coverage::Conservative}).value();
    EXPECT_THAT(thin->downloadSolidReport().error().text, HasSubstr("Coverage::Solid"));
    auto grid = VoxelGrid::create(device()).value();
    ASSERT_TRUE(solid->voxelize({}, GridTransform::box(kUnitBox, {8, 8, 8}).value(), grid));
    EXPECT_EQ(solid->downloadSolidReport()->oddColumns, 0u);
    EXPECT_EQ(grid.download()->count(), 0u);
}

} // namespace
} // namespace lamina
