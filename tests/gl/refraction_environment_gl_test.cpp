// Surroundings of refracting bodies: from cube maps and pictures, blurred, across the faces' edges.

#include "gl/support/ball_frame.hpp"

#include <reference/shapes.hpp>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>

namespace lamina {
namespace {

namespace ref = reference;
using test::Ball;
using test::kRefractionModels;
using test::kSize;
using RefractionEnvironmentGlTest = test::BallFrameTest;

/// A host's cube map is taken face by face as OpenGL has it, and an equal equirectangular picture
/// gives the same.
TEST_F(RefractionEnvironmentGlTest, EnvironmentsOfCubeMapsAndOfPictures) {
    const auto light = [](const glm::vec3& d) {
        return glm::vec3(0.5f + 0.5f * d.x, 0.5f + 0.4f * d.y, 0.5f - 0.3f * d.z * d.x);
    };
    const Environment byCube = environmentOf(light, {.size = 32});
    constexpr unsigned kRows = 128;
    std::vector<glm::vec3> texels;
    for (unsigned y = 0; y < kRows; ++y)
        for (unsigned x = 0; x < 2 * kRows; ++x) {
            const double around = ((x + 0.5) / (2 * kRows) - 0.5) * 6.283185307;
            const double up = ((y + 0.5) / kRows - 0.5) * 3.141592654;
            texels.push_back(light(
                {std::cos(up) * std::sin(around), std::sin(up), -std::cos(up) * std::cos(around)}));
        }
    auto byPicture = Environment::create(device(), {.size = 32}).value();
    ASSERT_TRUE(byPicture.loadEquirectangular(
        texture(GL_RGB32F, GL_RGB, GL_FLOAT, texels, {2 * kRows, kRows}).id()));
    for (GLint level = 0; level < 3; ++level) {
        const std::size_t count = std::size_t{6} * (32u >> level) * (32u >> level);
        std::vector<glm::vec4> a(count), b(count);
        const auto bytes = static_cast<GLsizei>(count * sizeof(glm::vec4));
        gl().GetTextureImage(byCube.texture(), level, GL_RGBA, GL_FLOAT, bytes, a.data());
        gl().GetTextureImage(byPicture.texture(), level, GL_RGBA, GL_FLOAT, bytes, b.data());
        for (std::size_t i = 0; i < count; ++i)
            ASSERT_LT(glm::distance(a[i], b[i]), 0.01f) << level << ' ' << i;
        if (level != 0)
            continue;
        const std::size_t face = std::size_t{32} * 32;
        for (std::size_t i = 0; i < 6; ++i) {
            glm::vec3 direction(0.0f);
            direction[static_cast<int>(i / 2)] = i % 2 == 0 ? 1.0f : -1.0f;
            EXPECT_LT(glm::distance(glm::vec3(a[i * face + 16 * 32 + 16]), light(direction)),
                      0.05f);
        }
    }
}

/// Half of the surroundings is bright: beside the edge a body of the longer way inside shows it the
/// more blurred, as a Gaussian of the promised width blurs a straight edge.
TEST_F(RefractionEnvironmentGlTest, LongerWaysInsideSeeTheSurroundingsBlurred) {
    const Ball ball{{0, 0, 0}, 1.0};
    auto buffers = MeshBuffers::upload(device(), ref::makeIcosphere({0, 0, 0}, 1.0f, 5)).value();
    const GeometrySource source = buffers.view();
    const GBuffer drawn = draw({&ball, 1});
    const RefractionObject object{{&source, 1}, {&mClear, 1}, {glm::dvec3(-1), glm::dvec3(1)}};
    for (const auto filter : {EnvironmentFilter::Gaussian, EnvironmentFilter::MipPyramid}) {
        const Environment environment = environmentOf(
            [](const glm::vec3& d) { return glm::vec3(d.x > 0.0f ? 1.0f : 0.0f); }, {256, filter});
        for (const RefractionModel model : kRefractionModels) {
            Refraction refraction = create(model, environment);
            RefractionSettings settings;
            settings.refractiveIndex = 1.0f;
            settings.bodyBlur = 0.06f;
            ASSERT_TRUE(refraction.setSettings(settings));
            ASSERT_TRUE(refraction.prepare(object, mView));
            const auto pixels = read(refraction.apply(receiverOf(drawn)).value());
            double worst = 0.0;
            std::size_t between = 0;
            for (unsigned y = 0; y < kSize.y; ++y)
                for (unsigned x = 0; x < kSize.x; ++x) {
                    const auto hit = hitBalls({&ball, 1}, x, y);
                    if (!hit || hit->chord < 0.8)
                        continue;
                    const double sigma = settings.bodyBlur * hit->chord;
                    const double expected =
                        0.5 * std::erfc(-std::asin(ray(x, y).x) / sigma / std::sqrt(2.0));
                    const double found = pixels[std::size_t{y} * kSize.x + x].x;
                    worst = std::max(worst, std::abs(found - expected));
                    between += expected > 0.1 && expected < 0.9 ? 1 : 0;
                }
            EXPECT_GT(between, 200u);
            // A pyramid of squares is coarser, and stands still between its texels.
            EXPECT_LT(worst, filter == EnvironmentFilter::Gaussian ? 0.06 : 0.2)
                << static_cast<int>(model);
        }
    }
}

/// The host's setting of filtering across cube map edges changes nothing.
TEST_F(RefractionEnvironmentGlTest, FiltersAcrossEdgesWhateverTheHostHasSet) {
    const Ball ball{{0, 0, 0}, 1.0};
    auto buffers = MeshBuffers::upload(device(), ref::makeIcosphere({0, 0, 0}, 1.0f, 4)).value();
    const GeometrySource source = buffers.view();
    const GBuffer drawn = draw({&ball, 1});
    const RefractionObject object{{&source, 1}, {&mClear, 1}, {glm::dvec3(-1), glm::dvec3(1)}};
    std::vector<glm::vec4> pictures[2];
    for (const int isOn : {0, 1}) {
        (isOn ? gl().Enable : gl().Disable)(GL_TEXTURE_CUBE_MAP_SEAMLESS);
        // Every texel beside an edge is another colour than its neighbour across it.
        const Environment environment = environmentOf(
            [](const glm::vec3& d) {
                const glm::vec3 a = glm::abs(d);
                return glm::vec3(a.x >= a.y && a.x >= a.z, a.y >= a.x && a.y >= a.z, 0.5f);
            },
            {.size = 4});
        Refraction refraction = create(RefractionModel::VolumeIntegral, environment);
        RefractionSettings settings;
        settings.surfaceBlur = 0.2f;
        ASSERT_TRUE(refraction.setSettings(settings));
        ASSERT_TRUE(refraction.prepare(object, mView));
        pictures[isOn] = read(refraction.apply(receiverOf(drawn)).value());
        EXPECT_EQ(gl().IsEnabled(GL_TEXTURE_CUBE_MAP_SEAMLESS), isOn);
    }
    gl().Disable(GL_TEXTURE_CUBE_MAP_SEAMLESS);
    EXPECT_EQ(pictures[0], pictures[1]);
}

/// What the engine has drawn is seen bent through a ball, but nothing that stands before the ball,
/// and blurred through frosted glass.
TEST_F(RefractionEnvironmentGlTest, WhatTheEngineHasDrawnBehind) {
    const Ball ball{{0, 0, 0}, 1.0};
    auto buffers = MeshBuffers::upload(device(), ref::makeIcosphere({0, 0, 0}, 1.0f, 4)).value();
    const GeometrySource source = buffers.view();
    const GBuffer drawn = draw({&ball, 1});
    Material glass;
    glass.refractiveIndex = 1.5f;
    // Red at the left, blue at the right.
    constexpr unsigned kEdge = 26;
    std::vector<glm::vec4> colors;
    std::vector<float> before, behind;
    for (std::size_t i = 0; i < std::size_t{kSize.x} * kSize.y; ++i) {
        const bool isLeft = i % kSize.x < kEdge;
        colors.emplace_back(isLeft, 0.0f, !isLeft, 1.0f);
        before.push_back(isLeft ? 0.2f : 1.0f);
        behind.push_back(isLeft ? 0.999f : 1.0f);
    }
    const gl::Texture color = texture(GL_RGBA16F, GL_RGBA, GL_FLOAT, colors);
    const gl::Texture depths[] = {texture(GL_R32F, GL_RED, GL_FLOAT, before),
                                  texture(GL_R32F, GL_RED, GL_FLOAT, behind)};
    const Environment black =
        environmentOf([](const glm::vec3&) { return glm::vec3(0.0f); }, {.size = 4});
    // Pixels right of the edge that show mostly red.
    const auto countRed = [&](Refraction& refraction, GLuint colorDepth) {
        RefractionReceiver receiver = receiverOf(drawn);
        receiver.colorTexture = color.id();
        receiver.colorDepthTexture = colorDepth;
        const auto pixels = read(refraction.apply(receiver).value());
        std::size_t red = 0;
        for (std::size_t i = 0; i < pixels.size(); ++i)
            red += i % kSize.x >= kEdge && pixels[i].r > pixels[i].b ? 1 : 0;
        return red;
    };
    for (const RefractionModel model : kRefractionModels) {
        Refraction refraction = create(model, black);
        RefractionSettings settings;
        settings.reflection = 0.0f;
        settings.behindDistance = 4.0f;
        ASSERT_TRUE(refraction.setSettings(settings));
        ASSERT_TRUE(refraction.prepare({{&source, 1}, {&glass, 1}, {glm::dvec3(-1), glm::dvec3(1)}},
                                       mView));
        EXPECT_GT(countRed(refraction, 0), 5u) << static_cast<int>(model);
        EXPECT_GT(countRed(refraction, depths[1].id()), 5u) << static_cast<int>(model);
        EXPECT_EQ(countRed(refraction, depths[0].id()), 0u) << static_cast<int>(model);

        Refraction frosted = create(model, black);
        settings.refractiveIndex = 1.0f;
        ASSERT_TRUE(
            frosted.prepare({{&source, 1}, {&mClear, 1}, {glm::dvec3(-1), glm::dvec3(1)}}, mView));
        std::size_t mixed[2] = {};
        for (const int isBlurred : {0, 1}) {
            settings.surfaceBlur = isBlurred ? 0.2f : 0.0f;
            ASSERT_TRUE(frosted.setSettings(settings));
            RefractionReceiver receiver = receiverOf(drawn);
            receiver.colorTexture = color.id();
            for (const glm::vec4& pixel : read(frosted.apply(receiver).value()))
                mixed[isBlurred] += pixel.r > 0.1f && pixel.b > 0.1f ? 1 : 0;
        }
        // An edge of 30 pixels, one wide or some.
        EXPECT_LT(mixed[0], 70u) << static_cast<int>(model);
        EXPECT_GT(mixed[1], 2 * mixed[0] + 60) << static_cast<int>(model);
    }
}

} // namespace
} // namespace lamina
