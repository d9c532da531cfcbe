// Which backend Voxelizer takes for what is asked, and what it says of it.

#include "gl/support/gl_test.hpp"
#include "gl/support/grids.hpp"
#include "gl/support/sources.hpp"

#include <lamina/voxelize/voxelizer.hpp>

#include <glm/gtc/matrix_transform.hpp>

#include <gmock/gmock.h>

namespace lamina {
namespace {

using test::testGrid;
using testing::AllOf;
using testing::HasSubstr;

class VoxelizerChoiceGlTest : public test::GlTest {};

TEST_F(VoxelizerChoiceGlTest, AutomaticPicksByCoverageAndSaysWhy) {
    const std::pair<Coverage, Backend> expected[] = {
        {Coverage::Sampled, Backend::MrtSlicemap},  {Coverage::Filled, Backend::MrtSlicemap},
        {Coverage::Conservative, Backend::Overlap}, {Coverage::Separating6, Backend::Overlap},
        {Coverage::Solid, Backend::Overlap},
    };
    for (const auto& [coverage, backend] : expected) {
        auto voxelizer = Voxelizer::create(device(), {.coverage = coverage}).value();
        EXPECT_EQ(voxelizer->backend(), backend);
        EXPECT_THAT(voxelizer->reason(),
                    AllOf(HasSubstr(std::string(name(backend))),
                          HasSubstr(std::string(name(coverage))), HasSubstr(": it ")));
        const auto asked = Voxelizer::create(device(), {backend, coverage}).value();
        EXPECT_THAT(asked->reason(), HasSubstr("was asked for"));
    }
}

TEST_F(VoxelizerChoiceGlTest, BackendsThatDoNotServeACoverageAreRefused) {
    const std::pair<Coverage, Backend> refusals[] = {{Coverage::Sampled, Backend::Overlap},
                                                     {Coverage::Filled, Backend::Overlap},
                                                     {Coverage::Separating6, Backend::Slicemap}};
    for (const auto& [coverage, backend] : refusals) {
        const Backend able = backend == Backend::Slicemap ? Backend::Overlap : Backend::MrtSlicemap;
        const auto refused = Voxelizer::create(device(), {backend, coverage});
        ASSERT_FALSE(refused);
        EXPECT_EQ(refused.error().code, ErrorCode::Unsupported);
        EXPECT_THAT(refused.error().text,
                    AllOf(HasSubstr("serves " + std::string(name(coverage)) + " coverage, found " +
                                    std::string(name(backend))),
                          HasSubstr("Backend::Automatic or " + std::string(name(able))),
                          HasSubstr("coverage conservative")));
    }
    for (const Coverage coverage : {Coverage::Conservative, Coverage::Solid})
        for (const Backend backend : {Backend::Slicemap, Backend::Overlap})
            EXPECT_EQ(Voxelizer::create(device(), {backend, coverage}).value()->backend(), backend);
}

TEST_F(VoxelizerChoiceGlTest, AutomaticPicksByTheGridWhereTwoBackendsServe) {
    auto buffers = MeshBuffers::upload(device(), test::makeKnot()).value();
    const GeometrySource source = buffers.view();
    auto grid = VoxelGrid::create(device()).value();
    const Box3 box{{-1, -1, -1}, {1, 1, 1}};
    const GridTransform linear = GridTransform::box(box, {32, 32, 32}).value();
    const GridTransform custom =
        GridTransform::box(box, {32, 32, 2}, Axis::Z, SliceDistribution::custom({0, 0.25f, 1}))
            .value();
    GridCamera eye = GridCamera::perspective(glm::dmat4(1), 1, 1, 1, 4);
    eye.worldToEye = glm::translate(glm::dmat4(1), {0, 0, -2.5});
    const GridTransform perspective = GridTransform::camera(eye, {32, 32, 32}).value();
    for (const Coverage coverage : {Coverage::Conservative, Coverage::Solid}) {
        auto voxelizer = Voxelizer::create(device(), {.coverage = coverage}).value();
        EXPECT_TRUE(voxelizer->capabilities().perspective);
        EXPECT_TRUE(voxelizer->capabilities().anyDistribution);
        for (const auto& [transform, backend] : {std::pair{&linear, Backend::Overlap},
                                                 {&custom, Backend::MrtSlicemap},
                                                 {&linear, Backend::Overlap},
                                                 {&perspective, Backend::MrtSlicemap}}) {
            ASSERT_TRUE(voxelizer->voxelize({&source, 1}, *transform, grid));
            EXPECT_EQ(voxelizer->backend(), backend);
            EXPECT_EQ(voxelizer->capabilities().store, grid.store());
            EXPECT_THAT(voxelizer->reason(), HasSubstr(std::string(name(backend)) + " serves"));
            auto one = Voxelizer::create(device(), {.backend = backend,
                                                    .coverage = coverage,
                                                    .store = voxelizer->capabilities().store})
                           .value();
            auto expected = VoxelGrid::create(device()).value();
            ASSERT_TRUE(one->voxelize({&source, 1}, *transform, expected));
            EXPECT_GT(grid.download()->count(), 0u);
            EXPECT_TRUE(compare(grid.download().value(), expected.download().value())->equal());
            if (coverage == Coverage::Solid) {
                EXPECT_EQ(voxelizer->downloadSolidReport()->oddColumns, 0u);
            }
        }
        // A call that fails leaves the choice as it is.
        const GeometrySource broken = MeshView{};
        EXPECT_FALSE(voxelizer->voxelize({&broken, 1}, linear, grid));
        EXPECT_EQ(voxelizer->backend(), Backend::MrtSlicemap);
    }
}

TEST_F(VoxelizerChoiceGlTest, AutomaticSaysWhatServesRangesRulesAndManySlices) {
    auto ranges =
        Voxelizer::create(device(), {.coverage = Coverage::Conservative, .localRanges = true})
            .value();
    EXPECT_EQ(ranges->backend(), Backend::MrtSlicemap);
    EXPECT_THAT(ranges->reason(),
                HasSubstr("mrt_slicemap serves conservative coverage with local ranges: it "));
    auto sampled = Voxelizer::create(device()).value();
    EXPECT_THAT(sampled->reason(), HasSubstr("up to 1024 slices a pass"));

    // No backend has these: the error names the nearest request that can be served, and it is.
    auto buffers = MeshBuffers::upload(device(), test::makeKnot()).value();
    const GeometrySource source = buffers.view();
    auto grid = VoxelGrid::create(device()).value();
    const Box3 box{{-1, -1, -1}, {1, 1, 1}};
    GridCamera eye = GridCamera::perspective(glm::dmat4(1), 1, 1, 1, 4);
    eye.worldToEye = glm::translate(glm::dmat4(1), {0, 0, -2.5});
    const GridTransform others[] = {
        GridTransform::camera(eye, {32, 32, 32}).value(),
        GridTransform::box(box, {32, 32, 2}, Axis::Z, SliceDistribution::custom({0, 0.25f, 1}))
            .value()};
    for (const GridTransform& transform : others) {
        for (const VoxelizerDesc& desc :
             {VoxelizerDesc{.coverage = Coverage::Separating6},
              VoxelizerDesc{.coverage = Coverage::Solid, .solidRule = SolidRule::Voted},
              VoxelizerDesc{.coverage = Coverage::Solid, .solidRule = SolidRule::FloodFill}}) {
            auto voxelizer = Voxelizer::create(device(), desc).value();
            const auto refused = voxelizer->voxelize({&source, 1}, transform, grid);
            ASSERT_FALSE(refused);
            EXPECT_EQ(refused.error().code, ErrorCode::Unsupported);
            EXPECT_THAT(refused.error().text,
                        AllOf(HasSubstr("orthographic grid with linear slices"),
                              HasSubstr("Coverage::Conservative"),
                              HasSubstr("Coverage::Solid and SolidRule::Parity")));
        }
        for (const Coverage nearest : {Coverage::Conservative, Coverage::Solid}) {
            auto voxelizer = Voxelizer::create(device(), {Backend::Slicemap, nearest}).value();
            EXPECT_TRUE(voxelizer->voxelize({&source, 1}, transform, grid));
        }
    }
}

TEST_F(VoxelizerChoiceGlTest, AutomaticSplitsBySlicemaps) {
    auto buffers = MeshBuffers::upload(device(), test::makeKnot()).value();
    const GeometrySource source = buffers.view();
    auto voxelizer = Voxelizer::create(device(), {.coverage = Coverage::Conservative}).value();
    std::vector<VoxelGrid> grids;
    for (int i = 0; i < 2; ++i)
        grids.push_back(VoxelGrid::create(device()).value());
    ASSERT_TRUE(voxelizer->voxelizeWith({&source, 1}, testGrid(), {.split = Split::Facing}, grids));
    EXPECT_EQ(voxelizer->backend(), Backend::MrtSlicemap);
    EXPECT_GT(grids[1].download()->count(), 0u);
}

TEST_F(VoxelizerChoiceGlTest, SaysWhatItIs) {
    auto voxelizer = Voxelizer::create(device()).value();
    EXPECT_EQ(voxelizer->backend(), Backend::MrtSlicemap);
    EXPECT_THAT(voxelizer->reason(), HasSubstr("mrt_slicemap"));
    const VoxelizerCapabilities able = voxelizer->capabilities();
    EXPECT_TRUE(able.perspective && able.drawSources);
    EXPECT_EQ(able.slicesPerPass, 1024u);
    EXPECT_EQ(able.store, VoxelStore::Texture);
    EXPECT_GE(able.maxColumns, 16384u);
    EXPECT_GE(able.maxSlices, 2048u * 128u);
}

} // namespace
} // namespace lamina
