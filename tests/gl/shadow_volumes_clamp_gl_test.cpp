// Culled and clamped shadow volumes give the shadows of whole ones, pixel for pixel.

#include "gl/support/shadow_test_scenes.hpp"

#include <reference/shapes.hpp>

#include <algorithm>
#include <utility>

namespace lamina {
namespace {

using test::floorPart;
using test::lookAt;
using test::SceneHost;
using test::ScenePart;

/// A plate in y = 0 with a pit of sloped walls about `at`: a light above sees all of it.
TriangleMesh plateWithPit(const glm::vec2& at, float rim, float floor, float depth) {
    TriangleMesh mesh;
    const auto addSquare = [&](const glm::vec2& middle, float half, float y) {
        for (const auto& [x, z] :
             {std::pair{-1.0f, -1.0f}, {-1.0f, 1.0f}, {1.0f, 1.0f}, {1.0f, -1.0f}})
            mesh.positions.emplace_back(middle.x + half * x, y, middle.y + half * z);
    };
    addSquare({0.0f, 0.0f}, 5.0f, 0.0f);
    addSquare(at, rim, 0.0f);
    addSquare(at, floor, -depth);
    for (const std::uint32_t ring : {0u, 4u})
        for (std::uint32_t i = 0; i < 4; ++i) {
            const std::uint32_t a = ring + i, b = ring + (i + 1) % 4;
            mesh.triangles.emplace_back(a, b, b + 4);
            mesh.triangles.emplace_back(a, b + 4, a + 4);
        }
    mesh.triangles.emplace_back(8, 9, 10);
    mesh.triangles.emplace_back(8, 10, 11);
    return mesh;
}

class ShadowVolumesClampGlTest : public test::ShadowScenesGlTest {};

TEST_F(ShadowVolumesClampGlTest, KeptVolumesGiveTheWholeShadow) {
    auto volumes = ShadowVolumes::create(device()).value();
    std::uint64_t kept = 0, whole = 0;
    std::uint32_t culled = 0;
    forAll(3, [&](const ShadowScene& scene) {
        ASSERT_TRUE(volumes.prepare(scene));
        const auto light = lightOf(volumes, VolumeExtent::Whole);
        EXPECT_EQ(differences(lightOf(volumes, VolumeExtent::Kept), light), 0u);
        EXPECT_NE(std::ranges::count(light, 0.0f), 0);
        const auto report = volumes.downloadReport().value();
        EXPECT_LE(report.stencilFragments, report.stencilFragmentsWhole);
        kept += report.stencilFragments;
        whole += report.stencilFragmentsWhole;
        culled += report.castersCulled;
    });
    EXPECT_LT(kept, whole);
    EXPECT_GT(culled, 20u);
}

TEST_F(ShadowVolumesClampGlTest, ViewersInShadowSeeTheWholeShadow) {
    auto volumes = ShadowVolumes::create(device()).value();
    const unsigned views = forAllInShadow([&](const ShadowScene& scene) {
        ASSERT_TRUE(volumes.prepare(scene));
        const auto light = lightOf(volumes, VolumeExtent::Whole);
        EXPECT_EQ(differences(lightOf(volumes, VolumeExtent::Kept), light), 0u);
        EXPECT_NE(std::ranges::count(light, 0.0f), 0);
    });
    EXPECT_EQ(views, 40u);
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

TEST_F(ShadowVolumesClampGlTest, ThingsInPitsKeepTheirShadows) {
    // The pit is about two texels of the light's map wide, wherever their centres are. What hangs
    // in it shades the strip of its floor that the viewer sees below.
    auto volumes = ShadowVolumes::create(device(), {.layers = 128, .lightMapTexels = 16}).value();
    std::ptrdiff_t shadowed = 0;
    for (int step = 0; step < 30; ++step) {
        SCOPED_TRACE(step);
        const glm::vec2 at(0.1f, 0.025f * static_cast<float>(step));
        SceneHost host(device(), {{plateWithPit(at, 0.75f, 0.73f, 0.3f)},
                                  {reference::makeBox({at.x - 0.6f, -0.05f, at.y - 0.6f},
                                                      {at.x + 0.6f, -0.02f, at.y + 0.6f})}});
        const ShadowScene scene =
            sceneOf(host, lookAt({0.3, 9.5, 5.5}, {0.3, 0.0, 0.3}, kSize), {0.0, 1.0, 0.0, 0.0});
        ASSERT_TRUE(volumes.prepare(scene));
        const auto light = lightOf(volumes, VolumeExtent::Whole);
        shadowed += std::ranges::count(light, 0.0f);
        EXPECT_EQ(differences(lightOf(volumes, VolumeExtent::Kept), light), 0u);
    }
    EXPECT_GT(shadowed, 200);
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

} // namespace
} // namespace lamina
