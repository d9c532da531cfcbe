// What lamina/parity.glsl says of a sprite's surface: borders, distances, normals.

#include "gl/support/parity_query.hpp"

#include <reference/crossings.hpp>
#include <reference/shapes.hpp>

#include <glm/geometric.hpp>
#include <glm/gtc/matrix_transform.hpp>
#include <gmock/gmock.h>

#include <cmath>

namespace lamina {
namespace {

namespace ref = reference;
using test::BuiltSprite;
using test::kUnitBox;
using ParitySurfaceGlTest = test::ParityQueryGlTest;

TEST_F(ParitySurfaceGlTest, BorderPointsAreReportedAndTheRestIsRight) {
    const TriangleMesh ball = ref::makeIcosphere({0.1f, 0, 0}, 0.7f, 5);
    const auto transform = fitSprite(kUnitBox, {1, 1, 2}, 128).value();
    const BuiltSprite built(device(), ball, transform);
    const DepthSprite* sprites[] = {&built.sprite};
    const auto points = test::randomPoints(kUnitBox, 50000, 13);
    const auto classes =
        test::classify(device(), sprites, points, {.answer = PointAnswer::Classes});
    const double diagonal = test::diagonalOf(transform);
    std::size_t borders = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
        const double distance = glm::distance(glm::dvec3(points[i]), {0.1, 0, 0}) - 0.7;
        borders += classes[i] == 2 ? 1 : 0;
        if (classes[i] != 2) {
            // The icosphere's faces lie up to 4e-4 inside the ball.
            ASSERT_EQ(classes[i], distance < -2e-4 ? 1 : 0) << distance;
        } else {
            // The columns around lie within 1.5 diagonals of the point, and reach one along the
            // axis.
            ASSERT_LE(std::abs(distance), 2.6 * diagonal + 4e-4);
        }
        // Within half a column it is always the border.
        if (std::abs(distance) < 0.3 * diagonal) {
            ASSERT_EQ(classes[i], 2) << distance / diagonal;
        }
    }
    EXPECT_GT(borders, 1000u);
}

TEST_F(ParitySurfaceGlTest, CombinedBordersAreWhereTheyDecide) {
    // Two boxes that overlap in [0, 0.5]: their faces inside the other are no border of the union.
    const TriangleMesh box = ref::makeBox({-0.5f, -0.5f, -0.5f}, {0.5f, 0.5f, 0.5f});
    const BuiltSprite built(device(), box, fitSprite(box.bounds(), {0, 0, 1}, 64).value());
    auto set = SpriteSet::create(device()).value();
    const SpriteInstance instances[] = {
        {.sprite = &built.sprite},
        {.sprite = &built.sprite, .localToWorld = glm::translate(glm::dmat4(1.0), {0.5, 0, 0})}};
    ASSERT_TRUE(set.update(instances));
    const std::vector<glm::vec3> points = {{-0.5f, 0, 0}, {0.0f, 0, 0},   {0.5f, 0, 0},
                                           {1.0f, 0, 0},  {-0.25f, 0, 0}, {0.25f, 0, 0}};
    auto classifier = PointClassifier::create(device()).value();
    const auto of = [&](SpriteRule rule) {
        auto found =
            classifier.download(set, points, {.answer = PointAnswer::Classes, .rule = rule})
                .value();
        found.resize(points.size());
        return found;
    };
    using Bytes = std::vector<std::uint8_t>;
    EXPECT_EQ(of(SpriteRule::Union), (Bytes{2, 1, 1, 2, 1, 1}));
    EXPECT_EQ(of(SpriteRule::Intersection), (Bytes{0, 2, 2, 0, 0, 1}));
    EXPECT_EQ(of(SpriteRule::Difference), (Bytes{2, 2, 0, 0, 1, 0}));
    // The surfaces that bound a combination.
    const auto boundary = ask(set, points, R"(
vec4 ask(vec3 world) {
    uint mask = laminaParityMask(world);
    return vec4(laminaParityIsBoundary(mask, 2, 1, LAMINA_PARITY_UNION),
                laminaParityIsBoundary(mask, 2, 1, LAMINA_PARITY_INTERSECTION),
                laminaParityIsBoundary(mask, 2, 1, LAMINA_PARITY_DIFFERENCE), 0.0);
})");
    EXPECT_EQ(boundary[1], glm::vec4(0, 1, 1, 0)) << "on the second box's face, inside the first";
    EXPECT_EQ(boundary[3], glm::vec4(1, 0, 0, 0)) << "on its other face, outside the first";
}

// What caps are cut by: a clip shape's surface is part of the combination's where the other shape
// does not decide alone.
TEST_F(ParitySurfaceGlTest, CutFacesLieWhereTheyBoundTheCombination) {
    constexpr float kRadius = 0.6f;
    const glm::vec3 centers[] = {{-0.25f, 0.0f, 0.1f}, {0.2f, 0.15f, 0.0f}};
    const TriangleMesh ball = ref::makeIcosphere({0, 0, 0}, kRadius, 5);
    const auto transform = fitSprite(ball.bounds(), {0, 0, 1}, 256).value();
    const BuiltSprite built(device(), ball, transform);
    std::vector<SpriteInstance> instances;
    for (const glm::vec3& center : centers)
        instances.push_back({.sprite = &built.sprite,
                             .localToWorld = glm::translate(glm::dmat4(1.0), glm::dvec3(center))});
    auto set = SpriteSet::create(device()).value();
    ASSERT_TRUE(set.update(instances));
    const double diagonal = test::diagonalOf(transform);
    for (int shape = 0; shape < 2; ++shape) {
        std::vector<glm::vec3> points;
        std::vector<bool> isInOther;
        for (const glm::vec3& p : test::randomPoints(kUnitBox, 6000, 31)) {
            const glm::vec3 point = centers[shape] + kRadius * glm::normalize(p);
            const double away = glm::distance(point, centers[1 - shape]) - kRadius;
            if (std::abs(away) < diagonal)
                continue;
            points.push_back(point);
            isInOther.push_back(away < 0.0);
        }
        ASSERT_GT(points.size(), 5000u);
        const auto found = ask(set, points, "const int shape = " + std::to_string(shape) + R"(;
vec4 ask(vec3 world) {
    uint mask = laminaParityMask(world);
    return vec4(laminaParityIsBoundary(mask, 2, shape, LAMINA_PARITY_UNION),
                laminaParityIsBoundary(mask, 2, shape, LAMINA_PARITY_INTERSECTION),
                laminaParityIsBoundary(mask, 2, shape, LAMINA_PARITY_DIFFERENCE), 0.0);
})");
        for (std::size_t i = 0; i < points.size(); ++i) {
            const bool isIn = isInOther[i];
            // The first without the second: of the second's surface what lies in the first.
            ASSERT_EQ(found[i], glm::vec4(!isIn, isIn, shape == 0 ? !isIn : isIn, 0)) << i;
        }
    }
}

TEST_F(ParitySurfaceGlTest, DistancesAreThoseOfTheColumnsCrossings) {
    const float radii[] = {0.9f, 0.7f, 0.4f};
    const TriangleMesh shells = ref::makeNestedShells({0, 0, 0}, radii, 4);
    const auto transform = fitSprite(kUnitBox, {0.2, -0.4, 1}, 64).value();
    const BuiltSprite built(device(), shells, transform);
    auto set = SpriteSet::create(device()).value();
    const double scale = 2.5;
    const SpriteInstance instances[] = {
        {.sprite = &built.sprite, .localToWorld = glm::scale(glm::dmat4(1.0), glm::dvec3(scale))}};
    ASSERT_TRUE(set.update(instances));
    const auto points = test::randomPoints({{-2.6, -2.6, -2.6}, {2.6, 2.6, 2.6}}, 5000, 23);
    const auto found = ask(set, points, R"(
vec4 ask(vec3 world) {
    LaminaParityProbe probe = laminaParityProbe(0, world);
    return vec4(probe.before, probe.after, laminaParityDistance(0, world), probe.crossings);
})");
    const ref::ColumnCrossings columns(shells, transform);
    std::size_t compared = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
        const glm::dvec3 local = glm::dvec3(points[i]) / scale;
        const glm::dvec3 place = transform.worldToGrid(local);
        const glm::dvec2 edge = glm::abs(glm::dvec2(place) - glm::round(glm::dvec2(place)));
        const bool holds = place.x > 0 && place.y > 0 && place.x < transform.size().x &&
                           place.y < transform.size().y;
        if (!holds || std::min(edge.x, edge.y) < 1e-3)
            continue;
        const double depth = (transform.worldToColumn() * glm::dvec4(local, 1.0)).z;
        double before = 3e38, after = 3e38;
        int crossings = 0;
        for (const ref::Crossing& crossing : columns.at(glm::uvec2(place))) {
            const double away = scale * (crossing.depth - depth);
            crossings += away <= 0.0 ? 1 : 0;
            if (away <= 0.0)
                before = std::min(before, -away);
            else
                after = std::min(after, away);
        }
        if (std::min(before, after) < 1e-5)
            continue;
        ++compared;
        const bool isIn = depth >= transform.nearDepth() && depth <= transform.farDepth();
        EXPECT_NEAR(found[i].x, before, before < 1e38 ? 1e-5 : 1e33) << i;
        EXPECT_NEAR(found[i].y, after, after < 1e38 ? 1e-5 : 1e33) << i;
        EXPECT_EQ(found[i].w, isIn ? static_cast<float>(crossings) : 0.0f) << i;
        const double nearest = std::min(before, after);
        const double expected = isIn && crossings % 2 != 0 ? -nearest : nearest;
        EXPECT_NEAR(found[i].z, expected, nearest < 1e38 ? 1e-5 : 1e33) << i;
        if (HasFailure())
            return;
    }
    EXPECT_GT(compared, 3000u);
}

