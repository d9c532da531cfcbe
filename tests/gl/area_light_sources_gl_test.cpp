// Lights of every shape: their virtual lights add up to the surfaces' exact irradiance, their
// shadows in fog agree with ray casting; textures that change, and virtual lights placed by
// luminance.

#include "gl/support/fog_test.hpp"

#include <reference/fog_errors.hpp>
#include <reference/shapes.hpp>

#include <algorithm>
#include <cstdio>
#include <functional>
#include <numbers>

namespace lamina {
namespace {

using reference::relativeRmse;
using test::FogScene;

constexpr double kPi = std::numbers::pi;

Medium fog() {
    return {0.12f, glm::vec3(0.9f), 0.2f};
}

/// Radiance of the sky towards a unit direction: brighter towards +x, and above.
double skyRadiance(const glm::dvec3& direction) {
    return 1.0 + 0.5 * direction.x + 0.3 * direction.y;
}

EnvironmentLight makeSky(std::vector<float>& luminances) {
    const glm::uvec2 size(64, 32);
    luminances.clear();
    for (std::uint32_t y = 0; y < size.y; ++y)
        for (std::uint32_t x = 0; x < size.x; ++x) {
            const double azimuth = 2.0 * kPi * (x + 0.5) / size.x;
            const double polar = kPi * (y + 0.5) / size.y;
            luminances.push_back(static_cast<float>(
                skyRadiance({std::sin(polar) * std::cos(azimuth), -std::cos(polar),
                             std::sin(polar) * std::sin(azimuth)})));
        }
    EnvironmentLight sky;
    sky.emission.luminances = luminances;
    sky.emission.luminanceSize = size;
    return sky;
}

class AreaLightSourcesGlTest : public test::FogTest {
protected:
    /// A 2D texture with mipmaps, of linear RGBA.
    GLuint makeTexture(const std::vector<glm::vec4>& texels, int side) {
        GLuint texture = 0;
        gl().CreateTextures(GL_TEXTURE_2D, 1, &texture);
        gl().TextureStorage2D(texture, static_cast<GLsizei>(std::log2(side)) + 1, GL_RGBA32F, side,
                              side);
        mTextures.push_back(texture);
        fill(texture, texels, side);
        return texture;
    }
    void fill(GLuint texture, const std::vector<glm::vec4>& texels, int side) {
        gl().TextureSubImage2D(texture, 0, 0, 0, side, side, GL_RGBA, GL_FLOAT, texels.data());
        gl().GenerateTextureMipmap(texture);
    }
    void TearDown() override {
        gl().DeleteTextures(static_cast<GLsizei>(mTextures.size()), mTextures.data());
        FogTest::TearDown();
    }

