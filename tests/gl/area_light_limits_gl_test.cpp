// Memory of lamina::area_light: reported, taken once, refused before any work; and bad input on
// every public call, which leaves what was there.

#include "gl/support/fog_scene.hpp"
#include "gl/support/gl_calls.hpp"
#include "gl/support/gl_test.hpp"

#include <reference/epipolar_agreement.hpp>
#include <reference/shapes.hpp>

#include <gmock/gmock.h>

#include <cmath>
#include <functional>
#include <limits>

namespace lamina {
namespace {

using test::FogScene;
using test::GlCalls;
using test::smallDesc;
using test::smallRectangle;
using testing::HasSubstr;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr float kNanFloat = std::numeric_limits<float>::quiet_NaN();

class AreaLightLimitsGlTest : public test::GlTest {
protected:
    void SetUp() override {
        GlTest::SetUp();
        mScene.emplace(gl(), mMesh, reference::frontEye(), glm::uvec2(31, 22));
        mBuffers.emplace(MeshBuffers::upload(device(), mMesh).value());
    }
    void TearDown() override {
        gl().DeleteTextures(static_cast<GLsizei>(mTextures.size()), mTextures.data());
        mBuffers.reset();
        mScene.reset();
        GlTest::TearDown();
    }
    Result<AreaLightStats> prepare(AreaLight& effect, const LightSource& light,
                                   const Medium& medium = {}) {
        const GeometrySource sources[] = {mBuffers->view()};
        return effect.prepare(mScene->view(), light, medium, sources);
    }
    std::vector<glm::vec4> airlight(AreaLight& effect) {
        const auto done = effect.apply(mScene->view(), mScene->surfaces());
        EXPECT_TRUE(done) << done.error().text;
        return mScene->read(effect.sums()[0]);
    }
    GLuint makeTexture(GLenum target, GLenum format, int width = 31, int height = 22) {
        GLuint texture = 0;
        gl().CreateTextures(target, 1, &texture);
        mTextures.push_back(texture);
        if (target == GL_TEXTURE_2D)
            gl().TextureStorage2D(texture, 1, format, width, height);
        else if (target == GL_TEXTURE_2D_MULTISAMPLE)
            gl().TextureStorage2DMultisample(texture, 4, format, width, height, GL_TRUE);
        else
            gl().TextureStorage3D(texture, 1, format, width, height, 1);
        return texture;
    }
    GladGLContext& table() { return device().state()->gl; }