TEST_F(ParitySurfaceGlTest, CoincidentCrossingsBoundNothing) {
    const TriangleMesh boxes = ref::merged(ref::makeBox({-0.5f, -0.5f, -0.5f}, {0.5f, 0.5f, 0.0f}),
                                           ref::makeBox({-0.5f, -0.5f, 0.0f}, {0.5f, 0.5f, 0.5f}));
    const BuiltSprite built(device(), boxes, fitSprite(kUnitBox, {0, 0, 1}, 64).value());
    const DepthSprite* sprites[] = {&built.sprite};
    const SpriteSet set = test::spriteSet(device(), sprites);
    const std::vector<glm::vec3> points = {{0, 0, -0.1f}, {0, 0, 0.1f}, {0, 0, -0.75f}};
    const auto found = ask(set, points, R"(
vec4 ask(vec3 world) {
    LaminaParityProbe probe = laminaParityProbe(0, world);
    return vec4(probe.before, probe.after, laminaParityDistance(0, world), 0.0);
})");
    EXPECT_NEAR(found[0].x, 0.4, 1e-6);
    EXPECT_NEAR(found[0].y, 0.6, 1e-6);
    EXPECT_NEAR(found[0].z, -0.4, 1e-6);
    EXPECT_NEAR(found[1].z, -0.4, 1e-6);
    EXPECT_NEAR(found[2].z, 0.25, 1e-6);
}

