#pragma once

#include <lamina/parity/point_classifier.hpp>
#include <lamina/parity/sprite_builder.hpp>
#include <lamina/parity/sprite_set.hpp>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include <cstdint>
#include <optional>
#include <random>
#include <span>
#include <vector>

namespace lamina::test {

/// Random points in a box.
inline std::vector<glm::vec3> randomPoints(const Box3& box, std::size_t count, std::uint32_t seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> unit(0.0, 1.0);
    std::vector<glm::vec3> points(count);
    for (glm::vec3& point : points) {
        const glm::dvec3 share(unit(random), unit(random), unit(random));
        point = glm::vec3(box.min + share * box.size());
    }
    return points;
}

/// A mesh as a sprite with as many layers as it needs; an error fails the test.
struct BuiltSprite {
    MeshBuffers buffers;
    DepthSprite sprite;
    SpriteReport report;

    BuiltSprite(const Device& device, const TriangleMesh& mesh, const GridTransform& transform,
                SpriteMethod method = SpriteMethod::SinglePass)
        : buffers(MeshBuffers::upload(device, mesh).value())
        , sprite(DepthSprite::create(device).value()) {
        auto builder = SpriteBuilder::create(device).value();
        const GeometrySource source = buffers.view();
        const auto built = builder.buildAndWait({&source, 1}, transform, sprite, method);
        EXPECT_TRUE(built) << built.error().text;
        if (built)
            report = *built;
    }
};

/// A set of sprites where they were built.
inline SpriteSet spriteSet(const Device& device, std::span<const DepthSprite* const> sprites) {
    auto set = SpriteSet::create(device).value();
    std::vector<SpriteInstance> instances;
    for (const DepthSprite* sprite : sprites)
        instances.push_back({.sprite = sprite});
    EXPECT_TRUE(set.update(instances));
    return set;
}

/// The answers to points by sprites where they were built; an error fails the test.
inline std::vector<std::uint8_t> classify(const Device& device,
                                          std::span<const DepthSprite* const> sprites,
                                          std::span<const glm::vec3> points,
                                          const PointQuery& query = {}) {
    const SpriteSet set = spriteSet(device, sprites);
    auto answers = PointClassifier::create(device).value().download(set, points, query);
    EXPECT_TRUE(answers) << answers.error().text;
    return answers ? *answers : std::vector<std::uint8_t>(points.size());
}

/// Indices of the points that are answered wrongly.
inline std::vector<std::size_t> wrongOnes(std::span<const std::uint8_t> answers,
                                          std::span<const char> expected) {
    std::vector<std::size_t> wrong;
    for (std::size_t i = 0; i < expected.size(); ++i)
        if ((answers[i] != 0) != (expected[i] != 0))
            wrong.push_back(i);
    return wrong;
}

/// Length of a column's diagonal in the world.
inline double diagonalOf(const GridTransform& transform) {
    return glm::distance(transform.gridToWorld({0, 0, 0}), transform.gridToWorld({1, 1, 0}));
}

} // namespace lamina::test
