#pragma once

#include "gl/support/gl_test.hpp"

#include <lamina/gl/shaders.hpp>
#include <lamina/transmittance/transmittance.hpp>

#include <glm/vec4.hpp>

#include <span>
#include <string>
#include <vector>

namespace lamina::test {

/// What a leaf takes in most tests.
inline constexpr float kSigma = 0.25f;
/// exp2() and log2() of a few dozen leaves in single precision.
inline constexpr double kRounding = 2e-5;

/// A place to ask lamina/transmittance.glsl about.
struct ProbePoint {
    glm::dvec3 position{0.0};
    glm::dvec3 normal{0.0}; ///< Zero: unknown.
};

/// A test whose host has a compute shader of its own that includes lamina/transmittance.glsl.
class TransmittanceGlTest : public GlTest {
protected:
    /// Every class takes the same share of all colours.
    static TransmittanceSettings attenuating(float sigma) {
        TransmittanceSettings settings;
        settings.attenuation.fill(glm::vec3(sigma));
        return settings;
    }

    /// What [ED06] look up: one column, whole slices, no bias.
    static TransmittanceSettings plain(float sigma) {
        TransmittanceSettings settings = attenuating(sigma);
        settings.slices = SliceLookup::Sampled;
        settings.filterWidth = 0.0f;
        settings.opaqueFilterWidth = 0.0f;
        settings.depthBias = 0.0f;
        return settings;
    }

    /// T at points, by the host's shader.
    std::vector<glm::vec3> probe(Transmittance& transmittance, std::span<const ProbePoint> points) {
        constexpr std::uint32_t kBlock = 2, kUnit = 3;
        const GLuint program =
            buildProgram({{GL_COMPUTE_SHADER,
                           "#version 450 core\n" + transmittance.shaderDefines(kBlock, kUnit) +
                               shaderSource("lamina/transmittance.glsl").value() + R"(
layout(local_size_x = 64) in;
layout(std430, binding = 0) readonly buffer Points { vec4 points[]; };
layout(std430, binding = 1) buffer Results { vec4 results[]; };
void main() {
    uint i = gl_GlobalInvocationID.x;
    if (i < uint(results.length()))
        results[i] = vec4(laminaTransmittance(points[2u * i].xyz, points[2u * i + 1u].xyz), 1.0);
}
)"}});
        transmittance.bind(kBlock, kUnit);
        std::vector<glm::vec4> input;
        for (const ProbePoint& point : points) {
            input.emplace_back(glm::vec3(point.position), 0.0f);
            input.emplace_back(glm::vec3(point.normal), 0.0f);
        }
        std::vector<glm::vec4> output(points.size(), glm::vec4(-7.0f));
        runCompute(program, std::as_bytes(std::span(input)),
                   std::as_writable_bytes(std::span(output)),
                   static_cast<std::uint32_t>(points.size()));
        gl().DeleteProgram(program);
        std::vector<glm::vec3> results;
        for (const glm::vec4& value : output)
            results.emplace_back(value);
        return results;
    }
};

} // namespace lamina::test
