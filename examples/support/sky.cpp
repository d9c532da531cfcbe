#include "sky.hpp"

#include <glm/common.hpp>
#include <glm/exponential.hpp>
#include <glm/geometric.hpp>
#include <glm/gtc/constants.hpp>
#include <glm/vec2.hpp>

#include <cmath>

namespace example {

glm::vec3 sky(const glm::dvec3& direction) {
    const glm::dvec3 ray = glm::normalize(direction);
    if (ray.y < -0.02) {
        const glm::dvec2 ground = glm::dvec2(ray.x, ray.z) * (1.6 / -ray.y);
        const bool isDark =
            (static_cast<long>(std::floor(ground.x)) + static_cast<long>(std::floor(ground.y))) & 1;
        const glm::dvec3 tile =
            isDark ? glm::dvec3(0.07, 0.06, 0.08) : glm::dvec3(0.80, 0.72, 0.58);
        const double haze = glm::smoothstep(6.0, 50.0, glm::length(ground));
        return glm::mix(tile, glm::dvec3(0.62, 0.66, 0.70), haze);
    }
    const double height = glm::clamp(ray.y, 0.0, 1.0);
    glm::dvec3 light = glm::mix(glm::dvec3(0.85, 0.84, 0.80), glm::dvec3(0.13, 0.29, 0.62),
                                std::pow(height, 0.55));
    const double sun = glm::dot(ray, glm::normalize(glm::dvec3(0.55, 0.62, 0.56)));
    light += glm::dvec3(1.0, 0.85, 0.6) * (0.35 * std::pow(glm::max(sun, 0.0), 24.0));
    light += glm::dvec3(18.0, 16.0, 13.0) * glm::smoothstep(0.9975, 0.9985, sun);
    return light;
}

std::vector<glm::vec3> makeSkyTexels(std::uint32_t height) {
    constexpr int kSamples = 3;
    std::vector<glm::vec3> texels;
    texels.reserve(std::size_t{2} * height * height);
    for (std::uint32_t y = 0; y < height; ++y)
        for (std::uint32_t x = 0; x < 2 * height; ++x) {
            glm::vec3 sum(0.0f);
            for (int i = 0; i < kSamples * kSamples; ++i) {
                const double u = (x + (i % kSamples + 0.5) / kSamples) / (2.0 * height);
                const double v = (y + (i / kSamples + 0.5) / kSamples) / height;
                const double around = (u - 0.5) * glm::two_pi<double>();
                const double up = (v - 0.5) * glm::pi<double>();
                sum += sky({std::cos(up) * std::sin(around), std::sin(up),
                            -std::cos(up) * std::cos(around)});
            }
            texels.push_back(sum / static_cast<float>(kSamples * kSamples));
        }
    return texels;
}

} // namespace example
