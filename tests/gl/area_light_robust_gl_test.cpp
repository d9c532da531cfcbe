// What [WD13] 5 does for robustness: lights and eyes in awkward places, the epipole rule, 127 bits
// a texel, volumes shifted against each other, and no work for tiles without a virtual light.

#include "gl/support/fog_test.hpp"

#include <reference/fog_errors.hpp>
#include <reference/shapes.hpp>

#include <glm/gtc/matrix_transform.hpp>

#include <cstdio>

namespace lamina {
namespace {

using reference::relativeRmse;
using test::FogScene;

Medium fog() {
    return {0.12f, glm::vec3(0.9f), 0.2f};
}

/// A rectangle about `center` that shines towards `target`.
RectangleLight facing(const glm::dvec3& center, const glm::dvec3& target, double width,
                      double height) {
    const glm::dvec3 out = glm::normalize(target - center);
    RectangleLight light;
    light.edgeU = width * glm::normalize(glm::cross(glm::dvec3(0, 1, 0), out));
    light.edgeV = height * glm::normalize(glm::cross(out, light.edgeU));
    light.corner = center - 0.5 * (light.edgeU + light.edgeV);
    return light;
}

class AreaLightRobustGlTest : public test::FogTest {
protected:
    const TriangleMesh mFence = reference::makeFenceScene();
};

TEST_F(AreaLightRobustGlTest, AreaLightsAnywhereAgreeWithRayCasting) {
    // A roof over the camera takes its light away.
    const TriangleMesh roofed =
        reference::merged(mFence, reference::makeBox({-1.5f, 2.1f, 3.6f}, {2.5f, 2.2f, 6.5f}));
    struct Case {
        const char* name;
        RectangleLight light;
        const TriangleMesh& mesh;
        bool isEyeDark;
        double leastShadow; ///< Share of the light that must be lost, lest the case show nothing.
    };
    const Case cases[] = {
        {"behind the camera", facing({1.0, 2.8, 7.5}, {0, 0.5, 0}, 2.5, 1.2), mFence, false, 0.0},
        {"behind, aside", facing({6.0, 2.2, 6.5}, {0, 0.5, 0}, 2.5, 1.2), mFence, false, 0.002},
        {"off screen", facing({-5.0, 2.0, 0.5}, {0, 0.5, 0}, 1.5, 1.5), mFence, false, 0.01},
        {"above, the eye in shadow", facing({0.4, 5.0, 5.2}, {0.2, 0, 2.5}, 1.0, 1.0), roofed, true,
         0.2},
        {"around the eye's plane", facing({-3.0, 1.0, 5.0}, {0, 0.5, 0}, 2.0, 1.5), mFence, false,
         0.005}};
    AreaLightDesc desc;
    desc.virtualLights = 32;
    for (const Case& test : cases) {
        SCOPED_TRACE(test.name);
        const FogScene scene(gl(), test.mesh, reference::frontEye(), {20, 16});
        const auto lights = sampleVirtualLights(test.light, desc.virtualLights).value();
        const auto marched = march(scene, lights, fog(), 160);
        for (const VirtualLight& light : lights)
            ASSERT_EQ(scene.rays().lit(light.light, scene.eye()), !test.isEyeDark);
        EXPECT_GT(marched.shadow(), test.leastShadow);
        for (const ShadowMaps maps : {ShadowMaps::Rendered, ShadowMaps::Imperfect}) {
            desc.maps = maps;
            const auto effect = lit(desc, scene, test.mesh, test.light, fog());
            const double error = relativeRmse(sums(scene, effect), marched.airlight);
            std::printf("%-26s %-9s %.2f %%, shadow %.1f %%\n", test.name,
                        maps == ShadowMaps::Rendered ? "rendered" : "imperfect", 100.0 * error,
                        100.0 * marched.shadow());
            // Most of it steps of alpha and theta at shadows' edges.
            EXPECT_LE(error, test.isEyeDark ? 0.03 : 0.01);
        }
    }
}

TEST_F(AreaLightRobustGlTest, TheEpipoleRuleIsRightWhereVoxelsAreLong) {
    // A lamp on screen, a wall behind it, and beside it a post whose face is a third of an alpha
    // voxel away from the line of sight: the voxel at the epipole is then in shadow, the line of
    // sight is not.
    const glm::dvec3 eye(0.0, 1.0, 5.0);
    TriangleMesh mesh = reference::makeBox({0.05f, 0.0f, -1.1f}, {0.6f, 2.5f, -0.9f});
    mesh = reference::merged(mesh, reference::makeBox({-3.0f, -1.0f, -3.2f}, {3.0f, 3.0f, -3.0f}));
    const PointLight lamp{{0.001, 1.0005, -1.0}};
    const GridCamera camera = GridCamera::perspective(
        glm::lookAt(eye, lamp.position, glm::dvec3(0, 1, 0)), 0.3, 1.25, 0.1, 10.0);
    const FogScene scene(gl(), mesh, camera, {160, 128});
    AreaLightDesc desc;
    desc.voxels = {8, 128, 128};
    desc.mapTexels = 512;
    double errors[2] = {};
    std::size_t near = 0, behind = 0;
    for (const int isRuled : {0, 1}) {
        desc.epipoleVoxels = isRuled;
        const auto effect = lit(desc, scene, mesh, lamp, fog());
        const EpipolarTransform& space = effect.volumes().front().transforms().front();
        const auto found = sums(scene, effect);
        const auto surface = sums(scene, effect, 1);
        std::vector<double> ours, truth;
        near = behind = 0;
        for (std::size_t i = 0; i < scene.pixelCount(); ++i) {
            const glm::dvec3 offset = scene.point(i) - eye;
            const double alpha = std::acos(glm::dot(glm::normalize(offset), space.axis()));
            if (alpha < 0.5 / space.scale().x && glm::length(offset) < 5.95) {
                ++behind;
                EXPECT_TRUE(isRuled == 0 || (found[i] == 0.0 && surface[i] == 0.0))
                    << "light through the post";
            }
            if (alpha > 0.15 / space.scale().x)
                continue;
            ++near;
            EXPECT_GT(glm::length(offset), 7.0);
            ours.push_back(found[i]);
            truth.push_back(static_cast<double>(fog().extinction * fog().albedo.x) *
                            reference::marchFog(&scene.rays(), effect.virtualLights(), fog(), eye,
                                                scene.point(i), 400)
                                .airlight);
        }
        errors[isRuled] = relativeRmse(ours, truth);
    }
    std::printf("%zu pixels at the epipole: error %.1f %%, by the rule %.1f %%\n", near,
                100.0 * errors[0], 100.0 * errors[1]);
    EXPECT_GT(near, 10u);
    EXPECT_GT(behind, 10u);
    EXPECT_GT(errors[0], 0.2);
    EXPECT_LT(errors[1], 0.03);
}

TEST_F(AreaLightRobustGlTest, ABitLessATexelGivesTheSamePicture) {
    const FogScene scene(gl(), mFence, reference::frontEye(), {40, 32});
    const RectangleLight light = facing({0.0, 3.2, -2.8}, {0, 0, 1}, 3.0, 1.2);
    for (const std::uint32_t phi : {127u, 128u, 200u, 300u})
        for (const AirlightForm form : {AirlightForm::Weighted, AirlightForm::Factored}) {
            AreaLightDesc desc;
            desc.virtualLights = 6;
            desc.voxels = {64, 48, phi};
            desc.maps = ShadowMaps::Rendered;
            desc.airlight = form;
            std::vector<double> found[2][2];
            for (const std::uint32_t bits : {127u, 128u}) {
                desc.bitsPerTexel = bits;
                const auto effect = lit(desc, scene, mFence, light, fog());
                const EpipolarBits words = effect.volumes().front().download().value();
                EXPECT_EQ(words.groupCount(), (phi + bits - 1) / bits);
                for (std::size_t i = 3; i < words.words().size(); i += 4)
                    ASSERT_TRUE(bits == 128 || words.words()[i] >> 31u == 0)
                        << "the last bit is used";
                for (const int which : {0, 1})
                    found[which][bits - 127] = sums(scene, effect, which);
            }
            for (const int which : {0, 1}) {
                const double error = relativeRmse(found[which][0], found[which][1]);
                // Weights are shared by eight samples, counted from a texel's first.
                const bool isRegrouped = form == AirlightForm::Weighted && which == 0 && phi > 127;
                EXPECT_LE(error, isRegrouped ? 2e-3 : 1e-6)
                    << phi << " phi samples, target " << which;
            }
        }
}

/// Root of the mean square of the second differences along rows and columns of found / expected:
/// steps in what ought to be smooth.
double banding(const std::vector<double>& found, const std::vector<double>& expected,
               const glm::uvec2& size) {
    std::vector<double> ratio;
    for (std::size_t i = 0; i < found.size(); ++i)
        ratio.push_back(found[i] / expected[i]);
    double sum = 0.0;
    std::size_t count = 0;
    for (std::size_t y = 0; y < size.y; ++y)
        for (std::size_t x = 0; x < size.x; ++x)
            for (const std::size_t step : {std::size_t{1}, std::size_t{size.x}}) {
                const std::size_t at = y * size.x + x;
                const std::size_t place = step == 1 ? x : y;
                const std::size_t last = step == 1 ? size.x - 1 : size.y - 1;
                if (place == 0 || place == last)
                    continue;
                const double bend = ratio[at - step] - 2.0 * ratio[at] + ratio[at + step];
                sum += bend * bend;
                ++count;
            }
    return std::sqrt(sum / static_cast<double>(count));
}

TEST_F(AreaLightRobustGlTest, ShiftedVolumesShowLessBanding) {
    // A roof's soft shadow, seen against a wall through fog: without steps, had the volumes none.
    TriangleMesh mesh = reference::makePlane({0, 0, -2}, {0, 0, 1}, 12.0f);
    mesh = reference::merged(mesh, reference::makeBox({-1.5f, 2.4f, -1.0f}, {1.5f, 2.5f, 1.5f}));
    const FogScene scene(gl(), mesh, reference::makeEye({0.3, 0.4, 6.0}, {0.0, 0.6, 0.0}),
                         {64, 48});
    // A small light: all volumes have nearly the same axis, and their voxels would coincide.
    DiskLight light;
    light.center = {0.2, 5.0, 0.3};
    light.normal = {0.0, -1.0, 0.0};
    light.radius = 0.05;
    light.radiance = glm::vec3(300.0f);
    AreaLightDesc desc;
    desc.virtualLights = 64;
    desc.voxels = glm::uvec3(32);
    desc.mapTexels = 256;
    desc.maps = ShadowMaps::Rendered;
    const auto lights = sampleVirtualLights(light, 8).value();
    const auto marched = march(scene, lights, fog(), 200);
    for (const bool isInterpolated : {false, true}) {
        desc.interpolate = isInterpolated;
        double bands[2] = {}, errors[2] = {};
        for (const bool isShifted : {false, true}) {
            desc.jitter = isShifted;
            const auto effect = lit(desc, scene, mesh, light, fog());
            const auto found = sums(scene, effect);
            bands[isShifted ? 1 : 0] = banding(found, marched.airlight, scene.view().size);
            errors[isShifted ? 1 : 0] = relativeRmse(found, marched.airlight);
        }
        std::printf("banding %.4f, shifted %.4f; error %.2f %%, shifted %.2f %%\n", bands[0],
                    bands[1], 100.0 * errors[0], 100.0 * errors[1]);
        EXPECT_LT(bands[1], (isInterpolated ? 0.8 : 0.4) * bands[0]);
        EXPECT_LT(errors[1], errors[0]);
    }
}

TEST_F(AreaLightRobustGlTest, CoarseGathersKeepTheEdgesOfLitSurfaces) {
    // Fence bars of about a pixel before bright ground: no sum of a quarter's pixels is theirs.
    const FogScene scene(gl(), mFence, reference::frontEye(), {160, 128});
    AreaLightDesc desc;
    desc.virtualLights = 36;
    desc.voxels = glm::uvec3(64);
    desc.mapTexels = 128;
    const RectangleLight light = facing({0.0, 3.8, -3.6}, {0, 0, 0}, 3.0, 1.2);
    const auto pixels = [&](GatherMode mode) {
        desc.gather = mode;
        auto effect = lit(desc, scene, mFence, light, fog());
        std::vector<double> values;
        const auto picture = effect.apply(scene.view(), scene.surfaces()).value();
        for (const glm::vec4& texel : scene.read(picture))
            values.push_back(static_cast<double>(texel.x));
        return values;
    };
    const auto full = pixels(GatherMode::Full);
    double mean = 0.0;
    for (const double value : full)
        mean += value / static_cast<double>(full.size());
    for (const GatherMode mode : {GatherMode::Interleaved, GatherMode::Quarter}) {
        const auto coarse = pixels(mode);
        // On bars: facing the eye, their backs to the light.
        std::vector<double> found, expected;
        std::size_t glaring = 0;
        for (std::size_t i = 0; i < full.size(); ++i)
            if (std::abs(scene.point(i).z + 0.98) < 0.01 && scene.normal(i).z > 0.9) {
                found.push_back(coarse[i]);
                expected.push_back(full[i]);
                glaring += coarse[i] > full[i] + 0.5 * mean ? 1 : 0;
            }
        const double error = relativeRmse(found, expected);
        std::printf("%s: bars %.1f %%, %zu of %zu glare, all %.1f %%\n",
                    mode == GatherMode::Quarter ? "quarter" : "interleaved", 100.0 * error, glaring,
                    found.size(), 100.0 * relativeRmse(coarse, full));
        EXPECT_GT(found.size(), 200u);
        EXPECT_EQ(glaring, 0u);
        EXPECT_LE(error, 0.1);
    }
}

TEST_F(AreaLightRobustGlTest, TilesWithoutALightAreNotTouched) {
    const FogScene scene(gl(), mFence, reference::frontEye(), {32, 24});
    AreaLightDesc desc;
    desc.virtualLights = 24;
    desc.voxels = {64, 32, 130};
    const RectangleLight many = facing({0.0, 3.2, -2.8}, {0, 0, 1}, 3.0, 1.2);
    auto effect = lit(desc, scene, mFence, many, fog());
    const EpipolarGrid& grid = effect.volumes().front();
    // The same object now serves one light; what stands in the other tiles must stay.
    const GLuint words = grid.texture();
    const glm::uvec4 mark(0xdeadbeefu);
    const glm::ivec3 size(64, 32, 2);
    std::vector<glm::uvec2> tiles;
    for (std::uint32_t i = 1; i < desc.virtualLights; ++i)
        tiles.push_back(grid.tile(i));
    for (const glm::uvec2& tile : tiles)
        gl().ClearTexSubImage(words, 0, static_cast<GLint>(tile.x), static_cast<GLint>(tile.y), 0,
                              size.x, size.y, size.z, GL_RGBA_INTEGER, GL_UNSIGNED_INT, &mark);
    const auto before = sums(scene, lit(desc, scene, mFence, PointLight{{0.6, 2.2, -2.6}}, fog()));
    draw(effect, scene, mFence, PointLight{{0.6, 2.2, -2.6}}, fog());
    ASSERT_EQ(effect.virtualLights().size(), 1u);
    EXPECT_EQ(effect.volumes().front().texture(), words);
    EXPECT_EQ(sums(scene, effect), before) << "what other tiles hold shows";
    for (const glm::uvec2& tile : tiles)
        for (int layer = 0; layer < size.z; ++layer) {
            std::vector<glm::uvec4> content(static_cast<std::size_t>(size.x * size.y));
            gl().GetTextureSubImage(
                words, 0, static_cast<GLint>(tile.x), static_cast<GLint>(tile.y), layer, size.x,
                size.y, 1, GL_RGBA_INTEGER, GL_UNSIGNED_INT,
                static_cast<GLsizei>(content.size() * sizeof content[0]), content.data());
            for (const glm::uvec4& texel : content)
                ASSERT_EQ(texel, mark);
        }
}

} // namespace
} // namespace lamina
