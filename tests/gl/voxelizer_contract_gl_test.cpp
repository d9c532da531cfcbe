// Misuse of voxelizers is named: objects of another device, values outside their enumerations,
// calls without a current context.

#include "gl/support/gl_test.hpp"

#include <lamina/voxelize/attribute_voxelizer.hpp>
#include <lamina/voxelize/epipolar_voxelizer.hpp>
#include <lamina/voxelize/volume_voxelizer.hpp>
#include <lamina/voxelize/voxelizer.hpp>

#include <reference/shapes.hpp>

#include <gmock/gmock.h>

#include <thread>

namespace lamina {
namespace {

namespace ref = reference;
using testing::AllOf;
using testing::HasSubstr;

class VoxelizerContractGlTest : public test::GlTest {
protected:
    void SetUp() override {
        GlTest::SetUp();
        mOther.emplace(Device::fromCurrentContext([](const char* name) {
                           return test::context().getProcAddress(name);
                       }).value());
        mBuffers.emplace(
            MeshBuffers::upload(device(), ref::makeIcosphere({0, 0, 0}, 0.8f, 2)).value());
        mSource = mBuffers->view();
    }
    void TearDown() override {
        mBuffers.reset();
        mOther.reset();
        GlTest::TearDown();
    }

    const Device& other() { return *mOther; }
    std::span<const GeometrySource> sources() { return {&mSource, 1}; }

    template<class Answer>
    static void expectRefused(const Answer& answer, const std::string& what) {
        ASSERT_FALSE(answer);
        EXPECT_EQ(answer.error().code, ErrorCode::InvalidArgument);
        EXPECT_THAT(answer.error().text,
                    HasSubstr("expected " + what + " of the same device, found that of another"));
    }

