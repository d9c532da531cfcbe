// Every call of lamina::area_light leaves the GL state as it found it, allocates no more after the
// first frame, works with every kind of light and source, and refuses bad input and full budgets.

#include "gl/support/fog_scene.hpp"
#include "gl/support/gl_state.hpp"
#include "gl/support/gl_test.hpp"

#include <reference/epipolar_agreement.hpp>

#include <gmock/gmock.h>

#include <cmath>

namespace lamina {
namespace {

using test::FogScene;
using test::OddGlState;
using test::smallDesc;
using test::smallRectangle;
using testing::HasSubstr;
using testing::Not;

class AreaLightContractGlTest : public test::GlTest {
protected:
    void SetUp() override {
        GlTest::SetUp();
        mScene.emplace(gl(), mMesh, reference::frontEye(), glm::uvec2(31, 22));
        mBuffers.emplace(MeshBuffers::upload(device(), mMesh).value());
        gl().CreateTextures(GL_TEXTURE_2D, 1, &mTexture);
        gl().TextureStorage2D(mTexture, 4, GL_RGBA32F, 8, 8);
        std::vector<glm::vec4> texels;
        for (int i = 0; i < 64; ++i)
            texels.emplace_back(i % 8 < 4 ? 0.0f : 2.0f, 1.0f, 0.5f, 1.0f);
        gl().TextureSubImage2D(mTexture, 0, 0, 0, 8, 8, GL_RGBA, GL_FLOAT, texels.data());
        gl().GenerateTextureMipmap(mTexture);
    }
    void TearDown() override {
        gl().DeleteTextures(1, &mTexture);
        mBuffers.reset();
        mScene.reset();
        GlTest::TearDown();
    }
    GeometrySource source() const { return mBuffers->view(); }
    Result<AreaLightStats> prepare(AreaLight& effect, const LightSource& light) {
        const GeometrySource sources[] = {source()};
        return effect.prepare(mScene->view(), light, {}, sources);
    }
    /// Sum of all airlight.
    glm::dvec3 airlight(AreaLight& effect) {
        const auto done = effect.apply(mScene->view(), mScene->surfaces());
        EXPECT_TRUE(done) << done.error().text;
        glm::dvec3 sum(0.0);
        for (const glm::vec4& texel : mScene->read(effect.sums()[0]))
            sum += glm::dvec3(texel);
        EXPECT_TRUE(std::isfinite(sum.x + sum.y + sum.z));
        return sum;
    }

