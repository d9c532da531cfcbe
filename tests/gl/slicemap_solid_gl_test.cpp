// Coverage::Solid of the slicemap backend, by XOR, against ray parity in double precision.

#include "gl/support/gl_test.hpp"
#include "gl/support/grids.hpp"
#include "gl/support/solid.hpp"
#include "gl/support/test_meshes.hpp"
#include "gl/support/voxelize.hpp"

#include <reference/crossings.hpp>
#include <reference/mesh_measures.hpp>
#include <reference/shapes.hpp>

#include <glm/gtc/matrix_transform.hpp>

#include <gmock/gmock.h>

namespace lamina {
namespace {

namespace ref = reference;
using test::expectInside;
using test::NamedMesh;
using test::Solid;
using testing::HasSubstr;

const Box3 kUnitBox{{-1, -1, -1}, {1, 1, 1}};

class SlicemapSolidGlTest : public test::GlTest {
protected:
    Solid voxelize(const TriangleMesh& mesh, const GridTransform& transform,
                   Backend backend = Backend::Slicemap) {
        return test::voxelizeSolid(device(), mesh, transform, SolidRule::Parity, backend);
    }
};

std::uint64_t oddColumns(const TriangleMesh& mesh, const GridTransform& transform) {
    const ref::ColumnCrossings crossings(mesh, transform);
    std::uint64_t odd = 0;
    for (std::uint32_t y = 0; y < transform.size().y; ++y)
        for (std::uint32_t x = 0; x < transform.size().x; ++x)
            odd += crossings.at({x, y}).size() % 2;
    return odd;
}

TEST_F(SlicemapSolidGlTest, ClosedShapesEqualRayParityAndHaveNoOddColumns) {
    for (const NamedMesh& shape : test::makeShapes()) {
        if (!ref::isWatertight(shape.mesh))
            continue;
        for (const glm::uvec3 size : {glm::uvec3{101, 83, 128}, {300, 280, 290}}) {
            const GridTransform transform = test::shapesGrid(size);
            const Solid solid = voxelize(shape.mesh, transform);
            expectInside(solid.bits, shape.mesh, transform, shape.name);
            EXPECT_EQ(solid.report.oddColumns, 0u) << shape.name;
            EXPECT_EQ(solid.stats.passes, size.z <= 128 ? 1u : 3u);
            EXPECT_TRUE(compare(solid.bits, voxelize(shape.mesh, transform, Backend::Overlap).bits)
                            ->equal())
                << shape.name;
        }
    }
}

TEST_F(SlicemapSolidGlTest, CameraGridsAndSliceDistributionsEqualRayParity) {
    for (const GridTransform& transform : test::makeCameraGrids({90, 71, 200}))
        for (const NamedMesh& shape : test::makeShapes()) {
            if (!ref::isWatertight(shape.mesh))
                continue;
            const Solid solid = voxelize(shape.mesh, transform);
            expectInside(solid.bits, shape.mesh, transform,
                         shape.name + ", " + transform.describe() + ", distribution " +
                             std::to_string(static_cast<int>(transform.distribution().kind())));
            EXPECT_EQ(solid.report.oddColumns, 0u) << shape.name;
        }
}

TEST_F(SlicemapSolidGlTest, AMeshAroundTheEyeIsFilledUpToItsSurface) {
    const GridTransform transform = test::eyeGrid({80, 80, 150});
    const TriangleMesh ball = ref::makeIcosphere({0, 0, 0}, 0.95f, 4);
    const Solid solid = voxelize(ball, transform);
    expectInside(solid.bits, ball, transform, "around the eye");
    // Every centre line leaves it once.
    EXPECT_EQ(solid.report.oddColumns, 6400u);
    for (const NamedMesh& shape : test::makeShapes())
        if (ref::isWatertight(shape.mesh)) {
            const Solid other = voxelize(shape.mesh, transform);
            expectInside(other.bits, shape.mesh, transform, shape.name);
            EXPECT_EQ(other.report.oddColumns, oddColumns(shape.mesh, transform)) << shape.name;
        }
}

TEST_F(SlicemapSolidGlTest, CutOffSolidsKeepTheirInside) {
    // Crossings before, beyond and beside the grid.
    const TriangleMesh knot = ref::makeTorusKnot({0, 0, 0}, 0.55f, 0.3f, 2, 3, 256, 24);
    for (const Axis axis : {Axis::X, Axis::Y, Axis::Z}) {
        const GridTransform transform =
            GridTransform::box({{-0.5, -0.4, -0.1}, {0.45, 0.6, 0.15}}, {77, 66, 255}, axis)
                .value();
        const Solid solid = voxelize(knot, transform);
        expectInside(solid.bits, knot, transform, "knot");
        EXPECT_EQ(solid.report.oddColumns, 0u);
    }
}

TEST_F(SlicemapSolidGlTest, SliceCountsAroundWordAndPassEdges) {
    const TriangleMesh ball = ref::makeIcosphere({0.01f, 0.02f, 0.03f}, 0.9f, 3);
    for (const std::uint32_t slices :
         {1u, 2u, 31u, 32u, 33u, 127u, 128u, 129u, 256u, 300u, 1024u}) {
        const GridTransform transform = GridTransform::box(kUnitBox, {40, 24, slices}).value();
        expectInside(voxelize(ball, transform).bits, ball, transform, transform.describe());
    }
}

TEST_F(SlicemapSolidGlTest, FacesThroughVoxelCentresAreConsistent) {
    // Vertices and edges on column centres, faces on voxel centres: ties everywhere.
    const TriangleMesh box = ref::makeBox({1.5f, 2.5f, 3.5f}, {6.5f, 5.5f, 7.5f});
    const GridTransform transform =
        GridTransform::box({glm::dvec3(0), glm::dvec3(8)}, glm::uvec3(8)).value();
    const Solid solid = voxelize(box, transform);
    EXPECT_EQ(solid.bits.count(), 5u * 3u * 4u);
    EXPECT_TRUE(compare(solid.bits, ref::inside(box, transform).value())->equal());
    EXPECT_EQ(solid.report.oddColumns, 0u);
}

TEST_F(SlicemapSolidGlTest, NeedlesThatReachFarBeyondTheGridStayClosed) {
    // Every fragment counts once, also where the rasterizer clips.
    const GridTransform transform = GridTransform::box(kUnitBox, {128, 120, 140}).value();
    for (const float reach : {1.0f, 3.0f, 1e2f, 1e4f, 1e6f})
        for (const float width : {0.3f, 0.02f, 1e-3f}) {
            const glm::vec3 along(0.8f, 0.55f, 0.1f);
            const TriangleMesh needle =
                ref::makeTetrahedron(-reach * along, reach * along, glm::vec3(-width, width, 0.0f),
                                     glm::vec3(0, 0, 0.7f));
            const Solid solid = voxelize(needle, transform);
            const std::string name =
                "reach " + std::to_string(reach) + ", width " + std::to_string(width);
            EXPECT_EQ(solid.report.oddColumns, 0u) << name;
            // Farther away, the rounding of the corners moves the needle's faces.
            if (reach <= 1e4f)
                expectInside(solid.bits, needle, transform, name);
        }
}

TEST_F(SlicemapSolidGlTest, OpenMeshesReportOddColumnsLikeTheOverlapBackend) {
    // A box without its top, seen along z: every column it covers is odd.
    TriangleMesh open = ref::makeBox({2.25f, 2.25f, 2.25f}, {6.25f, 5.25f, 6.25f});
    std::erase_if(open.triangles, [&](const glm::uvec3& t) {
        return open.positions[t.x].z > 6.0f && open.positions[t.y].z > 6.0f &&
               open.positions[t.z].z > 6.0f;
    });
    const Box3 box{glm::dvec3(0), glm::dvec3(8)};
    // The bottom lies inside the grid, then before, then beyond it.
    for (const auto& [low, high] : {std::pair{0.0, 8.0}, {4.0, 8.0}, {0.0, 2.0}}) {
        const GridTransform transform =
            GridTransform::box({{0, 0, low}, {8, 8, high}}, glm::uvec3(8)).value();
        const Solid solid = voxelize(open, transform);
        const Solid overlap = voxelize(open, transform, Backend::Overlap);
        EXPECT_EQ(solid.report.oddColumns, 12u) << low;
        EXPECT_EQ(overlap.report.oddColumns, 12u) << low;
        EXPECT_TRUE(compare(solid.bits, overlap.bits)->equal()) << low;
    }
    EXPECT_EQ(
        voxelize(open, GridTransform::box(box, glm::uvec3(8), Axis::X).value()).report.oddColumns,
        0u);
}

TEST_F(SlicemapSolidGlTest, ReportsOfOpenMeshesAreTheSameOnAllBackends) {
    // Triangles taken from closed shapes; a soup, which is open everywhere. Sizes around words.
    std::vector<NamedMesh> meshes = test::makeShapes();
    for (NamedMesh& shape : meshes)
        if (shape.mesh.triangles.size() > 40)
            std::erase_if(shape.mesh.triangles,
                          [n = 0](const glm::uvec3&) mutable { return ++n % 13 == 0; });
    for (const NamedMesh& mesh : test::readRealMeshes({"bunny.ply"}))
        meshes.push_back(mesh);
    std::size_t open = 0;
    for (const NamedMesh& shape : meshes)
        for (const glm::uvec3 size : {glm::uvec3{50, 33, 31}, glm::uvec3{40, 65, 150}}) {
            const GridTransform transform = GridTransform::box(shape.mesh.bounds(), size).value();
            const std::uint64_t expected = oddColumns(shape.mesh, transform);
            open += expected > 0 ? 1 : 0;
            const Solid overlap = voxelize(shape.mesh, transform, Backend::Overlap);
            for (const Backend backend :
                 {Backend::Overlap, Backend::Slicemap, Backend::MrtSlicemap, Backend::Automatic}) {
                const Solid solid = voxelize(shape.mesh, transform, backend);
                EXPECT_EQ(solid.report.oddColumns, expected)
                    << shape.name << " by " << name(backend) << " of " << size.z << " slices";
                EXPECT_TRUE(compare(solid.bits, overlap.bits)->equal())
                    << shape.name << " by " << name(backend);
            }
        }
    EXPECT_GT(open, 10u);
}

TEST_F(SlicemapSolidGlTest, ReportsBelongToTheLastCall) {
    auto voxelizer = Voxelizer::create(device(), {Backend::Slicemap, Coverage::Solid}).value();
    EXPECT_THAT(voxelizer->downloadSolidReport().error().text, HasSubstr("voxelize first"));
    auto grid = VoxelGrid::create(device()).value();
    auto plane = MeshBuffers::upload(device(), ref::makePlane({0, 0, 0}, {0, 0, 1}, 4.0f)).value();
    const GeometrySource one = plane.view();
    const GeometrySource two[] = {one, plane.view(glm::translate(glm::mat4(1.0f), {0, 0, 0.5f}))};
    const auto transform = GridTransform::box(kUnitBox, {40, 30, 8}).value();
    ASSERT_TRUE(voxelizer->voxelize({&one, 1}, transform, grid));
    EXPECT_EQ(voxelizer->downloadSolidReport()->oddColumns, 1200u);
    EXPECT_EQ(grid.download()->count(), 1200u * 4u);
    // Two sources are one mesh.
    ASSERT_TRUE(voxelizer->voxelize(two, transform, grid));
    EXPECT_EQ(voxelizer->downloadSolidReport()->oddColumns, 0u);
    EXPECT_EQ(grid.download()->count(), 1200u * 2u);
    ASSERT_TRUE(voxelizer->voxelize({}, transform, grid));
    EXPECT_EQ(voxelizer->downloadSolidReport()->oddColumns, 0u);
    EXPECT_EQ(grid.download()->count(), 0u);
    auto filled = Voxelizer::create(device(), {.coverage = Coverage::Filled}).value();
    EXPECT_THAT(filled->downloadSolidReport().error().text, HasSubstr("Coverage::Solid"));
}

TEST_F(SlicemapSolidGlTest, RealMeshesEqualRayParity) {
    for (const NamedMesh& mesh : test::readRealMeshes({"armadillo.ply", "dragon.ply"})) {
        const GridTransform transform =
            GridTransform::box(mesh.mesh.bounds(), glm::uvec3(256)).value();
        const Solid solid = voxelize(mesh.mesh, transform);
        expectInside(solid.bits, mesh.mesh, transform, mesh.name);
        EXPECT_EQ(solid.report.oddColumns, oddColumns(mesh.mesh, transform)) << mesh.name;
    }
}

} // namespace
} // namespace lamina