    const TriangleMesh mMesh = reference::makeFenceScene();
    std::optional<FogScene> mScene;
    std::optional<MeshBuffers> mBuffers;
    std::vector<GLuint> mTextures;
};

TEST_F(AreaLightLimitsGlTest, Frames256LightsTakeNoMemoryAfterTheFirst) {
    for (const ShadowMaps maps : {ShadowMaps::Imperfect, ShadowMaps::Rendered})
        for (const GatherMode gather : {GatherMode::Interleaved, GatherMode::Quarter}) {
            AreaLightDesc desc = smallDesc();
            desc.virtualLights = 256;
            desc.voxels = {32, 16, 128};
            desc.maps = maps;
            desc.gather = gather;
            auto effect = AreaLight::create(device(), desc).value();
            const GlCalls calls(table());
            const auto frame = [&](double x) {
                RectangleLight moved = smallRectangle();
                moved.corner.x += x;
                ASSERT_TRUE(prepare(effect, moved));
                (void)airlight(effect);
            };
            frame(0.0);
            const std::size_t allocations = calls.allocations();
            const auto streamed = calls.streamed();
            const std::uint64_t bytes = device().allocatedBytes();
            EXPECT_GT(allocations, 0u);
            frame(0.1);
            frame(0.2);
            EXPECT_EQ(calls.allocations(), allocations);
            EXPECT_EQ(calls.streamed(), streamed) << "small constants, of the same size";
            EXPECT_EQ(device().allocatedBytes(), bytes);
        }
}

TEST_F(AreaLightLimitsGlTest, AllMemoryIsReported) {
    for (const ShadowMaps maps : {ShadowMaps::Imperfect, ShadowMaps::Rendered})
        for (const ShadowVolumeLayout layout :
             {ShadowVolumeLayout::Tiled, ShadowVolumeLayout::Separate}) {
            AreaLightDesc desc = smallDesc();
            desc.maps = maps;
            desc.layout = layout;
            const std::uint64_t before = device().allocatedBytes();
            auto effect = AreaLight::create(device(), desc).value();
            ASSERT_TRUE(prepare(effect, smallRectangle()));
            (void)airlight(effect);
            const auto stats = prepare(effect, smallRectangle()).value();
            EXPECT_EQ(effect.gpuBytes(), device().allocatedBytes() - before);
            EXPECT_EQ(effect.gpuBytes(), stats.volumeBytes + stats.mapBytes + stats.targetBytes);
            EXPECT_GE(stats.volumeBytes, 20u * 32 * 24 * 2 * 16);
            EXPECT_GE(stats.mapBytes, 33u * 33 * 4);
            EXPECT_EQ(stats.targetBytes, 31u * 22 * (16 + 16 + 8));
        }
}

TEST_F(AreaLightLimitsGlTest, StagesAreTimedOnlyIfAsked) {
    for (const bool isMeasured : {false, true}) {
        AreaLightDesc desc = smallDesc();
        desc.measure = isMeasured;
        auto effect = AreaLight::create(device(), desc).value();
        EXPECT_EQ(effect.times(), AreaLightTimes{});
        // Times arrive some frames later where the GPU has timers.
        for (int frame = 0; frame < 6; ++frame) {
            ASSERT_TRUE(prepare(effect, smallRectangle()));
            (void)airlight(effect);
            gl().Finish();
        }
        const AreaLightTimes times = effect.times();
        for (const AreaLightStage stage :
             {AreaLightStage::Maps, AreaLightStage::Voxelize, AreaLightStage::Scan,
              AreaLightStage::Gather, AreaLightStage::Composite}) {
            const double time = times[static_cast<std::size_t>(stage)];
            EXPECT_EQ(time > 0.0, isMeasured) << name(stage);
            EXPECT_LT(time, 60e3) << name(stage);
        }
        // Drawn maps are no stage of their own.
        desc.maps = ShadowMaps::Rendered;
        auto rendered = AreaLight::create(device(), desc).value();
        ASSERT_TRUE(prepare(rendered, smallRectangle()));
        EXPECT_EQ(rendered.times()[static_cast<std::size_t>(AreaLightStage::Maps)], 0.0);
    }
}

TEST_F(AreaLightLimitsGlTest, OverBudgetIsAnErrorBeforeAnyWork) {
    for (const ShadowMaps maps : {ShadowMaps::Imperfect, ShadowMaps::Rendered}) {
        AreaLightDesc desc = smallDesc();
        desc.maps = maps;
        std::uint64_t needed = 0;
        {
            auto effect = AreaLight::create(device(), desc).value();
            needed = prepare(effect, smallRectangle()).value().mapBytes + effect.gpuBytes();
        }
        auto effect = AreaLight::create(device(), desc).value();
        const std::uint64_t held = device().allocatedBytes();
        std::size_t refusals = 0;
        // Whatever piece it is that no longer fits.
        for (std::uint64_t budget = 1; budget < 2 * needed; budget += needed / 16 + 1) {
            device().setMemoryBudget(held + budget);
            const GlCalls calls(table());
            const auto made = prepare(effect, smallRectangle());
            if (made)
                break;
            ++refusals;
            EXPECT_EQ(made.error().code, ErrorCode::OutOfMemory);
            EXPECT_EQ(calls.work(), 0u) << made.error().text;
        }
        EXPECT_GT(refusals, 3u);
        device().setMemoryBudget(0);
        ASSERT_TRUE(prepare(effect, smallRectangle()));
        const auto before = airlight(effect);
        // More triangles than before: refused, and the last frame still stands.
        const auto large =
            MeshBuffers::upload(device(), reference::makeIcosphere({0, 1, 0}, 1.0f, 6)).value();
        const GeometrySource source = large.view();
        device().setMemoryBudget(device().allocatedBytes());
        if (maps == ShadowMaps::Imperfect) {
            EXPECT_EQ(
                effect.prepare(mScene->view(), smallRectangle(), {}, {&source, 1}).error().code,
                ErrorCode::OutOfMemory);
        }
        device().setMemoryBudget(0);
        EXPECT_TRUE(airlight(effect) == before);
        // The targets, too, are found before any work.
        auto other = AreaLight::create(device(), desc).value();
        ASSERT_TRUE(prepare(other, smallRectangle()));
        device().setMemoryBudget(device().allocatedBytes() + 1000);
        {
            const GlCalls calls(table());
            const auto refused = other.apply(mScene->view(), mScene->surfaces());
            ASSERT_FALSE(refused);
            EXPECT_EQ(refused.error().code, ErrorCode::OutOfMemory);
            EXPECT_EQ(calls.work(), 0u);
        }
        device().setMemoryBudget(0);
        EXPECT_TRUE(airlight(other) == before);
    }
}

TEST_F(AreaLightLimitsGlTest, BadInputOfPrepareIsRefusedAndNothingIsLost) {
    auto effect = AreaLight::create(device(), smallDesc()).value();
    ASSERT_TRUE(prepare(effect, smallRectangle()));
    const auto before = airlight(effect);
    const auto refuses = [&](const Result<AreaLightStats>& made, const char* text) {
        ASSERT_FALSE(made) << text;
        EXPECT_EQ(made.error().code, ErrorCode::InvalidArgument) << made.error().text;
        EXPECT_THAT(made.error().text, HasSubstr(text));
        EXPECT_TRUE(airlight(effect) == before) << text;
    };
    for (const float extinction : {kNanFloat, -0.1f, std::numeric_limits<float>::infinity()})
        refuses(prepare(effect, smallRectangle(), {extinction}), "extinction");
    for (const float albedo : {kNanFloat, -0.1f, 1.5f})
        refuses(prepare(effect, smallRectangle(), {0.1f, glm::vec3(0.5f, albedo, 0.5f)}), "albedo");
    for (const float g : {kNanFloat, -1.0f, 1.0f})
        refuses(prepare(effect, smallRectangle(), {0.1f, glm::vec3(1.0f), g}), "anisotropy");

    RectangleLight rectangle = smallRectangle();
    rectangle.edgeV = 2.0 * rectangle.edgeU;
    refuses(prepare(effect, rectangle), "area");
    rectangle = smallRectangle();
    rectangle.corner.y = kNan;
    refuses(prepare(effect, rectangle), "rectangle");
    rectangle = smallRectangle();
    rectangle.emission.radiance.y = kNanFloat;
    refuses(prepare(effect, rectangle), "radiance");
    rectangle = smallRectangle();
    rectangle.emission.texture = 54321;
    refuses(prepare(effect, rectangle), "2D texture");
    rectangle.emission.texture = makeTexture(GL_TEXTURE_2D_ARRAY, GL_RGBA8);
    refuses(prepare(effect, rectangle), "2D texture");
    for (const GLenum format : {GL_RGBA8UI, GL_R16I, GL_DEPTH_COMPONENT24, GL_DEPTH24_STENCIL8}) {
        rectangle.emission.texture = makeTexture(GL_TEXTURE_2D, format);
        refuses(prepare(effect, rectangle), "float or normalized colour format");
    }
    refuses(prepare(effect, DiskLight{{0, 3, 0}, {0, 1, 0}, 0.0}), "radius");
    refuses(prepare(effect, DiskLight{{0, 3, 0}, {0, 0, 0}, 1.0}), "normal");
    refuses(prepare(effect, SphereLight{{0, 3, 0}, kNan}), "radius");
    refuses(prepare(effect, EnvironmentLight{}), "luminances");
    refuses(prepare(effect, PointLight{{0, kNan, 0}}), "light");
    for (const double far : {1e20, 1e300})
        refuses(prepare(effect, PointLight{{far, 0, 0}}), "within 1e15 of the eye");
    refuses(prepare(effect, PointLight{{0, 3, 0}, glm::vec3(kNanFloat)}), "intensity");
    refuses(prepare(effect, SpotLight{{0, 3, 0}, {0, -1, 0}, 0.0}), "cone");
    refuses(prepare(effect, DirectionalLight{{0, 0, 0}}), "direction");

    const GeometrySource sources[] = {mBuffers->view()};
    View view = mScene->view();
    view.size = {0, 4};
    refuses(effect.prepare(view, smallRectangle(), {}, sources), "size");
    view = mScene->view();
    view.worldToClip[1][1] = kNan;
    refuses(effect.prepare(view, smallRectangle(), {}, sources), "");
    view.worldToClip = glm::dmat4(0.0);
    refuses(effect.prepare(view, smallRectangle(), {}, sources), "");
    view.worldToClip = glm::dmat4(1.0); // Orthographic.
    refuses(effect.prepare(view, smallRectangle(), {}, sources), "perspective");

    MeshView broken = mBuffers->view();
    broken.indexCount += 3;
    const GeometrySource bad[] = {mBuffers->view(), broken};
    refuses(effect.prepare(mScene->view(), smallRectangle(), {}, bad), "source 1");
    const std::vector<LightDepthMap> maps(20);
    refuses(
        effect.prepare(mScene->view(), smallRectangle(), {}, std::span<const LightDepthMap>(maps)),
        "depth map 0");
    refuses(effect.prepare(mScene->view(), smallRectangle(), {},
                           std::span<const LightDepthMap>(maps).first(19)),
            "a shadow map for each of 20");
}

TEST_F(AreaLightLimitsGlTest, BadInputOfApplyIsRefusedAndNothingIsLost) {
    auto effect = AreaLight::create(device(), smallDesc()).value();
    ASSERT_TRUE(prepare(effect, smallRectangle()));
    const auto before = airlight(effect);
    const auto refuses = [&](const SurfaceTextures& surfaces, GLuint target, const char* text) {
        const GlCalls calls(table());
        const auto done =
            target == 0 ? effect.apply(mScene->view(), surfaces) : Result<std::uint32_t>(0u);
        const auto into =
            target != 0 ? effect.apply(mScene->view(), surfaces, target) : Result<void>();
        ASSERT_FALSE(done && into) << text;
        const Error& error = done ? into.error() : done.error();
        EXPECT_EQ(error.code, ErrorCode::InvalidArgument);
        EXPECT_THAT(error.text, HasSubstr(text));
        EXPECT_EQ(calls.work(), 0u);
    };
    const SurfaceTextures good = mScene->surfaces();
    SurfaceTextures bad = good;
    for (const GLuint depth :
         {0u, 54321u, makeTexture(GL_TEXTURE_2D, GL_R32F, 30, 22),
          makeTexture(GL_TEXTURE_2D, GL_R32UI), makeTexture(GL_TEXTURE_2D_ARRAY, GL_R32F),
          makeTexture(GL_TEXTURE_2D_MULTISAMPLE, GL_R32F)}) {
        bad.depth = depth;
        refuses(bad, 0, "depths in a 2D texture of 31 x 22");
    }
    const GLuint integers = makeTexture(GL_TEXTURE_2D, GL_RGBA8UI);
    const GLuint small = makeTexture(GL_TEXTURE_2D, GL_RGBA8, 8, 8);
    const GLuint plain = makeTexture(GL_TEXTURE_2D, GL_RGBA16F);
    const std::pair<const char*, std::uint32_t SurfaceTextures::*> members[] = {
        {"normal", &SurfaceTextures::normal},
        {"albedo", &SurfaceTextures::albedo},
        {"color", &SurfaceTextures::color}};
    for (const auto& [what, member] : members) {
        for (const GLuint texture : {54321u, small, makeTexture(GL_TEXTURE_2D_ARRAY, GL_RGBA8)}) {
            bad = good;
            bad.*member = texture;
            refuses(bad, 0, what);
        }
        bad = good;
        bad.*member = integers;
        refuses(bad, 0, "float or normalized");
        bad.*member = plain;
        refuses(bad, plain, "none of the surfaces'");
    }
    refuses(good, good.depth, "none of the surfaces'");
    bad = good;
    bad.color = effect.apply(mScene->view(), good).value();
    refuses(bad, 0, "none of the surfaces'");
    refuses(good, 54321u, "target");
    refuses(good, small, "as target, found 8 x 8");
    refuses(good, integers, "float or normalized");
    refuses(good, makeTexture(GL_TEXTURE_2D, GL_DEPTH_COMPONENT24), "float or normalized");
    refuses(good, makeTexture(GL_TEXTURE_2D, GL_RGB9_E5), "colour-renderable");
    EXPECT_TRUE(mScene->read(effect.sums()[0]) == before);
    EXPECT_TRUE(airlight(effect) == before);
    for (const GLenum format : {GL_RGBA8, GL_R11F_G11F_B10F, GL_RGBA16F, GL_RG16})
        EXPECT_TRUE(effect.apply(mScene->view(), good, makeTexture(GL_TEXTURE_2D, format)));
}

TEST_F(AreaLightLimitsGlTest, LightsManyOpticalDepthsAwayShineNotAtAll) {
    RectangleLight behind;
    behind.corner = {1.0, 0.5, 15.0};
    behind.edgeU = {-2.0, 0.0, 0.0};
    behind.edgeV = {0.0, 1.0, 0.0};
    const std::pair<LightSource, float> cases[] = {
        {PointLight{{0, 1, 15}}, 10.0f},
        {PointLight{{0, 1, 105}}, 1.0f},
        {PointLight{{0, 1, 650}}, 0.15f},
        {PointLight{{1e4, 0, 0}}, 0.15f},
        {SpotLight{{0, 1, 15}, {0, 0, -1}, 0.5}, 10.0f},
        {behind, 10.0f},
        {PointLight{{1e4, 0, 0}}, 0.0f},
        {PointLight{{1e14, 0, 0}}, 0.0f},
    };
    for (const AirlightForm form : {AirlightForm::Weighted, AirlightForm::Factored}) {
        AreaLightDesc desc = smallDesc();
        desc.airlight = form;
        auto effect = AreaLight::create(device(), desc).value();
        for (const auto& [light, extinction] : cases) {
            SCOPED_TRACE(testing::Message()
                         << "light of kind " << light.index() << ", extinction " << extinction);
            const auto ready = prepare(effect, light, {extinction});
            ASSERT_TRUE(ready) << ready.error().text;
            const auto picture = effect.apply(mScene->view(), mScene->surfaces());
            ASSERT_TRUE(picture) << picture.error().text;
            const auto sums = effect.sums();
            for (const GLuint texture : {*picture, sums[0], sums[1]})
                for (const glm::vec4& texel : mScene->read(texture))
                    ASSERT_TRUE(std::isfinite(texel.x + texel.y + texel.z)) << texture;
            for (const glm::vec4& texel : mScene->read(sums[0]))
                ASSERT_NEAR(texel.x, 0.0f, 1e-6f);
        }
    }
}

TEST_F(AreaLightLimitsGlTest, TinyViewsAndFewLightsLoseNoLight) {
    struct Case {
        glm::uvec2 size;
        std::uint32_t lights;
        ShadowVolumeLayout layout;
    };
    // Too few pixels, lights or lights a volume for ninths of them.
    const Case cases[] = {{{1, 1}, 30, ShadowVolumeLayout::Tiled},
                          {{2, 5}, 30, ShadowVolumeLayout::Tiled},
                          {{5, 2}, 1, ShadowVolumeLayout::Tiled},
                          {{9, 7}, 8, ShadowVolumeLayout::Tiled},
                          {{9, 7}, 10, ShadowVolumeLayout::Separate}};
    for (const Case& test : cases) {
        SCOPED_TRACE(testing::Message() << test.size.x << " x " << test.size.y << " pixels, "
                                        << test.lights << " lights");
        const FogScene scene(gl(), mMesh, reference::frontEye(), test.size);
        AreaLightDesc desc = smallDesc();
        desc.virtualLights = test.lights;
        desc.layout = test.layout;
        const GeometrySource source = mBuffers->view();
        std::vector<glm::vec4> sums[3], pictures[3];
        for (const GatherMode gather :
             {GatherMode::Full, GatherMode::Interleaved, GatherMode::Quarter}) {
            desc.gather = gather;
            auto effect = AreaLight::create(device(), desc).value();
            ASSERT_TRUE(effect.prepare(scene.view(), smallRectangle(), {}, {&source, 1}));
            const auto picture = effect.apply(scene.view(), scene.surfaces());
            ASSERT_TRUE(picture) << picture.error().text;
            pictures[static_cast<int>(gather)] = scene.read(*picture);
            sums[static_cast<int>(gather)] = scene.read(effect.sums()[0]);
        }
        EXPECT_TRUE(sums[1] == sums[0]);
        EXPECT_EQ(sums[2].front(), sums[0].front());
        for (const auto& picture : pictures)
            for (const glm::vec4& texel : picture)
                EXPECT_TRUE(texel.x > 0.0f && std::isfinite(texel.x));
    }
}

} // namespace
} // namespace lamina
