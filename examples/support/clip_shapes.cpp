#include "clip_shapes.hpp"

#include "shapes.hpp"

#include <glm/gtc/constants.hpp>

#include <cmath>
#include <vector>

namespace example {

lamina::TriangleMesh makeKnot(const glm::vec3& center, float size, float tubeRadius) {
    constexpr unsigned kSteps = 400;
    std::vector<glm::vec3> path;
    for (unsigned i = 0; i < kSteps; ++i) {
        const float t = glm::two_pi<float>() * static_cast<float>(i) / kSteps;
        const float ring = 1.0f + 0.45f * std::cos(3.0f * t);
        path.push_back(center + size * glm::vec3(ring * std::cos(2.0f * t),
                                                 ring * std::sin(2.0f * t),
                                                 0.6f * std::sin(3.0f * t)));
    }
    lamina::TriangleMesh mesh;
    addClosedTube(mesh, path, tubeRadius, 40);
    return mesh;
}

lamina::TriangleMesh makeWavyBall(const glm::vec3& center, float radius) {
    lamina::TriangleMesh mesh;
    addRevolved(mesh, ballProfile(1.0f, 160), 320, [&](const glm::vec3& p) {
        const float wave =
            0.10f * std::sin(9.0f * p.x) * std::sin(9.0f * p.y) * std::sin(9.0f * p.z);
        return center + radius * (1.0f + wave + 0.12f * noise(2.0f * p)) * p;
    });
    return mesh;
}

} // namespace example
