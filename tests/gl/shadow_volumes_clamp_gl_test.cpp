// Culled and clamped shadow volumes give the shadows of whole ones, pixel for pixel, and save fill.

#include "gl/support/gl_test.hpp"
#include "gl/support/shadow_scene.hpp"

#include <reference/shapes.hpp>

#include <cmath>
#include <functional>
#include <numbers>

namespace lamina {
namespace {

using test::lookAt;
using test::SceneHost;
using test::ScenePart;

constexpr glm::uvec2 kSize{128, 96};

ScenePart floorPart() {
    return {reference::makePlane({0, 0, 0}, {0, 1, 0}, 30.0f, 8), false};
}

/// A number in [0,1) of a seed, the same everywhere.
float chance(std::uint32_t& seed) {
    seed = seed * 1664525u + 1013904223u;
    return static_cast<float>(seed >> 8) / 16777216.0f;
}

std::vector<ScenePart> scattered(std::uint32_t seed, unsigned count,
                                 const std::function<TriangleMesh(const glm::vec3&, float)>& make) {
    std::vector<ScenePart> parts{floorPart()};
    for (unsigned i = 0; i < count; ++i) {
        const float size = 0.15f + 0.35f * chance(seed);
        const float x = 7.0f * (chance(seed) - 0.5f), z = 7.0f * (chance(seed) - 0.5f);
        parts.push_back({make({x, size + 2.0f * chance(seed), z}, size)});
    }
    return parts;
}

struct TestScene {
    const char* name;
    std::vector<ScenePart> parts;
};

std::vector<TestScene> makeScenes() {
    std::vector<TestScene> scenes;
    scenes.push_back({"boxes", scattered(1, 14, [](const glm::vec3& at, float size) {
                          return reference::makeCube(at, 2.0f * size);
                      })});
    scenes.push_back({"spheres", scattered(2, 14, [](const glm::vec3& at, float size) {
                          return reference::makeIcosphere(at, size, 2);
                      })});
    scenes.push_back({"tori", scattered(3, 8, [](const glm::vec3& at, float size) {
                          return reference::makeTorus(at, size, 0.3f * size, 20, 8);
                      })});
    scenes.push_back({"plates", scattered(4, 12, [](const glm::vec3& at, float size) {
                          return reference::makePlane(at, at - glm::vec3(0.3f), 2.0f * size);
                      })});
    scenes.push_back({"knots", scattered(5, 4, [](const glm::vec3& at, float size) {
                          return reference::makeTorusKnot(at, size, 0.2f * size, 2, 3, 48, 6);
                      })});
    std::vector<ScenePart> wall{floorPart()};
    wall.push_back({reference::makeBox({-3.0f, 0.0f, -0.1f}, {3.0f, 3.0f, 0.1f})});
    for (int i = 0; i < 6; ++i)
        wall.push_back(
            {reference::makeCube({-2.0f + 0.8f * static_cast<float>(i), 0.5f, -1.5f}, 0.5f)});
    scenes.push_back({"behind a wall", wall});
    std::vector<ScenePart> tower{floorPart()};
    for (int i = 0; i < 8; ++i)
        tower.push_back({reference::makeBox({-0.4f, 0.5f * static_cast<float>(i), -0.4f},
                                            {0.4f, 0.5f * static_cast<float>(i) + 0.3f, 0.4f})});
    scenes.push_back({"tower", tower});
    std::vector<ScenePart> fence{floorPart()};
    for (int i = 0; i < 20; ++i) {
        const float x = -3.0f + 0.3f * static_cast<float>(i);
        fence.push_back({reference::makeBox({x, 0.0f, 0.0f}, {x + 0.04f, 1.5f, 0.04f})});
    }
    scenes.push_back({"fence", fence});
    scenes.push_back(
        {"sponge", {floorPart(), {reference::makeMengerSponge({0.0f, 1.6f, 0.0f}, 3.0f, 2)}}});
    std::vector<ScenePart> nested{floorPart()};
    const float radii[] = {1.4f, 1.2f};
    nested.push_back({reference::makeNestedShells({0.0f, 1.6f, 0.0f}, radii, 2)});
    nested.push_back({reference::makeIcosphere({0.0f, 1.6f, 0.0f}, 0.6f, 2)});
    nested.push_back({reference::makeTriangleSoup({{-3, 0.3, -3}, {3, 2, 3}}, 40, 0.8f, 9)});
    scenes.push_back({"nested and soup", nested});
    return scenes;
}

/// The camera and two lights move from step to step.
View viewAt(unsigned step) {
    const double angle = 0.7 + 1.9 * step;
    return lookAt({6.5 * std::sin(angle), 2.2 + 0.9 * step, 6.5 * std::cos(angle)}, {0, 0.8, 0},
                  kSize);
}
glm::dvec4 lightAt(unsigned step, bool isSun) {
    const double angle = 2.3 + 1.1 * step;
    if (isSun)
        return {std::sin(angle), 0.8 + 0.3 * step, std::cos(angle), 0.0};
    return {3.0 * std::sin(angle), 4.0 - step, 3.0 * std::cos(angle), 1.0};
}

class ShadowVolumesClampGlTest : public test::GlTest {
protected:
    static ShadowScene sceneOf(SceneHost& host, const View& view, const glm::dvec4& light) {
        ShadowScene scene;
        scene.view = view;
        scene.depthTexture = host.drawDepth(view);
        scene.light = light;
        scene.casters = host.casters();
        scene.receivers = host.sources();
        return scene;
    }
    std::vector<float> lightOf(ShadowVolumes& volumes, VolumeExtent extent) {
        return test::readRed(gl(), volumes.apply(extent).value(), kSize);
    }
    /// Calls `check` in the scenes, of which every one counts or every third, for every light and
    /// the first `steps` steps.
    void forAll(unsigned steps, const std::function<void(const ShadowScene&)>& check,
                std::size_t everyScene = 1) {
        const std::vector<TestScene> scenes = makeScenes();
        for (std::size_t i = 0; i < scenes.size(); i += everyScene) {
            const TestScene& test = scenes[i];
            SceneHost host(device(), test.parts);
            for (unsigned step = 0; step < steps; ++step)
                for (const bool isSun : {true, false}) {
                    SCOPED_TRACE(std::string(test.name) + (isSun ? ", sun " : ", lamp ") +
                                 std::to_string(step));
                    check(sceneOf(host, viewAt(step), lightAt(step, isSun)));
                }
        }
    }
    static std::size_t differences(const std::vector<float>& a, const std::vector<float>& b) {
        std::size_t count = 0;
        for (std::size_t i = 0; i < a.size(); ++i)
            count += a[i] != b[i] ? 1 : 0;
        return count;
    }
};

TEST_F(ShadowVolumesClampGlTest, KeptVolumesGiveTheWholeShadow) {
    auto volumes = ShadowVolumes::create(device()).value();
    std::uint64_t kept = 0, whole = 0;
    std::uint32_t culled = 0;
    forAll(3, [&](const ShadowScene& scene) {
        ASSERT_TRUE(volumes.prepare(scene));
        EXPECT_EQ(differences(lightOf(volumes, VolumeExtent::Kept),
                              lightOf(volumes, VolumeExtent::Whole)),
                  0u);
        const auto report = volumes.downloadReport().value();
        EXPECT_LE(report.stencilFragments, report.stencilFragmentsWhole);
        kept += report.stencilFragments;
        whole += report.stencilFragmentsWhole;
        culled += report.castersCulled;
    });
    EXPECT_LT(kept, whole);
    EXPECT_GT(culled, 20u);
}

TEST_F(ShadowVolumesClampGlTest, AGapFinerThanTheLightsTexelsLetsLightThrough) {
    // A wall with a slit between light and cube: the cube's shadow lies in the slit's streak of
    // light, and whole texels of the light's map see nothing but wall.
    std::vector<ScenePart> parts{floorPart()};
    parts.push_back({reference::makeBox({-4.0f, 0.0f, -0.1f}, {-0.015f, 4.0f, 0.1f})});
    parts.push_back({reference::makeBox({0.015f, 0.0f, -0.1f}, {4.0f, 4.0f, 0.1f})});
    parts.push_back({reference::makeCube({0.0f, 0.35f, -0.9f}, 0.5f)});
    SceneHost host(device(), parts);
    for (const std::uint32_t texels : {16u, 24u, 33u, 64u}) {
        auto volumes = ShadowVolumes::create(device(), {.lightMapTexels = texels}).value();
        const ShadowScene scene =
            sceneOf(host, lookAt({0.4, 1.6, -3.4}, {0, 0, -1.9}, kSize), {0.0, 2.6, 4.0, 1.0});
        ASSERT_TRUE(volumes.prepare(scene));
        const auto whole = lightOf(volumes, VolumeExtent::Whole);
        EXPECT_EQ(differences(lightOf(volumes, VolumeExtent::Kept), whole), 0u) << texels;
        test::savePicture("slit", whole, kSize, 1.0f);
        EXPECT_TRUE(volumes.downloadReport()->keptLayers[2].any()) << texels;
    }
}

TEST_F(ShadowVolumesClampGlTest, GeometryReceiversGiveTheWholeShadowToo) {
    auto exact = ShadowVolumes::create(device(), {.lightMapTexels = 256}).value();
    auto volumes =
        ShadowVolumes::create(device(), {.lightMapTexels = 256, .litmap = false}).value();
    std::uint64_t keptExact = 0, kept = 0;
    forAll(1, [&](const ShadowScene& scene) {
        ASSERT_TRUE(exact.prepare(scene));
        ASSERT_TRUE(volumes.prepare(scene));
        EXPECT_EQ(differences(lightOf(volumes, VolumeExtent::Kept),
                              lightOf(volumes, VolumeExtent::Whole)),
                  0u);
        keptExact += exact.downloadReport()->layersKept;
        kept += volumes.downloadReport()->layersKept;
    });
    // The litmap keeps no more than the receivers that it refines.
    EXPECT_LT(keptExact, kept);
}

TEST_F(ShadowVolumesClampGlTest, QueriesKeepWhatTheReductionKeeps) {
    ShadowVolumesDesc desc;
    desc.layers = 6;
    desc.lightMapTexels = 128;
    auto reduction = ShadowVolumes::create(device(), desc).value();
    desc.search = LayerSearch::Queries;
    auto queries = ShadowVolumes::create(device(), desc).value();
    forAll(
        1,
        [&](const ShadowScene& scene) {
            ASSERT_TRUE(reduction.prepare(scene));
            const auto prepared = queries.prepare(scene);
            ASSERT_TRUE(prepared) << prepared.error().text;
            const auto expected = reduction.downloadReport().value();
            const auto found = queries.downloadReport().value();
            EXPECT_EQ(found.keptLayers, expected.keptLayers);
            EXPECT_EQ(found.castersShadowed, expected.castersShadowed);
            EXPECT_EQ(found.stencilFragments, expected.stencilFragments);
        },
        3);
}

TEST_F(ShadowVolumesClampGlTest, ClippedVolumesDifferAtShadowEdgesAlone) {
    auto volumes = ShadowVolumes::create(device(), {.clipVolumes = true}).value();
    std::size_t different = 0;
    std::size_t pixels = 0;
    forAll(1, [&](const ShadowScene& scene) {
        ASSERT_TRUE(volumes.prepare(scene));
        const auto whole = lightOf(volumes, VolumeExtent::Whole);
        const auto kept = lightOf(volumes, VolumeExtent::Kept);
        for (std::uint32_t y = 1; y + 1 < kSize.y; ++y)
            for (std::uint32_t x = 1; x + 1 < kSize.x; ++x) {
                const std::size_t i = std::size_t{y} * kSize.x + x;
                if (kept[i] == whole[i])
                    continue;
                ++different;
                const bool isEdge = whole[i] != whole[i + 1] || whole[i] != whole[i - 1] ||
                                    whole[i] != whole[i + kSize.x] ||
                                    whole[i] != whole[i - kSize.x];
                EXPECT_TRUE(isEdge) << x << ", " << y;
            }
        pixels += whole.size();
    });
    // Edges move by 1/256 pixel, and a hundredth of the pixels are edges.
    EXPECT_LT(different, pixels / 5000);
}

TEST_F(ShadowVolumesClampGlTest, EachStepKeepsLess) {
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

TEST_F(ShadowVolumesClampGlTest, CountsWhatAKnownSceneHides) {
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

} // namespace
} // namespace lamina
