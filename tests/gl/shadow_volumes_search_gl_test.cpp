// Which casters and layers shadow volumes keep: the same ones by both searches, fewer with each
// step of culling and clamping, and those of a known scene.

#include "gl/support/shadow_test_scenes.hpp"

#include <reference/shapes.hpp>
#include <support/court.hpp>

namespace lamina {
namespace {

using test::floorPart;
using test::lookAt;
using test::SceneHost;
using test::ScenePart;

std::vector<ScenePart> courtParts() {
    std::vector<ScenePart> parts;
    for (const example::CourtThing& thing : example::makeCourt())
        parts.push_back({thing.mesh, thing.casts});
    return parts;
}

class ShadowVolumesSearchGlTest : public test::ShadowScenesGlTest {};

TEST_F(ShadowVolumesSearchGlTest, QueriesKeepWhatTheReductionKeeps) {
    ShadowVolumesDesc desc;
    desc.layers = 6;
    desc.lightMapTexels = 128;
    auto reduction = ShadowVolumes::create(device(), desc).value();
    desc.search = LayerSearch::Queries;
    auto queries = ShadowVolumes::create(device(), desc).value();
    std::uint64_t kept = 0, layers = 0;
    const Check check = [&](const ShadowScene& scene) {
        ASSERT_TRUE(reduction.prepare(scene));
        const auto prepared = queries.prepare(scene);
        ASSERT_TRUE(prepared) << prepared.error().text;
        const auto expected = reduction.downloadReport().value();
        const auto found = queries.downloadReport().value();
        EXPECT_EQ(found.keptLayers, expected.keptLayers);
        EXPECT_EQ(found.castersShadowed, expected.castersShadowed);
        EXPECT_EQ(found.stencilFragments, expected.stencilFragments);
        kept += expected.layersKept;
        layers += std::uint64_t{expected.casters} * expected.layers;
    };
    forAll(3, check);
    forAllInShadow(check);
    EXPECT_GT(kept, 0u);
    EXPECT_LT(kept, layers);
}

TEST_F(ShadowVolumesSearchGlTest, WhereTheSearchesRoundDifferentlyBothAreRight) {
    // Many casters, small texels of the light's map, many pixels: here and there a triangle passes
    // the limit of a test by less than rounding, and the two programs differ (on llvmpipe in one of
    // 2336 layers). The limits leave room: no shadow may depend on it.
    SceneHost host(device(), courtParts());
    View view;
    view.size = {960, 640};
    view.worldToClip =
        glm::perspective(0.62, 1.5, 0.5, 80.0) *
        glm::lookAt(glm::dvec3(4.0, 6.5, 19.0), glm::dvec3(0.3, 0.3, -0.6), glm::dvec3(0, 1, 0));
    const ShadowScene scene = sceneOf(host, view, {-3.0, 7.0, 1.0, 1.0});
    ShadowVolumesDesc desc;
    desc.lightMapTexels = 1024;
    auto reduction = ShadowVolumes::create(device(), desc).value();
    desc.search = LayerSearch::Queries;
    auto queries = ShadowVolumes::create(device(), desc).value();
    std::vector<std::vector<std::bitset<128>>> kept;
    for (ShadowVolumes* volumes : {&reduction, &queries}) {
        ASSERT_TRUE(volumes->prepare(scene));
        const auto whole =
            test::readRed(gl(), volumes->apply(VolumeExtent::Whole).value(), view.size);
        EXPECT_TRUE(test::readRed(gl(), volumes->apply().value(), view.size) == whole);
        kept.push_back(volumes->downloadReport()->keptLayers);
    }
    std::size_t different = 0;
    for (std::size_t i = 0; i < kept[0].size(); ++i)
        different += (kept[0][i] ^ kept[1][i]).count();
    EXPECT_LE(different, 4u);
}

TEST_F(ShadowVolumesSearchGlTest, EachStepKeepsLess) {
    ShadowVolumesDesc desc;
    desc.lightMapTexels = 256;
    desc.cullCasters = desc.clampLayers = desc.casterDepthTest = desc.litmap = false;
    std::vector<ShadowVolumesDesc> steps{desc};
    desc.cullCasters = true;
    steps.push_back(desc);
    desc.clampLayers = true;
    steps.push_back(desc);
    desc.casterDepthTest = true;
    steps.push_back(desc);
    desc.litmap = true;
    steps.push_back(desc);
    std::vector<std::uint64_t> fragments;
    for (const ShadowVolumesDesc& step : steps) {
        auto volumes = ShadowVolumes::create(device(), step).value();
        fragments.push_back(0);
        forAll(
            1,
            [&](const ShadowScene& scene) {
                ASSERT_TRUE(volumes.prepare(scene));
                const auto report = volumes.downloadReport().value();
                fragments.back() += report.stencilFragments;
                if (fragments.size() == 1) {
                    EXPECT_EQ(report.castersCulled, 0u);
                    EXPECT_EQ(report.layersKept, report.layers * report.casters);
                    EXPECT_EQ(report.stencilFragments, report.stencilFragmentsWhole);
                }
            },
            5);
    }
    for (std::size_t i = 1; i < fragments.size(); ++i)
        EXPECT_LT(fragments[i], fragments[i - 1]) << i;
}

TEST_F(ShadowVolumesSearchGlTest, CountsWhatAKnownSceneHides) {
    // From the front: a wall, things behind it in its shadow, and things the wall hides from view.
    std::vector<ScenePart> parts;
    parts.push_back({reference::makePlane({0, 0, 0}, {0, 1, 0}, 30.0f), false});
    parts.push_back({reference::makeBox({-3.0f, 0.0f, -0.2f}, {3.0f, 4.0f, 0.2f})});
    parts.push_back({reference::makeCube({0.0f, 0.6f, -2.0f}, 0.8f)});
    parts.push_back({reference::makeCube({1.5f, 0.6f, -3.0f}, 0.8f)});
    parts.push_back({reference::makeCube({-2.3f, 0.6f, 2.0f}, 0.8f)});
    SceneHost host(device(), parts);
    // Light and viewer on the same side, so that the wall hides and shadows the same two cubes.
    const ShadowScene scene =
        sceneOf(host, lookAt({0, 1.5, 9.0}, {0, 1.2, 0}, kSize), {0.1, 3.0, 10.0, 1.0});
    auto volumes = ShadowVolumes::create(device()).value();
    ASSERT_TRUE(volumes.prepare(scene));
    const auto report = volumes.downloadReport().value();
    EXPECT_EQ(report.casters, 4u);
    EXPECT_EQ(report.castersShadowed, 2u);
    EXPECT_GE(report.castersCulled, 2u);
    EXPECT_TRUE(report.keptLayers[1].none());
    EXPECT_TRUE(report.keptLayers[2].none());
    EXPECT_TRUE(report.keptLayers[3].any());
    EXPECT_EQ(report.receivers, 5u);
    EXPECT_EQ(report.receiversCulled, 2u);
    EXPECT_EQ(report.layers, 32u);
    EXPECT_GT(report.stencilFragments, 0u);
}

TEST_F(ShadowVolumesSearchGlTest, TheCourtTakesAThirdOfTheFill) {
    SceneHost host(device(), courtParts());
    const ShadowScene scene =
        sceneOf(host, lookAt({3.0, 6.0, 14.0}, {0.3, 0.3, -0.6}, kSize), {example::kCourtSun, 0.0});
    auto volumes = ShadowVolumes::create(device(), {.layers = 48}).value();
    ASSERT_TRUE(volumes.prepare(scene));
    EXPECT_EQ(
        differences(lightOf(volumes, VolumeExtent::Kept), lightOf(volumes, VolumeExtent::Whole)),
        0u);
    const auto report = volumes.downloadReport().value();
    EXPECT_EQ(report.casters, 73u);
    EXPECT_GT(report.castersCulled, 8u);
    EXPECT_GT(report.stencilFragmentsWhole, 3 * report.stencilFragments);
}

} // namespace
} // namespace lamina