    const TriangleMesh mFence = reference::makeFenceScene();
    std::vector<GLuint> mTextures;
};

/// The integral of a function over the unit square, by midpoints.
double overSquare(const std::function<double(double, double)>& function) {
    constexpr int kSteps = 200;
    double sum = 0.0;
    for (int y = 0; y < kSteps; ++y)
        for (int x = 0; x < kSteps; ++x)
            sum += function((x + 0.5) / kSteps, (y + 0.5) / kSteps);
    return sum / (kSteps * kSteps);
}

/// What a piece of a Lambertian surface of unit radiance brings to a floor point, per area.
double formFactor(const glm::dvec3& from, const glm::dvec3& normal, const glm::dvec3& to) {
    const glm::dvec3 way = to - from;
    const double square = glm::dot(way, way);
    return std::max(0.0, glm::dot(normal, way)) * std::max(0.0, -way.y) / (square * square);
}

TEST_F(AreaLightSourcesGlTest, SurfacesGetTheExactIrradiance) {
    const TriangleMesh floor = reference::makePlane({0, 0, 0}, {0, 1, 0}, 8.0f);
    const FogScene scene(gl(), floor, reference::frontEye(), {24, 20});
    const DiskLight disk{{0.5, 2.0, -0.5}, {0.2, -1.0, 0.3}, 0.7, glm::vec3(3.0f)};
    const SphereLight sphere{{-0.5, 1.8, 0.3}, 0.5, glm::vec3(2.0f)};
    RectangleLight rectangle;
    rectangle.corner = {-1.5, 2.2, -2.0};
    rectangle.edgeU = {3.0, 0.0, 0.0};
    rectangle.edgeV = {0.0, 0.6, 0.8};
    std::vector<float> luminances;
    const EnvironmentLight sky = makeSky(luminances);
    const glm::dvec3 out = glm::normalize(disk.normal);
    const glm::dvec3 u = glm::normalize(glm::cross(out, glm::dvec3(0, 0, 1)));
    struct Case {
        const char* name;
        LightSource light;
        std::function<double(const glm::dvec3&)> irradiance;
    };
    const Case cases[] = {
        {"rectangle", rectangle,
         [&](const glm::dvec3& at) {
             const glm::dvec3 across = glm::cross(rectangle.edgeU, rectangle.edgeV);
             return glm::length(across) * overSquare([&](double s, double t) {
                        return formFactor(rectangle.corner + s * rectangle.edgeU +
                                              t * rectangle.edgeV,
                                          glm::normalize(across), at);
                    });
         }},
        {"disk", disk,
         [&](const glm::dvec3& at) {
             return 3.0 * kPi * disk.radius * disk.radius * overSquare([&](double s, double t) {
                        const double r = disk.radius * std::sqrt(s);
                        const double angle = 2.0 * kPi * t;
                        return formFactor(disk.center + r * (std::cos(angle) * u +
                                                             std::sin(angle) * glm::cross(out, u)),
                                          out, at);
                    });
         }},
        // A whole sphere above the horizon: as a disk of its projected size.
        {"sphere", sphere,
         [&](const glm::dvec3& at) {
             const glm::dvec3 way = sphere.center - at;
             const double distance = glm::length(way);
             return 2.0 * kPi * sphere.radius * sphere.radius * way.y /
                    (distance * distance * distance);
         }},
        // The integral of (1 + x / 2 + 3 y / 10) y over the upper hemisphere.
        {"sky", sky, [](const glm::dvec3&) { return kPi + 0.3 * 2.0 * kPi / 3.0; }}};
    AreaLightDesc desc;
    desc.virtualLights = 1024;
    desc.voxels = {16, 16, 32};
    desc.mapTexels = 8;
    desc.imperfect = {1024, 64, 0};
    for (const Case& test : cases) {
        auto effect = AreaLight::create(device(), desc).value();
        ASSERT_TRUE(effect.prepare(scene.view(), test.light, {0.0f, glm::vec3(1.0f), 0.0f},
                                   std::span<const GeometrySource>()));
        ASSERT_TRUE(effect.apply(scene.view(), scene.surfaces()));
        const auto gathered = sums(scene, effect, 1);
        std::vector<double> found, expected;
        for (std::size_t i = 0; i < scene.pixelCount(); i += 3) {
            if (scene.isSky(i) || scene.normal(i) == glm::dvec3(0.0))
                continue;
            found.push_back(gathered[i] * kPi); // Lambert's 1 / pi.
            expected.push_back(test.irradiance(scene.point(i)));
        }
        const double error = relativeRmse(found, expected);
        std::printf("%s: irradiance of %zu points %.3f %%\n", test.name, found.size(),
                    100.0 * error);
        EXPECT_GT(found.size(), 50u);
        // What 1024 points of Halton's sequence leave.
        EXPECT_LE(error, 0.01) << test.name;
    }
}

TEST_F(AreaLightSourcesGlTest, ShadowsInFogAgreeWithRayCasting) {
    const FogScene scene(gl(), mFence, reference::frontEye(), {16, 12});
    std::vector<float> luminances;
    const std::pair<const char*, LightSource> lights[] = {
        {"disk", DiskLight{{-5.6, 2.2, -0.5}, {1.0, -0.3, 0.1}, 0.6}},
        {"sphere", SphereLight{{-4.2, 1.4, 0.6}, 0.4}},
        {"sky", makeSky(luminances)}};
    AreaLightDesc desc;
    desc.virtualLights = 48;
    for (const auto& [name, light] : lights) {
        const auto virtualLights = sampleVirtualLights(light, desc.virtualLights).value();
        const auto marched = march(scene, virtualLights, fog(), 120);
        EXPECT_GT(marched.shadow(), 0.02);
        for (const ShadowMaps maps : {ShadowMaps::Rendered, ShadowMaps::Imperfect}) {
            desc.maps = maps;
            const auto effect = lit(desc, scene, mFence, light, fog());
            const auto gathered = sums(scene, effect);
            std::vector<double> found, expected;
            // Volumes end at the far plane, the sky's fog does not.
            for (std::size_t i = 0; i < scene.pixelCount(); ++i)
                if (!scene.isSky(i)) {
                    found.push_back(gathered[i]);
                    expected.push_back(marched.airlight[i]);
                }
            const double error = relativeRmse(found, expected);
            std::printf("%-7s %-9s %.2f %%, shadow %.1f %%\n", name,
                        maps == ShadowMaps::Rendered ? "rendered" : "imperfect", 100.0 * error,
                        100.0 * marched.shadow());
            EXPECT_LE(error, maps == ShadowMaps::Rendered ? 0.01 : 0.02) << name;
        }
    }
}

TEST_F(AreaLightSourcesGlTest, HostMapsServeAsShadowMaps) {
    // Maps that an engine would have drawn: distances by rays, a hemisphere each, tiled in a layer.
    constexpr int kSide = 128;
    const FogScene scene(gl(), mFence, reference::frontEye(), {16, 12});
    const DiskLight light{{-5.6, 2.2, -0.5}, {1.0, -0.3, 0.1}, 0.6};
    AreaLightDesc desc;
    desc.virtualLights = 6;
    const auto lights = sampleVirtualLights(light, desc.virtualLights).value();
    GLuint texture = 0;
    gl().CreateTextures(GL_TEXTURE_2D_ARRAY, 1, &texture);
    gl().TextureStorage3D(texture, 1, GL_R32F, 3 * kSide, 2 * kSide, 1);
    mTextures.push_back(texture);
    std::vector<LightDepthMap> maps;
    for (int i = 0; i < 6; ++i) {
        const VirtualLight& own = lights[static_cast<std::size_t>(i)];
        const glm::dvec3 s = glm::normalize(glm::cross(glm::dvec3(0, 1, 0), own.normal));
        const glm::dmat3 toWorld(s, glm::cross(own.normal, s), own.normal);
        LightDepthMap map;
        map.texture = texture;
        map.kind = DepthMapKind::HemisphereArray;
        map.firstTexel = {i % 3 * kSide, i / 3 * kSide};
        map.size = glm::uvec2(kSide);
        map.worldToHemisphere = glm::transpose(toWorld);
        map.emptyDepth = 0.0f;
        std::vector<float> distances;
        for (int y = 0; y < kSide; ++y)
            for (int x = 0; x < kSide; ++x) {
                const glm::dvec2 place = (glm::dvec2(x, y) + 0.5) * (2.0 / kSide) - 1.0;
                const glm::dvec2 st(0.5 * (place.x + place.y), 0.5 * (place.x - place.y));
                const double hit = scene.rays().firstHit(
                    own.light.position,
                    glm::normalize(toWorld *
                                   glm::dvec3(st, 1.0 - std::abs(st.x) - std::abs(st.y))));
                distances.push_back(std::isinf(hit) ? 0.0f : static_cast<float>(hit));
            }
        gl().TextureSubImage3D(texture, 0, static_cast<GLint>(map.firstTexel.x),
                               static_cast<GLint>(map.firstTexel.y), 0, kSide, kSide, 1, GL_RED,
                               GL_FLOAT, distances.data());
        maps.push_back(map);
    }
    auto effect = AreaLight::create(device(), desc).value();
    const auto stats =
        effect.prepare(scene.view(), light, fog(), std::span<const LightDepthMap>(maps));
    ASSERT_TRUE(stats) << stats.error().text;
    EXPECT_EQ(stats->shadowMaps, 0u);
    EXPECT_EQ(stats->mapBytes, 0u);
    ASSERT_TRUE(effect.apply(scene.view(), scene.surfaces()));
    const auto marched = march(scene, lights, fog(), 160);
    EXPECT_GT(marched.shadow(), 0.02);
    const double error = relativeRmse(sums(scene, effect), marched.airlight);
    std::printf("host maps: %.2f %%, shadow %.1f %%\n", 100.0 * error, 100.0 * marched.shadow());
    EXPECT_LE(error, 0.005);
    // Maps in another order are other lights' maps.
    std::swap(maps.front(), maps.back());
    ASSERT_TRUE(effect.prepare(scene.view(), light, fog(), std::span<const LightDepthMap>(maps)));
    ASSERT_TRUE(effect.apply(scene.view(), scene.surfaces()));
    EXPECT_GT(relativeRmse(sums(scene, effect), marched.airlight), error);
}

TEST_F(AreaLightSourcesGlTest, ATextureMayChangeFromFrameToFrame) {
    const FogScene scene(gl(), mFence, reference::frontEye(), {24, 20});
    RectangleLight light;
    light.corner = {-1.0, 2.6, -3.0};
    light.edgeU = {2.0, 0.0, 0.0};
    light.edgeV = {0.0, 1.0, 0.4};
    AreaLightDesc desc;
    desc.virtualLights = 36;
    desc.voxels = glm::uvec3(64);
    desc.mapTexels = 64;
    desc.imperfect.pointsPerMap = 2048;
    constexpr int kSide = 16;
    const auto plain = [&](const glm::vec4& color) {
        return std::vector<glm::vec4>(kSide * kSide, color);
    };
    const GLuint texture = makeTexture(plain(glm::vec4(1.0f)), kSide);
    auto effect = lit(desc, scene, mFence, light, fog());
    const auto white = scene.read(effect.sums()[0]);
    light.emission.texture = texture;
    // Films of one colour: every pixel's light has it.
    for (const glm::vec4& color :
         {glm::vec4(2.0f, 0.0f, 0.5f, 1.0f), glm::vec4(0.25f, 3.0f, 0.0f, 1.0f), glm::vec4(0.0f)}) {
        fill(texture, plain(color), kSide);
        draw(effect, scene, mFence, light, fog());
        const auto tinted = scene.read(effect.sums()[0]);
        for (std::size_t i = 0; i < white.size(); ++i)
            for (int channel = 0; channel < 3; ++channel)
                ASSERT_NEAR(tinted[i][channel], color[channel] * white[i][channel],
                            1e-5f * white[i][channel]);
    }
    // A film whose left half is dark is the right half alone.
    std::vector<glm::vec4> half = plain(glm::vec4(1.0f));
    for (int i = 0; i < kSide * kSide; ++i)
        half[static_cast<std::size_t>(i)] *= i % kSide < kSide / 2 ? 0.0f : 1.0f;
    fill(texture, half, kSide);
    desc.virtualLights = 256;
    const auto right = sums(scene, lit(desc, scene, mFence, light, fog()));
    light.emission.texture = 0;
    light.corner.x = 0.0;
    light.edgeU.x = 1.0;
    const auto alone = sums(scene, lit(desc, scene, mFence, light, fog()));
    const double error = relativeRmse(right, alone);
    std::printf("half a film against half a light: %.2f %%\n", 100.0 * error);
    // Lights along the border are grey.
    EXPECT_LE(error, 0.04);
}

TEST_F(AreaLightSourcesGlTest, PlacingLightsByLuminanceServesFewOfThemBetter) {
    const FogScene scene(gl(), mFence, reference::frontEye(), {14, 11});
    constexpr int kSide = 16;
    std::vector<glm::vec4> texels(kSide * kSide, glm::vec4(0.02f));
    std::vector<float> luminances;
    for (int y = 0; y < kSide; ++y)
        for (int x = 0; x < kSide; ++x) {
            const bool isBright = (x == 3 || x == 4) && (y == 10 || y == 11);
            texels[static_cast<std::size_t>(y * kSide + x)] *= isBright ? 2000.0f : 1.0f;
            luminances.push_back(texels[static_cast<std::size_t>(y * kSide + x)].x);
        }
    RectangleLight light;
    light.corner = {-1.6, 4.6, -3.0}; // Off the screen, where points are a likeness of it.
    light.edgeU = {3.2, 0.0, 0.0};
    light.edgeV = {0.0, 1.2, 0.5};
    light.emission.texture = makeTexture(texels, kSide);
    // The truth: a light for each texel.
    const glm::dvec3 across = glm::cross(light.edgeU, light.edgeV);
    std::vector<VirtualLight> exact;
    for (int y = 0; y < kSide; ++y)
        for (int x = 0; x < kSide; ++x) {
            VirtualLight part;
            part.light.position =
                light.corner + (x + 0.5) / kSide * light.edgeU + (y + 0.5) / kSide * light.edgeV;
            part.normal = glm::normalize(across);
            part.intensity = glm::vec3(texels[static_cast<std::size_t>(y * kSide + x)]) *
                             static_cast<float>(glm::length(across) / (kSide * kSide));
            exact.push_back(part);
        }
    const auto marched = march(scene, exact, fog(), 60);
    AreaLightDesc desc;
    desc.virtualLights = 16;
    desc.maps = ShadowMaps::Rendered;
    double errors[2] = {};
    for (const bool isPlaced : {false, true}) {
        if (isPlaced) {
            light.emission.luminances = luminances;
            light.emission.luminanceSize = glm::uvec2(kSide);
        }
        errors[isPlaced ? 1 : 0] =
            relativeRmse(sums(scene, lit(desc, scene, mFence, light, fog())), marched.airlight);
    }
    std::printf("16 lights on a film with a bright spot: %.1f %%, placed by luminance %.1f %%\n",
                100.0 * errors[0], 100.0 * errors[1]);
    EXPECT_LT(errors[1], 0.25 * errors[0]);
    EXPECT_LT(errors[1], 0.05);
}

} // namespace
} // namespace lamina
