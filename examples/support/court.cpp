#include "court.hpp"

#include "shapes.hpp"

#include <array>
#include <initializer_list>

namespace example {
namespace {

void addBox(lamina::TriangleMesh& mesh, const glm::vec3& low, const glm::vec3& high) {
    const auto first = static_cast<std::uint32_t>(mesh.positions.size());
    for (unsigned i = 0; i < 8; ++i)
        mesh.positions.emplace_back((i & 1u) ? high.x : low.x, (i & 2u) ? high.y : low.y,
                                    (i & 4u) ? high.z : low.z);
    for (const glm::uvec3& t : std::initializer_list<glm::uvec3>{{0, 2, 1},
                                                                 {1, 2, 3},
                                                                 {4, 5, 6},
                                                                 {5, 7, 6},
                                                                 {0, 4, 2},
                                                                 {2, 4, 6},
                                                                 {1, 3, 5},
                                                                 {3, 7, 5},
                                                                 {0, 1, 4},
                                                                 {1, 5, 4},
                                                                 {2, 6, 3},
                                                                 {3, 6, 7}})
        mesh.triangles.push_back(t + first);
}

CourtThing vase(const glm::vec3& at, float size, const glm::vec3& albedo) {
    CourtThing thing{{}, albedo};
    const std::vector<glm::vec2> profile{{0.0f, 0.0f},  {0.28f, 0.0f}, {0.22f, 0.08f},
                                         {0.42f, 0.5f}, {0.40f, 0.7f}, {0.16f, 0.95f},
                                         {0.24f, 1.1f}, {0.0f, 1.05f}};
    addRevolved(thing.mesh, profile, 24, [&](const glm::vec3& p) { return at + size * p; });
    return thing;
}

CourtThing ball(const glm::vec3& at, float size, const glm::vec3& albedo) {
    CourtThing thing{{}, albedo};
    addRevolved(thing.mesh, ballProfile(1.0f, 12), 24,
                [&](const glm::vec3& p) { return at + size * p; });
    return thing;
}

} // namespace

std::vector<CourtThing> makeCourt() {
    std::vector<CourtThing> things;
    CourtThing court{{}, {0.72f, 0.66f, 0.56f}, false};
    addBox(court.mesh, {-9.0f, -0.5f, -7.0f}, {9.0f, 0.0f, 7.0f});
    things.push_back(court);
    CourtThing wall{{}, {0.62f, 0.52f, 0.44f}};
    addBox(wall.mesh, {-9.0f, 0.0f, -6.5f}, {-8.6f, 3.6f, 2.0f});
    things.push_back(wall);
    Random random(11);
    constexpr std::array<glm::vec3, 3> kClay{glm::vec3(0.70f, 0.36f, 0.22f),
                                             glm::vec3(0.46f, 0.50f, 0.52f),
                                             glm::vec3(0.68f, 0.60f, 0.30f)};
    for (int row = 0; row < 8; ++row)
        for (int column = 0; column < 9; ++column) {
            const float x = -7.6f + 1.9f * static_cast<float>(column) + random(-0.3f, 0.3f);
            const float z = -6.0f + 1.6f * static_cast<float>(row) + random(-0.3f, 0.3f);
            const glm::vec3& clay = kClay[static_cast<std::size_t>(row + column) % kClay.size()];
            const float size = random(0.5f, 0.9f);
            if ((row + column) % 2 == 0)
                things.push_back(vase({x, 0.0f, z}, size, clay));
            else
                things.push_back(ball({x, 0.4f * size, z}, 0.4f * size, clay));
        }
    return things;
}

} // namespace example