    const TriangleMesh mMesh = reference::makeFenceScene();
    std::optional<FogScene> mScene;
    std::optional<MeshBuffers> mBuffers;
    GLuint mTexture = 0;
};

TEST_F(AreaLightContractGlTest, EveryCallRestoresTheState) {
    for (const ShadowMaps maps : {ShadowMaps::Imperfect, ShadowMaps::Rendered})
        for (const GatherMode gather :
             {GatherMode::Full, GatherMode::Interleaved, GatherMode::Quarter}) {
            AreaLightDesc desc = smallDesc();
            desc.maps = maps;
            desc.gather = gather;
            auto plain = AreaLight::create(device(), desc).value();
            ASSERT_TRUE(prepare(plain, smallRectangle(mTexture)));
            const glm::dvec3 expected = airlight(plain);
            std::optional<AreaLight> effect;
            {
                const OddGlState odd(gl());
                expectUnchanged("create",
                                [&] { effect.emplace(AreaLight::create(device(), desc).value()); });
                expectUnchanged("prepare", [&] {
                    const auto done = prepare(*effect, smallRectangle(mTexture));
                    ASSERT_TRUE(done) << done.error().text;
                });
                expectUnchanged("apply", [&] {
                    const auto done = effect->apply(mScene->view(), mScene->surfaces());
                    ASSERT_TRUE(done) << done.error().text;
                });
                expectUnchanged("times", [&] { (void)effect->times(); });
            }
            const glm::dvec3 found = airlight(*effect);
            EXPECT_NEAR(found.x, expected.x, 1e-5 * expected.x);
            EXPECT_GT(expected.x, 0.0);
            expectUnchanged("destruction", [&] { effect.reset(); });
        }
}

TEST_F(AreaLightContractGlTest, LaterFramesAllocateNothing) {
    auto effect = AreaLight::create(device(), smallDesc()).value();
    ASSERT_TRUE(prepare(effect, smallRectangle()));
    (void)airlight(effect);
    const std::uint64_t bytes = device().allocatedBytes();
    EXPECT_GT(effect.gpuBytes(), 0u);
    for (int frame = 0; frame < 3; ++frame) {
        RectangleLight moved = smallRectangle();
        moved.corner.x += 0.1 * frame;
        ASSERT_TRUE(prepare(effect, moved));
        (void)airlight(effect);
        EXPECT_EQ(device().allocatedBytes(), bytes);
    }
}

TEST_F(AreaLightContractGlTest, AFullBudgetIsAnErrorAndTheEffectSurvivesIt) {
    auto effect = AreaLight::create(device(), smallDesc()).value();
    device().setMemoryBudget(device().allocatedBytes() + 100000);
    const auto refused = prepare(effect, smallRectangle());
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().code, ErrorCode::OutOfMemory);
    EXPECT_FALSE(effect.apply(mScene->view(), mScene->surfaces()));
    device().setMemoryBudget(0);
    ASSERT_TRUE(prepare(effect, smallRectangle()));
    EXPECT_GT(airlight(effect).x, 0.0);
}

TEST_F(AreaLightContractGlTest, EveryLightShines) {
    const std::vector<float> sky{1.0f, 0.2f, 0.1f, 4.0f, 1.0f, 1.0f, 1.0f, 1.0f};
    EnvironmentLight environment;
    environment.emission.luminances = sky;
    environment.emission.luminanceSize = {4, 2};
    const LightSource lights[] = {PointLight{{0.5, 2.0, -2.0}},
                                  SpotLight{{0.5, 2.5, -2.0}, {0.0, -1.0, 0.3}},
                                  DirectionalLight{},
                                  smallRectangle(),
                                  DiskLight{{0.0, 3.0, -2.0}, {0.0, -1.0, 0.5}, 0.5},
                                  SphereLight{{0.0, 2.5, -2.0}, 0.3},
                                  environment};
    for (const LightSource& light : lights)
        for (const ShadowMaps maps : {ShadowMaps::Rendered, ShadowMaps::Imperfect}) {
            SCOPED_TRACE(light.index());
            AreaLightDesc desc = smallDesc();
            desc.maps = maps;
            auto effect = AreaLight::create(device(), desc).value();
            const auto unshadowed =
                effect.prepare(mScene->view(), light, {}, std::span<const GeometrySource>());
            ASSERT_TRUE(unshadowed) << unshadowed.error().text;
            const double open = airlight(effect).x;
            const auto done = prepare(effect, light);
            ASSERT_TRUE(done) << done.error().text;
            const double shadowed = airlight(effect).x;
            EXPECT_GT(shadowed, 0.0);
            EXPECT_LT(shadowed, open);
            EXPECT_GT(shadowed, 0.2 * open);
        }
}

TEST_F(AreaLightContractGlTest, TheTextureTintsTheLights) {
    auto effect = AreaLight::create(device(), smallDesc()).value();
    ASSERT_TRUE(prepare(effect, smallRectangle()));
    const glm::dvec3 white = airlight(effect);
    ASSERT_TRUE(prepare(effect, smallRectangle(mTexture)));
    const glm::dvec3 tinted = airlight(effect);
    EXPECT_NEAR(tinted.y, white.y, 1e-3 * white.y);
    EXPECT_NEAR(tinted.z, 0.5 * white.z, 1e-3 * white.z);
    // Red from the right half alone, twice as strong.
    EXPECT_NEAR(tinted.x, white.x, 0.4 * white.x);
    EXPECT_NE(tinted.x, white.x);
}

TEST_F(AreaLightContractGlTest, MisuseIsRefused) {
    const auto refuses = [&](AreaLightDesc desc, const char* text) {
        const auto made = AreaLight::create(device(), desc);
        ASSERT_FALSE(made) << text;
        EXPECT_EQ(made.error().code, ErrorCode::InvalidArgument);
        EXPECT_THAT(made.error().text, HasSubstr(text));
    };
    AreaLightDesc desc = smallDesc();
    desc.virtualLights = 1025;
    refuses(desc, "virtualLights in [1, 1024], found 1025");
    desc = smallDesc();
    desc.imperfect.pointsPerMap = 5000;
    refuses(desc, "pointsPerMap");
    desc = smallDesc();
    desc.bitsPerTexel = 64;
    refuses(desc, "bits per texel");
    for (const glm::uvec3& voxels :
         {glm::uvec3(32, 24, 0), glm::uvec3(0, 24, 32), glm::uvec3(2049, 24, 32),
          glm::uvec3(32, 16385, 32), glm::uvec3(32, 24, 65537), glm::uvec3(32, 24, 1u << 31u)}) {
        desc = smallDesc();
        desc.voxels = voxels;
        refuses(desc, "voxels in [1, 2048]");
    }
    desc = smallDesc();
    desc.imperfect.holeLevels = 14;
    refuses(desc, "holeLevels in [0, 13], found 14");
    desc = smallDesc();
    desc.gather = static_cast<GatherMode>(3);
    refuses(desc, "GatherMode, found 3");
    desc = smallDesc();
    desc.maps = static_cast<ShadowMaps>(3);
    refuses(desc, "ShadowMaps, found 3");
    desc = smallDesc();
    desc.airlight = static_cast<AirlightForm>(2);
    refuses(desc, "AirlightForm, found 2");
    desc = smallDesc();
    desc.layout = static_cast<ShadowVolumeLayout>(2);
    refuses(desc, "ShadowVolumeLayout, found 2");
    desc = smallDesc();
    desc.specularExponent = -1.0f;
    refuses(desc, "specularExponent in [0, infinity), found -1");
    desc = smallDesc();
    desc.specularStrength = -2.0f;
    refuses(desc, "specularStrength in [0, infinity), found -2");
    desc = smallDesc();
    desc.surfaceReflectance = "no GLSL";
    const auto broken = AreaLight::create(device(), desc);
    EXPECT_EQ(broken.error().code, ErrorCode::ShaderError);
    EXPECT_THAT(broken.error().text, HasSubstr("surfaceReflectance to compile"));
    EXPECT_THAT(broken.error().text, Not(HasSubstr("vertex stage")));
    EXPECT_FALSE(takeHighSeverityMessages().empty());

    auto effect = AreaLight::create(device(), smallDesc()).value();
    EXPECT_THAT(effect.apply(mScene->view(), mScene->surfaces()).error().text,
                HasSubstr("expected a prepare() before"));
    Medium medium;
    medium.anisotropy = 1.0f;
    const GeometrySource sources[] = {source()};
    EXPECT_THAT(effect.prepare(mScene->view(), smallRectangle(), medium, sources).error().text,
                HasSubstr("anisotropy"));
    EXPECT_THAT(prepare(effect, smallRectangle(12345)).error().text, HasSubstr("2D texture"));
    EXPECT_THAT(prepare(effect, PointLight{mScene->eye()}).error().text,
                HasSubstr("virtual light 0"));
    EXPECT_THAT(
        effect.prepare(mScene->view(), smallRectangle(), {}, std::span<const LightDepthMap>())
            .error()
            .text,
        HasSubstr("expected a shadow map for each of 20"));
    const GeometrySource bad[] = {MeshView{}};
    EXPECT_FALSE(effect.prepare(mScene->view(), smallRectangle(), {}, bad));

    ASSERT_TRUE(prepare(effect, smallRectangle()));
    SurfaceTextures surfaces = mScene->surfaces();
    surfaces.depth = mTexture;
    EXPECT_THAT(effect.apply(mScene->view(), surfaces).error().text, HasSubstr("31 x 22"));
    surfaces = mScene->surfaces();
    surfaces.albedo = mTexture;
    EXPECT_THAT(effect.apply(mScene->view(), surfaces).error().text, HasSubstr("albedo"));
    const FogScene other(gl(), mMesh, reference::makeEye({1, 2, 5}, {0, 0, 0}), {31, 22});
    EXPECT_THAT(effect.apply(other.view(), other.surfaces()).error().text,
                HasSubstr("from the viewpoint of prepare()"));
    EXPECT_FALSE(effect.apply(mScene->view(), mScene->surfaces(), 0));
    EXPECT_GT(airlight(effect).x, 0.0);
}

TEST_F(AreaLightContractGlTest, HostReflectanceAndTargetAreUsed) {
    AreaLightDesc desc = smallDesc();
    auto plain = AreaLight::create(device(), desc).value();
    desc.surfaceReflectance = "vec3 laminaSurfaceReflectance(vec3 normal, vec3 toLight, vec3 "
                              "toViewer) { return vec3(2.0, 0.0, 1.0) / 3.14159265; }";
    auto own = AreaLight::create(device(), desc).value();
    ASSERT_TRUE(prepare(plain, smallRectangle()));
    ASSERT_TRUE(prepare(own, smallRectangle()));
    (void)airlight(plain);
    (void)airlight(own);
    const auto a = mScene->read(plain.sums()[1]);
    const auto b = mScene->read(own.sums()[1]);
    for (std::size_t i = 0; i < a.size(); ++i) {
        ASSERT_NEAR(b[i].x, 2.0f * a[i].x, 1e-4f * a[i].x + 1e-9f);
        ASSERT_EQ(b[i].y, 0.0f);
    }
    GLuint target = 0;
    gl().CreateTextures(GL_TEXTURE_2D, 1, &target);
    gl().TextureStorage2D(target, 1, GL_RGBA32F, 31, 22);
    ASSERT_TRUE(plain.apply(mScene->view(), mScene->surfaces(), target));
    const auto direct = mScene->read(target);
    const auto returned = mScene->read(plain.apply(mScene->view(), mScene->surfaces()).value());
    for (std::size_t i = 0; i < direct.size(); ++i)
        ASSERT_NEAR(direct[i].x, returned[i].x, 2e-3f * direct[i].x + 1e-6f); // RGBA16F.
    gl().DeleteTextures(1, &target);
}

} // namespace
} // namespace lamina
