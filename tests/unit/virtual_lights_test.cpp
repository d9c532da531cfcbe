// Virtual lights stand for their source: power, places, evenness, and density by luminance.

#include <lamina/area_light/virtual_lights.hpp>

#include <glm/geometric.hpp>

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace lamina {
namespace {

constexpr double kPi = std::numbers::pi;

std::vector<VirtualLight> lightsOf(const LightSource& source, std::uint32_t count) {
    auto lights = sampleVirtualLights(source, count);
    EXPECT_TRUE(lights) << lights.error().text;
    return lights ? *lights : std::vector<VirtualLight>();
}

double power(std::span<const VirtualLight> lights) {
    double sum = 0.0;
    for (const VirtualLight& light : lights)
        sum += static_cast<double>(light.intensity.x);
    return sum;
}

TEST(VirtualLights, PowerIsTheSources) {
    const RectangleLight rectangle{{1, 2, 3}, {2, 0, 0}, {0, 0, 3}, {}};
    const DiskLight disk{{0, 0, 0}, {0, 3, 0}, 2.0};
    const SphereLight sphere{{1, 0, 0}, 2.0};
    for (const std::uint32_t count : {1u, 7u, 256u}) {
        EXPECT_NEAR(power(lightsOf(rectangle, count)), 6.0, 1e-4);
        EXPECT_NEAR(power(lightsOf(disk, count)), 4.0 * kPi, 1e-4);
        EXPECT_NEAR(power(lightsOf(sphere, count)), 16.0 * kPi, 1e-3);
    }
    EXPECT_EQ(lightsOf(PointLight{}, 99).size(), 1u);
}

TEST(VirtualLights, LieOnTheSourceAndFaceOut) {
    const RectangleLight rectangle{{1, 2, 3}, {2, 0, 0}, {0, 1, 1}, {}};
    for (const VirtualLight& light : lightsOf(rectangle, 64)) {
        EXPECT_NEAR(glm::dot(light.light.position - rectangle.corner, light.normal), 0.0, 1e-12);
        EXPECT_NEAR(glm::length(light.normal), 1.0, 1e-12);
        EXPECT_LT(light.normal.y, 0.0); // u x v.
        EXPECT_NEAR(light.light.position.x,
                    1.0 + 2.0 * static_cast<double>(light.textureCoordinates.x), 1e-6);
    }
    const SphereLight sphere{{1, 0, 2}, 0.5};
    for (const VirtualLight& light : lightsOf(sphere, 64))
        EXPECT_NEAR(glm::distance(light.light.position, sphere.center + 0.5 * light.normal), 0.0,
                    1e-12);
    const DiskLight disk{{0, 1, 0}, {1, 1, 0}, 2.0};
    for (const VirtualLight& light : lightsOf(disk, 64)) {
        EXPECT_NEAR(glm::dot(light.light.position - disk.center, light.normal), 0.0, 1e-12);
        EXPECT_LE(glm::distance(light.light.position, disk.center), 2.0);
    }
}

TEST(VirtualLights, AreEvenlySpreadAlsoInRuns) {
    const RectangleLight unit{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {}};
    const auto lights = lightsOf(unit, 144);
    for (std::size_t run = 0; run < 9; ++run) {
        glm::dvec3 mean(0.0);
        for (std::size_t i = 0; i < 16; ++i)
            mean += lights[16 * run + i].light.position / 16.0;
        // Random points would stray by 0.07.
        EXPECT_NEAR(mean.x, 0.5, 0.06) << run;
        EXPECT_NEAR(mean.y, 0.5, 0.09) << run;
    }
}

TEST(VirtualLights, LuminancesPlaceThemAndTheirStrengthMakesUpForIt) {
    RectangleLight light{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {}};
    const std::vector<float> luminances{1.0f, 0.0f, 3.0f, 4.0f};
    light.emission.luminances = luminances;
    light.emission.luminanceSize = {2, 2};
    const auto lights = lightsOf(light, 1024);
    // Without a texture the luminances are what shines: their mean.
    EXPECT_NEAR(power(lights), 2.0, 0.01);
    std::size_t counts[4] = {};
    for (const VirtualLight& each : lights) {
        const std::size_t cell =
            (each.light.position.x < 0.5 ? 0u : 1u) + (each.light.position.y < 0.5 ? 0u : 2u);
        ++counts[cell];
    }
    EXPECT_NEAR(static_cast<double>(counts[0]), 128.0, 8.0);
    EXPECT_EQ(counts[1], 0u);
    EXPECT_NEAR(static_cast<double>(counts[2]), 384.0, 12.0);
    EXPECT_NEAR(static_cast<double>(counts[3]), 512.0, 12.0);
    // With one, the strength is what the density must be divided out of.
    light.emission.texture = 1;
    for (const VirtualLight& each : lightsOf(light, 256)) {
        const bool isLower = each.light.position.y < 0.5;
        const double luminance = isLower ? 1.0 : (each.light.position.x < 0.5 ? 3.0 : 4.0);
        EXPECT_NEAR(static_cast<double>(each.intensity.x), 2.0 / (256.0 * luminance), 1e-7);
        EXPECT_NEAR(static_cast<double>(each.textureShare), 2.0 / (256.0 * luminance), 1e-7);
    }
}

TEST(VirtualLights, AnEnvironmentIsIntegratedOverTheSphere) {
    EnvironmentLight sky;
    const std::vector<float> even(64 * 32, 1.0f);
    sky.emission.luminances = even;
    sky.emission.luminanceSize = {64, 32};
    const auto lights = lightsOf(sky, 512);
    EXPECT_NEAR(power(lights), 4.0 * kPi, 0.02);
    glm::dvec3 mean(0.0);
    for (const VirtualLight& light : lights) {
        EXPECT_EQ(light.light.kind, LightKind::Directional);
        EXPECT_NEAR(glm::length(light.light.direction), 1.0, 1e-9);
        mean += light.light.direction / 512.0;
    }
    EXPECT_LT(glm::length(mean), 0.02);
    // Light from the upper half goes down.
    std::vector<float> above(2, 0.0f);
    above[1] = 1.0f;
    sky.emission.luminances = above;
    sky.emission.luminanceSize = {1, 2};
    for (const VirtualLight& light : lightsOf(sky, 16))
        EXPECT_LT(light.light.direction.y, 0.0);
}

TEST(VirtualLights, UnsoundSourcesAreRefused) {
    const auto text = [](const LightSource& source, std::uint32_t count = 4) {
        const auto lights = sampleVirtualLights(source, count);
        return lights ? std::string() : lights.error().text;
    };
    EXPECT_NE(text(PointLight{}, 0).find("at least one"), std::string::npos);
    EXPECT_NE(text(RectangleLight{{}, {1, 0, 0}, {2, 0, 0}, {}}).find("some area"),
              std::string::npos);
    EXPECT_NE(text(DiskLight{{}, {}, 1.0}).find("normal"), std::string::npos);
    EXPECT_NE(text(PointLight{{}, glm::vec3(-1.0f)}).find("at least 0"), std::string::npos);
    EXPECT_NE(text(SphereLight{{}, -1.0}).find("radius"), std::string::npos);
    EXPECT_NE(text(EnvironmentLight{}).find("luminances"), std::string::npos);
    RectangleLight dark;
    const std::vector<float> zeros(4, 0.0f);
    dark.emission.luminances = zeros;
    dark.emission.luminanceSize = {2, 2};
    EXPECT_NE(text(dark).find("above 0"), std::string::npos);
    dark.emission.luminanceSize = {3, 2};
    EXPECT_NE(text(dark).find("3 x 2"), std::string::npos);
}

} // namespace
} // namespace lamina
