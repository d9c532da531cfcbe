#include "tower.hpp"

#include "shapes.hpp"

#include <glm/gtc/constants.hpp>

#include <array>
#include <cmath>

namespace example {
namespace {

constexpr float kTurn = glm::two_pi<float>();
constexpr float kStorey = 2.0f;
constexpr int kStoreys = 3;
constexpr float kInner = 2.7f, kOuter = 3.0f;

struct Block {
    float innerRadius, outerRadius, low, high;
};

void addBlock(lamina::TriangleMesh& mesh, const Block& block, float from = 0.0f, float to = kTurn,
              const glm::vec3& where = {}) {
    const std::array<glm::vec2, 4> loop{glm::vec2(block.innerRadius, block.low),
                                        {block.outerRadius, block.low},
                                        {block.outerRadius, block.high},
                                        {block.innerRadius, block.high}};
    const auto segments = static_cast<unsigned>(
        std::ceil((to - from) / kTurn * (block.outerRadius > 0.5f ? 160 : 24)));
    addRevolvedLoop(mesh, loop, segments, from, to, [&](const glm::vec3& p) { return where + p; });
}

void addStorey(lamina::TriangleMesh& mesh, float low) {
    constexpr int kWindows = 10;
    constexpr int kColumns = 8;
    addBlock(mesh, {0.95f, kInner, low, low + 0.16f});
    addBlock(mesh, {kInner, kOuter, low, low + 0.6f});
    for (int i = 0; i < kWindows; ++i) {
        const float angle = kTurn * static_cast<float>(i) / kWindows;
        addBlock(mesh, {kInner, kOuter, low + 0.6f, low + 1.6f}, angle,
                 angle + 0.5f * kTurn / kWindows);
    }
    addBlock(mesh, {kInner, kOuter, low + 1.6f, low + kStorey});
    for (int i = 0; i < kColumns; ++i) {
        const float angle = kTurn * (static_cast<float>(i) + 0.5f) / kColumns;
        const glm::vec3 where(1.9f * std::cos(angle), 0.0f, 1.9f * std::sin(angle));
        addBlock(mesh, {0.0f, 0.15f, low + 0.16f, low + kStorey}, 0.0f, kTurn, where);
    }
}

void addStair(lamina::TriangleMesh& mesh, float top) {
    constexpr float kRise = 0.14f;
    constexpr float kTread = 0.32f;
    addBlock(mesh, {0.0f, 0.14f, 0.0f, top});
    for (int i = 0; static_cast<float>(i + 1) * kRise < top; ++i) {
        const float angle = kTread * static_cast<float>(i);
        const float low = kRise * static_cast<float>(i);
        addBlock(mesh, {0.14f, 0.85f, low, low + 0.1f}, angle, angle + kTread);
    }
}

void addDome(lamina::TriangleMesh& mesh, float low) {
    constexpr int kSteps = 24;
    std::vector<glm::vec2> loop;
    for (int i = 0; i <= kSteps; ++i) {
        const float angle = 0.25f * kTurn * static_cast<float>(i) / kSteps;
        loop.emplace_back(2.9f * std::cos(angle), low + 2.5f * std::sin(angle));
    }
    for (int i = kSteps; i >= 0; --i) {
        const float angle = 0.25f * kTurn * static_cast<float>(i) / kSteps;
        loop.emplace_back(2.65f * std::cos(angle), low + 2.25f * std::sin(angle));
    }
    addRevolvedLoop(mesh, loop, 160, 0.0f, kTurn, [](const glm::vec3& p) { return p; });
}

} // namespace

lamina::TriangleMesh makeTower() {
    lamina::TriangleMesh mesh;
    addBlock(mesh, {0.0f, 3.6f, -0.4f, 0.0f});
    for (int storey = 0; storey < kStoreys; ++storey)
        addStorey(mesh, kStorey * static_cast<float>(storey));
    const float top = kStorey * kStoreys;
    addStair(mesh, top + 0.2f);
    addBlock(mesh, {0.95f, 3.25f, top, top + 0.2f});
    addDome(mesh, top + 0.2f);
    return mesh;
}

} // namespace example
