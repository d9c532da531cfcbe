// lamina/parity_boxes.glsl: whole triangles and boxes, against every point in them.

#include "gl/support/parity_query.hpp"

#include <reference/shapes.hpp>

#include <gmock/gmock.h>

#include <glm/gtc/matrix_transform.hpp>

#include <limits>

namespace lamina {
namespace {

namespace ref = reference;
using test::BuiltSprite;
using test::kUnitBox;

const Box3 kAround{{-1.3, -1.3, -1.3}, {1.3, 1.3, 1.3}};
constexpr const char* kFile = "lamina/parity_boxes.glsl";
constexpr float kOutside = 0.0f;
constexpr float kInside = 1.0f;
constexpr float kBorder = 2.0f;

/// Corners of a triangle of that size from its first, as questions() has them, and the half size of
/// a box.
glm::vec3 firstEdge(float size) {
    return size * glm::vec3(1.0f, 0.25f, -0.5f);
}
glm::vec3 secondEdge(float size) {
    return size * glm::vec3(-0.25f, 0.75f, 0.5f);
}
std::string questions(float size) {
    return "const float size = " + std::to_string(size) + R"(;
vec4 ask(vec3 p) {
    vec3 b = p + size * vec3(1.0, 0.25, -0.5);
    vec3 c = p + size * vec3(-0.25, 0.75, 0.5);
    vec3 reach = vec3(0.5 * size);
    return vec4(laminaParityTriangle(0, p, b, c), laminaParityTriangle(1, p, b, c),
                laminaParityTriangleCombined(p, b, c, LAMINA_PARITY_DIFFERENCE),
                laminaParityBox(0, p - reach, p + reach));
})";
}

class ParityBoxesGlTest : public test::ParityQueryGlTest {
protected:
    /// What a set says of points, as laminaParityMask().
    void expectHolds(const SpriteSet& set, std::span<const glm::vec3> corners,
                     std::span<const glm::vec4> classes, float size);
};

void ParityBoxesGlTest::expectHolds(const SpriteSet& set, std::span<const glm::vec3> corners,
                                    std::span<const glm::vec4> classes, float size) {
    constexpr std::size_t kSamples = 24;
    const auto shares = test::randomPoints({{0, 0, 0}, {1, 1, 1}}, kSamples, 77);
    std::vector<glm::vec3> inTriangles, inBoxes;
    for (const glm::vec3& corner : corners)
        for (const glm::vec3& share : shares) {
            const bool isBeyond = share.x + share.y > 1.0f;
            const glm::vec2 weights = isBeyond ? 1.0f - glm::vec2(share) : glm::vec2(share);
            inTriangles.push_back(corner + weights.x * firstEdge(size) +
                                  weights.y * secondEdge(size));
            inBoxes.push_back(corner + (share - 0.5f) * size);
        }
    const auto ofTriangles = masks(set, inTriangles);
    const auto ofBoxes = masks(set, inBoxes);
    for (std::size_t i = 0; i < inTriangles.size(); ++i) {
        const glm::vec4& found = classes[i / kSamples];
        const glm::vec4 exact((ofTriangles[i] & 1u) != 0, (ofTriangles[i] & 2u) != 0,
                              ofTriangles[i] == 1, (ofBoxes[i] & 1u) != 0);
        for (int k = 0; k < 4; ++k) {
            if (found[k] != kBorder) {
                ASSERT_EQ(found[k], exact[k]) << "function " << k << ", size " << size << ", " << i;
            }
        }
    }
}

TEST_F(ParityBoxesGlTest, WhatIsDecidedHoldsForEveryPoint) {
    const float radii[] = {0.9f, 0.5f};
    const TriangleMesh shells = ref::makeNestedShells({0, 0, 0}, radii, 4);
    const TriangleMesh knot = ref::makeTorusKnot({0, 0, 0}, 0.55f, 0.25f, 2, 3, 128, 16);
    // Columns that are no multiple of a block's.
    const BuiltSprite first(device(), shells, fitSprite(kUnitBox, {0.2, 0.5, 1}, 203).value());
    const BuiltSprite second(device(), knot, fitSprite(kUnitBox, {0, 0, 1}, 153).value());
    glm::dmat4 placement = glm::translate(glm::dmat4(1.0), {0.2, -0.1, 0.3});
    placement = glm::rotate(placement, 0.7, glm::dvec3(1, 2, 3));
    auto set = SpriteSet::create(device()).value();
    const auto corners = test::randomPoints(kAround, 4000, 5);
    for (const bool inverted : {false, true}) {
        const SpriteInstance instances[] = {{.sprite = &first.sprite, .localToWorld = placement},
                                            {.sprite = &second.sprite, .inverted = inverted}};
        ASSERT_TRUE(set.update(instances));
        for (const float size : {0.002f, 0.02f, 0.1f, 0.6f}) {
            const auto classes = ask(set, corners, questions(size), kFile);
            expectHolds(set, corners, classes, size);
            if (size > 0.02f)
                continue;
            // Most of what is small is decided, both ways: the knot's loops cross each other's
            // columns, the outer shell hides the space within the inner one.
            for (int k = 0; k < 4; ++k) {
                const auto count = [&](float answer) {
                    return std::ranges::count_if(
                        classes, [&](const glm::vec4& found) { return found[k] == answer; });
                };
                EXPECT_LT(count(kBorder), 1600) << k << ", size " << size;
                EXPECT_GT(count(kInside), 30) << k << ", size " << size;
                EXPECT_GT(count(kOutside), 30) << k << ", size " << size;
            }
        }
    }
}

TEST_F(ParityBoxesGlTest, WhatCannotBeDecidedIsBorder) {
    const TriangleMesh box = ref::makeBox({-1, -1, -1}, {1, 1, 1});
    const BuiltSprite built(device(), box, fitSprite(box.bounds(), {0, 0, 1}, 130).value());
    // A row of columns has no block ranges.
    const BuiltSprite row(device(), box, GridTransform::box(kAround, {130, 1, 1}).value());
    const DepthSprite* sprites[] = {&built.sprite, &row.sprite};
    const SpriteSet set = test::spriteSet(device(), sprites);
    const float nan = std::numeric_limits<float>::quiet_NaN();
    const float huge = std::numeric_limits<float>::infinity();
    const std::vector<glm::vec3> corners = {{0, 0, 0},    {0, 0, 0.999f}, {0, 0, 3},
                                            {nan, 0, 0},  {0, 0, nan},    {0, nan, 0},
                                            {huge, 0, 0}, {-0.999f, 0, 0}};
    const auto small = ask(set, corners, questions(0.01f), kFile);
    const float expected[] = {kInside, kBorder, kOutside, kBorder, kBorder, kBorder};
    for (std::size_t i = 0; i < std::size(expected); ++i) {
        EXPECT_EQ(small[i][0], expected[i]) << i;
        EXPECT_EQ(small[i][3], expected[i]) << i;
    }
    EXPECT_NE(small[6][0], kInside);
    EXPECT_EQ(small[7][0], kBorder);
    EXPECT_EQ(small[0][1], kBorder) << "a row of columns";
    EXPECT_EQ(small[2][1], kOutside) << "beside the row";
    // Over more than four blocks, though all of it is inside.
    const auto large = ask(set, {corners.data(), 1}, questions(0.8f), kFile);
    EXPECT_EQ(large[0][0], kBorder);
    EXPECT_EQ(large[0][3], kBorder);
    // A sprite that the set does not have contains nothing.
    const auto none = SpriteSet::create(device()).value();
    const auto outside = ask(none, {corners.data(), 1},
                             "vec4 ask(vec3 p) { return vec4(laminaParityTriangle("
                             "0, p, p, p), laminaParityBox(0, p, p), 0.0, 0.0); }",
                             kFile);
    EXPECT_EQ(outside[0], glm::vec4(kOutside));
}

} // namespace
} // namespace lamina