TEST_F(ParitySurfaceGlTest, NormalsPointOutOfTheShape) {
    const TriangleMesh ball = ref::makeIcosphere({0, 0, 0}, 0.8f, 5);
    const BuiltSprite built(device(), ball, fitSprite(kUnitBox, {0.5, 1, 0.2}, 256).value());
    const DepthSprite* sprites[] = {&built.sprite};
    const SpriteSet set = test::spriteSet(device(), sprites);
    std::vector<glm::vec3> points;
    for (const glm::vec3& p : test::randomPoints(kUnitBox, 4000, 4))
        points.push_back(glm::normalize(p) * (0.8f + 0.02f * p.x));
    const auto normals = ask(
        set, points, "vec4 ask(vec3 world) { return vec4(laminaParityNormal(0, world), 0.0); }");
    const glm::dvec3 axis = glm::normalize(glm::dvec3(0.5, 1, 0.2));
    std::size_t compared = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
        const glm::dvec3 expected = glm::normalize(glm::dvec3(points[i]));
        // Near the silhouette, where columns end, there is no slope to see.
        if (std::abs(glm::dot(expected, axis)) < 0.35)
            continue;
        ++compared;
        EXPECT_GT(glm::dot(glm::dvec3(normals[i]), expected), 0.99) << i;
    }
    EXPECT_GT(compared, 2000u);
}

} // namespace
} // namespace lamina
