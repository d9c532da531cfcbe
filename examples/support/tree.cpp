#include "tree.hpp"

#include "shapes.hpp"

#include <glm/geometric.hpp>

#include <array>
#include <cmath>
#include <utility>

namespace example {
namespace {

constexpr int kLevels = 5;

class Grower {
public:
    explicit Grower(const TreeDesc& desc)
        : mDesc(desc)
        , mRandom(desc.seed) {}

    /// A branch from `base`, and what grows from it. level: 0 is the trunk.
    void grow(const glm::vec3& base, const glm::vec3& direction, float length, float radius,
              int level);

    Tree tree;

private:
    [[nodiscard]] glm::vec3 randomVector(float size) {
        return {mRandom(-size, size), mRandom(-size, size), mRandom(-size, size)};
    }
    void addLeaf(const glm::vec3& stem, float size);

    TreeDesc mDesc;
    Random mRandom;
};

void Grower::addLeaf(const glm::vec3& stem, float size) {
    const glm::vec3 along = glm::normalize(randomVector(1.0f) + glm::vec3(0.0f, -0.25f, 0.0f));
    const glm::vec3 up = glm::normalize(randomVector(0.7f) + glm::vec3(0.0f, 1.0f, 0.0f));
    const glm::vec3 side = glm::normalize(glm::cross(along, up));
    const glm::vec3 fold = 0.12f * size * glm::cross(side, along);
    const glm::vec3 tip = stem + size * along;
    const glm::vec3 middle = stem + 0.45f * size * along + fold;
    addTriangle(tree.leaves, stem, tip, middle + 0.36f * size * side);
    addTriangle(tree.leaves, tip, stem, middle - 0.36f * size * side);
}

void Grower::grow(const glm::vec3& base, const glm::vec3& direction, float length, float radius,
                  int level) {
    constexpr std::size_t kPoints = 6;
    const float taper = level == 0 ? 0.62f : 0.5f;
    std::array<glm::vec3, kPoints> path;
    std::array<float, kPoints> radii{};
    glm::vec3 heading = direction;
    path[0] = base;
    for (std::size_t i = 0; i < kPoints; ++i) {
        const float t = static_cast<float>(i) / (kPoints - 1);
        radii[i] = radius * (1.0f - (1.0f - taper) * t) * (level == 0 && i == 0 ? 1.5f : 1.0f);
        if (i == 0)
            continue;
        path[i] = path[i - 1] + length / (kPoints - 1) * heading;
        heading = glm::normalize(heading + randomVector(0.13f) + glm::vec3(0.0f, 0.03f, 0.0f));
    }
    addTube(tree.wood, path, radii, level == 0 ? 40 : level == 1 ? 20 : 8);

    if (level + 2 >= kLevels)
        for (int i = 0; i < mDesc.leavesPerTwig; ++i) {
            const auto piece = static_cast<std::size_t>(mRandom(1.0f, kPoints - 0.001f));
            addLeaf(path[piece] + randomVector(0.16f), mRandom(0.65f, 1.0f) * mDesc.leafLength);
        }
    if (level + 1 == kLevels)
        return;
    const int children = level == 0 ? 6 : 4;
    const float start = mRandom(0.0f, 6.28f);
    for (int i = 0; i < children; ++i) {
        const float angle = start + 6.2832f * (static_cast<float>(i) + mRandom(-0.25f, 0.25f)) /
                                        static_cast<float>(children);
        const bool goesOn = i == 0 && level > 0;
        const float spread = goesOn ? 0.25f : mRandom(0.75f, 1.15f);
        const glm::vec3 helper =
            std::abs(heading.y) < 0.9f ? glm::vec3(0, 1, 0) : glm::vec3(1, 0, 0);
        const glm::vec3 side = glm::normalize(glm::cross(heading, helper));
        const glm::vec3 other = glm::cross(heading, side);
        const glm::vec3 turned =
            glm::normalize(heading + spread * (std::cos(angle) * side + std::sin(angle) * other));
        const std::size_t from =
            goesOn ? kPoints - 1 : static_cast<std::size_t>(mRandom(2.6f, 5.99f));
        grow(path[from], turned, length * mRandom(0.58f, 0.76f),
             0.55f * radii[from] / taper * taper, level + 1);
    }
}

} // namespace

Tree makeTree(const TreeDesc& desc) {
    Grower grower(desc);
    grower.grow({0.0f, -0.1f, 0.0f}, glm::normalize(glm::vec3(0.05f, 1.0f, 0.02f)), 2.6f, 0.26f, 0);
    return std::move(grower.tree);
}

} // namespace example
