// Backend::Volume: the bits of a volume's counts.

#include "gl/support/gl_state.hpp"
#include "gl/support/gl_test.hpp"
#include "gl/support/test_meshes.hpp"
#include "gl/support/voxelize.hpp"

#include <reference/sampled.hpp>
#include <reference/shapes.hpp>

#include <glm/gtc/matrix_transform.hpp>

#include <gmock/gmock.h>

namespace lamina {
namespace {

namespace ref = reference;
using test::NamedMesh;
using testing::HasSubstr;

constexpr VoxelizerDesc kVolume{Backend::Volume, Coverage::Sampled};
constexpr VoxelizerDesc kSlicemap{Backend::Slicemap, Coverage::Sampled};

class VolumeBitsGlTest : public test::GlTest {};

TEST_F(VolumeBitsGlTest, ShapesEqualTheReference) {
    // Exact: coordinates are power-of-two fractions of a voxel.
    for (const NamedMesh& shape : test::makeShapes()) {
        const GridTransform transform =
            ref::makeDyadicGrid({{-1, -1, -1}, {1, 1, 1}}, {64, 48, 157});
        const TriangleMesh mesh = ref::snapped(shape.mesh, transform);
        const BitGrid found = test::voxelize(device(), kVolume, mesh, transform);
        EXPECT_TRUE(compare(found, ref::sampled(mesh, transform).value())->equal()) << shape.name;
    }
}

TEST_F(VolumeBitsGlTest, EveryGridGivesWhatTheSlicemapGives) {
    const TriangleMesh knot = ref::makeTorusKnot({0, 0, 0}, 0.5f, 0.2f, 2, 3, 64, 12);
    const glm::dmat4 view = glm::lookAt(glm::dvec3(1.1, 1.7, 2.3), glm::dvec3(0.1, 0.0, -0.1),
                                        glm::dvec3(0.1, 1.0, 0.0));
    const GridCamera camera = GridCamera::perspective(view, 0.9, 1.5, 1.2, 4.9);
    const Box3 box{{-1, -1, -1}, {1, 1, 1}};
    for (const GridTransform& transform :
         {GridTransform::box(box, {33, 17, 128}, Axis::X).value(),
          GridTransform::box(box, {1, 1, 1}).value(),
          GridTransform::box(box, {65, 40, 129}, Axis::Y).value(),
          GridTransform::box(box, {65, 40, 4}, Axis::Z,
                             SliceDistribution::custom({0.0f, 0.1f, 0.15f, 0.7f, 1.0f}))
              .value(),
          GridTransform::camera(camera, {90, 60, 300}).value(),
          GridTransform::camera(camera, {90, 60, 200}, SliceDistribution::logarithmic()).value()})
        EXPECT_TRUE(compare(test::voxelize(device(), kVolume, knot, transform),
                            test::voxelize(device(), kSlicemap, knot, transform))
                        ->equal())
            << transform.describe();
}

TEST_F(VolumeBitsGlTest, MoreThanAByteOfHitsAndAnyMaterialStaySet) {
    auto plane = MeshBuffers::upload(device(), ref::makePlane({0, 0, 0.1f}, {0, 0, 1}, 1)).value();
    MeshView view = plane.view();
    view.materialId = 100000;
    const std::vector<GeometrySource> sources(300, view);
    const GridTransform transform =
        GridTransform::box({{-1, -1, -1}, {1, 1, 1}}, {8, 8, 8}).value();
    EXPECT_TRUE(compare(test::voxelize(device(), kVolume, sources, transform),
                        test::voxelize(device(), kSlicemap, sources, transform))
                    ->equal());
}

TEST_F(VolumeBitsGlTest, SaysWhatItIsAndRefusesOtherCoverage) {
    const auto voxelizer = Voxelizer::create(device(), kVolume).value();
    EXPECT_EQ(voxelizer->backend(), Backend::Volume);
    EXPECT_EQ(voxelizer->reason(), "volume was asked for");
    const VoxelizerCapabilities able = voxelizer->capabilities();
    EXPECT_TRUE(able.perspective && able.anyDistribution && able.drawSources);
    EXPECT_GE(able.maxSlices, 2048u);
    EXPECT_EQ(able.store, VoxelStore::Texture);
    const auto refused = Voxelizer::create(device(), {Backend::Volume, Coverage::Conservative});
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().code, ErrorCode::Unsupported);
    EXPECT_THAT(refused.error().text, HasSubstr("coverage sampled, the nearest that volume"));
    // A grid beyond the limits, with the grid left as it was.
    auto grid = VoxelGrid::create(device()).value();
    const auto failed = voxelizer->voxelize(
        {}, GridTransform::box({{0, 0, 0}, {1, 1, 1}}, {2, 2, 1u << 20u}).value(), grid);
    ASSERT_FALSE(failed);
    EXPECT_EQ(failed.error().code, ErrorCode::DeviceLimit);
    EXPECT_EQ(grid.transform(), nullptr);
}

TEST_F(VolumeBitsGlTest, RestoresTheState) {
    const TriangleMesh box = ref::makeBox({0.25f, 0.25f, 0.25f}, {0.75f, 0.75f, 0.75f});
    const GridTransform transform =
        GridTransform::box({{0, 0, 0}, {1, 1, 1}}, {16, 8, 200}).value();
    const BitGrid right = test::voxelize(device(), kVolume, box, transform);
    const test::OddGlState odd(gl());
    auto buffers = MeshBuffers::upload(device(), box).value();
    const GeometrySource source = buffers.view();
    const auto before = test::readGlState(gl());
    auto voxelizer = Voxelizer::create(device(), kVolume).value();
    auto grid = VoxelGrid::create(device()).value();
    ASSERT_TRUE(voxelizer->voxelize({&source, 1}, transform, grid));
    EXPECT_THAT(test::differences(before, test::readGlState(gl())), testing::IsEmpty());
    EXPECT_TRUE(compare(grid.download().value(), right)->equal());
    EXPECT_GT(right.count(), 0u);
}

} // namespace
} // namespace lamina