    GridTransform mGrid = GridTransform::box({{-1, -1, -1}, {1, 1, 1}}, {24, 24, 24}).value();

private:
    std::optional<Device> mOther;
    std::optional<MeshBuffers> mBuffers;
    GeometrySource mSource;
};

TEST_F(VoxelizerContractGlTest, GridsOfAnotherDeviceAreRefused) {
    auto foreign = VoxelGrid::create(other()).value();
    for (const VoxelizerDesc& desc : {VoxelizerDesc{Backend::Slicemap, Coverage::Filled},
                                      VoxelizerDesc{Backend::MrtSlicemap, Coverage::Solid},
                                      VoxelizerDesc{Backend::LocalSlicemap, Coverage::Filled},
                                      VoxelizerDesc{Backend::Overlap, Coverage::Conservative},
                                      VoxelizerDesc{Backend::Volume, Coverage::Sampled},
                                      VoxelizerDesc{Backend::Automatic, Coverage::Solid}}) {
        auto voxelizer = Voxelizer::create(device(), desc).value();
        expectRefused(voxelizer->voxelize(sources(), mGrid, foreign), "a grid");
        EXPECT_EQ(foreign.transform(), nullptr);
        auto own = VoxelGrid::create(device()).value();
        EXPECT_TRUE(voxelizer->voxelize(sources(), mGrid, own));
    }
    // Of several grids, the second.
    std::vector<VoxelGrid> pair;
    pair.push_back(VoxelGrid::create(device()).value());
    pair.push_back(VoxelGrid::create(other()).value());
    auto voxelizer = Voxelizer::create(device(), {.coverage = Coverage::Filled}).value();
    expectRefused(voxelizer->voxelizeWith(sources(), mGrid, {.split = Split::Facing}, pair),
                  "a grid");
}

TEST_F(VoxelizerContractGlTest, VolumesAttributesAndShadowVolumesOfAnotherDeviceAreRefused) {
    auto volume = VolumeGrid::create(other()).value();
    expectRefused(VolumeVoxelizer::create(device())->voxelize(sources(), {}, mGrid, volume),
                  "a volume");

    auto attributes = AttributeVoxelizer::create(device()).value();
    auto grid = VoxelGrid::create(device()).value();
    ASSERT_TRUE(Voxelizer::create(device()).value()->voxelize(sources(), mGrid, grid));
    auto foreignAttributes = VoxelAttributes::create(other()).value();
    expectRefused(attributes.voxelize(sources(), {}, grid, foreignAttributes), "attributes");
    auto ownAttributes = VoxelAttributes::create(device()).value();
    const auto foreignGrid = VoxelGrid::create(other()).value();
    expectRefused(attributes.voxelize(sources(), {}, foreignGrid, ownAttributes), "a grid");

    const auto transform =
        EpipolarTransform::fit(GridCamera::perspective(glm::dmat4(1.0), 1.0, 1.0, 0.1, 10.0),
                               {LightKind::Point, {1, 2, -3}}, {32, 32, 128})
            .value();
    auto epipolar = EpipolarVoxelizer::create(device()).value();
    auto shadows = EpipolarGrid::create(other()).value();
    expectRefused(epipolar.voxelize(sources(), {&transform, 1}, shadows), "a grid");
    ASSERT_TRUE(shadows.resize({&transform, 1}));
    expectRefused(epipolar.scan(shadows), "a grid");
}

TEST_F(VoxelizerContractGlTest, ValuesOutsideTheirEnumerationsAreRefused) {
    const auto expect = [&](const VoxelizerDesc& desc, const std::string& found) {
        const auto refused = Voxelizer::create(device(), desc);
        ASSERT_FALSE(refused) << found;
        EXPECT_EQ(refused.error().code, ErrorCode::InvalidArgument);
        EXPECT_THAT(refused.error().text, HasSubstr("expected a value of " + found));
    };
    for (const Backend backend : {Backend::Automatic, Backend::Overlap, Backend::Slicemap}) {
        expect({.backend = backend, .coverage = static_cast<Coverage>(99)}, "Coverage, found 99");
        expect({.backend = backend,
                .coverage = Coverage::Solid,
                .solidRule = static_cast<SolidRule>(55)},
               "SolidRule, found 55");
    }
    expect({.backend = static_cast<Backend>(77)}, "Backend, found 77");
    expect({.store = static_cast<VoxelStore>(5)}, "VoxelStore, found 5");

    auto voxelizer = Voxelizer::create(device()).value();
    std::vector<VoxelGrid> grids;
    grids.push_back(VoxelGrid::create(device()).value());
    const auto split =
        voxelizer->voxelizeWith(sources(), mGrid, {.split = static_cast<Split>(7)}, grids);
    ASSERT_FALSE(split);
    EXPECT_THAT(split.error().text, HasSubstr("expected a value of Split, found 7"));
}

TEST_F(VoxelizerContractGlTest, TheBufferStoreIsOverlapsOwn) {
    for (const Coverage coverage : {Coverage::Conservative, Coverage::Solid}) {
        auto grid = VoxelGrid::create(device()).value();
        auto inBuffer =
            Voxelizer::create(device(), {.coverage = coverage, .store = VoxelStore::Buffer})
                .value();
        ASSERT_TRUE(inBuffer->voxelize(sources(), mGrid, grid));
        EXPECT_EQ(inBuffer->backend(), Backend::Overlap);
        EXPECT_EQ(grid.store(), VoxelStore::Buffer);
        // Slices that overlap does not take: the same store.
        const GridTransform custom =
            GridTransform::box({{-1, -1, -1}, {1, 1, 1}}, {24, 24, 2}, Axis::Z,
                               SliceDistribution::custom({0, 0.25f, 1}))
                .value();
        ASSERT_TRUE(inBuffer->voxelize(sources(), custom, grid));
        EXPECT_EQ(inBuffer->backend(), Backend::MrtSlicemap);
        EXPECT_EQ(grid.store(), VoxelStore::Buffer);

        auto inTexture =
            Voxelizer::create(device(), {.coverage = coverage, .store = VoxelStore::Texture})
                .value();
        ASSERT_TRUE(inTexture->voxelize(sources(), mGrid, grid));
        EXPECT_EQ(inTexture->backend(), Backend::MrtSlicemap);
        EXPECT_EQ(grid.store(), VoxelStore::Texture);
    }
}

TEST_F(VoxelizerContractGlTest, AMissingContextIsNamed) {
    auto voxelizer = Voxelizer::create(device(), {Backend::Slicemap, Coverage::Filled}).value();
    auto overlap = Voxelizer::create(device(), {Backend::Overlap, Coverage::Conservative}).value();
    auto grid = VoxelGrid::create(device()).value();
    const auto expect = [](const auto& answer) {
        ASSERT_FALSE(answer);
        EXPECT_EQ(answer.error().code, ErrorCode::NoContext);
        EXPECT_THAT(answer.error().text,
                    AllOf(HasSubstr("expected the device's GL context current on this thread"),
                          HasSubstr("make it current first")));
    };
    // No context is current on a thread of its own.
    std::thread([&] {
        expect(voxelizer->voxelize(sources(), mGrid, grid));
        expect(overlap->voxelize(sources(), mGrid, grid));
        expect(VoxelGrid::create(device()));
        expect(MeshBuffers::upload(device(), ref::makeCube({0, 0, 0}, 1.0f)));
        expect(Voxelizer::create(device(), {Backend::Overlap, Coverage::Separating6}));
    }).join();
    EXPECT_TRUE(voxelizer->voxelize(sources(), mGrid, grid));
}

} // namespace
} // namespace lamina
