// lamina/airlight.glsl without shadows equals numerical integration of single scattering, over
// distances, angles, densities, phase functions and kinds of emitters.

#include "gl/support/gl_test.hpp"

#include <lamina/gl/shaders.hpp>

#include <reference/fog.hpp>

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <random>

namespace lamina {
namespace {

constexpr const char* kProgram = R"(
layout(local_size_x = 64) in;
struct Case { vec4 point; vec4 axis; vec4 normal; vec4 medium; };
layout(std430, binding = 0) readonly buffer Cases { Case cases[]; };
layout(std430, binding = 1) buffer Results { float results[]; };
void main() {
    uint i = gl_GlobalInvocationID.x;
    if (i >= uint(cases.length()))
        return;
    vec3 axis = cases[i].axis.xyz;
    float along = dot(cases[i].point.xyz, axis);
    vec3 across = cases[i].point.xyz - along * axis;
    float apart = length(across);
    LaminaAirlightRay ray = laminaAirlightRay(cases[i].medium.x, cases[i].medium.y, axis, across / apart, along,
                                              apart, cases[i].axis.w, cases[i].normal.xyz, cases[i].normal.w, 0.0);
    results[i] = laminaAirlightUnshadowed(ray);
})";

struct Case {
    glm::vec4 point;  ///< From the eye.
    glm::vec4 axis;   ///< Unit vector to the light; its distance.
    glm::vec4 normal; ///< 1: Lambertian.
    glm::vec4 medium; ///< Extinction, anisotropy.
};

class AirlightGlTest : public test::GlTest {
protected:
    glm::dvec3 direction() {
        const double height = 2.0 * mUnit(mRandom) - 1.0;
        const double angle = 2.0 * std::numbers::pi * mUnit(mRandom);
        const double ring = std::sqrt(1.0 - height * height);
        return {ring * std::cos(angle), ring * std::sin(angle), height};
    }
    double logarithmic(double low, double high) {
        return low * std::pow(high / low, mUnit(mRandom));
    }

    std::mt19937 mRandom{9};
    std::uniform_real_distribution<double> mUnit{0.0, 1.0};
};

TEST_F(AirlightGlTest, EqualsNumericalIntegration) {
    const GLuint program = buildProgram(
        {{GL_COMPUTE_SHADER,
          "#version 450 core\n" + shaderSource("lamina/airlight.glsl").value() + kProgram}});
    constexpr std::size_t kCases = 6000;
    std::vector<Case> cases(kCases);
    for (std::size_t i = 0; i < kCases; ++i) {
        const bool isDirectional = i % 5 == 0;
        const glm::vec3 axis(direction());
        // Eye rays through all angles, and close by the light.
        glm::vec3 along(direction());
        if (i % 7 == 0)
            along = glm::normalize(axis + static_cast<float>(logarithmic(1e-3, 0.3)) * along);
        const double lightDistance = logarithmic(0.1, 20.0);
        cases[i].point = glm::vec4(static_cast<float>(logarithmic(0.02, 300.0)) * along, 0.0f);
        cases[i].axis = {glm::normalize(axis), isDirectional ? 0.0 : lightDistance};
        cases[i].normal = {glm::normalize(glm::vec3(direction())), i % 2 == 0 ? 1.0 : 0.0};
        const double anisotropies[] = {0.0, 0.3, 0.6, -0.3};
        cases[i].medium = {logarithmic(1e-3, 2.0), anisotropies[i % 4], 0.0, 0.0};
    }
    std::vector<float> results(kCases);
    runCompute(program, std::as_bytes(std::span(cases)), std::as_writable_bytes(std::span(results)),
               kCases);
    gl().DeleteProgram(program);

    double worst = 0.0;
    std::size_t compared = 0;
    for (std::size_t i = 0; i < kCases; ++i) {
        VirtualLight light;
        const bool isDirectional = cases[i].axis.w == 0.0f;
        light.light.kind = isDirectional ? LightKind::Directional : LightKind::Point;
        light.light.position = glm::dvec3(cases[i].axis) * static_cast<double>(cases[i].axis.w);
        light.light.direction = -glm::dvec3(cases[i].axis);
        if (cases[i].normal.w != 0.0f && !isDirectional)
            light.normal = glm::dvec3(cases[i].normal);
        Medium medium;
        medium.extinction = cases[i].medium.x;
        medium.anisotropy = cases[i].medium.y;
        const double expected = reference::marchFog(nullptr, light, medium, glm::dvec3(0.0),
                                                    glm::dvec3(cases[i].point), 4000)
                                    .unshadowed;
        // What is lost to 1e-9 of a light's strength at unit distance cannot be seen.
        if (expected < 1e-9)
            continue;
        ++compared;
        const double error = std::abs(static_cast<double>(results[i]) / expected - 1.0);
        worst = std::max(worst, error);
        EXPECT_LT(error, 5e-3) << i << ": " << results[i] << " instead of " << expected
                               << ", distance " << cases[i].axis.w << ", extinction "
                               << medium.extinction << ", g " << medium.anisotropy;
    }
    std::printf("%zu rays, worst relative error %.4f %%\n", compared, 100.0 * worst);
    EXPECT_GT(compared, kCases / 2);
}

} // namespace
} // namespace lamina
