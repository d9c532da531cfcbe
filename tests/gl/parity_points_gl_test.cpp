// PointClassifier: batches of points, their answers, and what it refuses.

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
using testing::HasSubstr;

using ParityPointsGlTest = test::ParityQueryGlTest;

TEST_F(ParityPointsGlTest, RulesAndFormatsAgreeWithMasks) {
    const TriangleMesh ball = ref::makeIcosphere({0, 0, 0}, 0.6f, 3);
    const BuiltSprite built(device(), ball, fitSprite(ball.bounds(), {0, 1, 0}, 100).value());
    std::vector<SpriteInstance> instances;
    for (const double x : {-0.3, 0.0, 0.3})
        instances.push_back({.sprite = &built.sprite,
                             .localToWorld = glm::translate(glm::dmat4(1.0), {x, 0.1, 0})});
    auto set = SpriteSet::create(device()).value();
    ASSERT_TRUE(set.update(instances));
    auto classifier = PointClassifier::create(device()).value();
    const auto all = test::randomPoints(kUnitBox, 1000, 9);
    for (const std::size_t count : {1u, 3u, 4u, 31u, 32u, 33u, 127u, 1000u}) {
        const std::span points(all.data(), count);
        const auto mask = masks(set, points);
        for (const SpriteRule rule :
             {SpriteRule::Union, SpriteRule::Intersection, SpriteRule::Difference}) {
            const auto bytes =
                classifier.download(set, points, {.answer = PointAnswer::Bytes, .rule = rule})
                    .value();
            const auto bits =
                classifier.download(set, points, {.answer = PointAnswer::Bits, .rule = rule})
                    .value();
            ASSERT_EQ(bytes.size(), (count + 3) / 4 * 4);
            ASSERT_EQ(bits.size(), (count + 31) / 32 * 4);
            for (std::size_t i = 0; i < count; ++i) {
                const bool expected = rule == SpriteRule::Union          ? mask[i] != 0
                                      : rule == SpriteRule::Intersection ? mask[i] == 7
                                                                         : mask[i] == 1;
                ASSERT_EQ(bytes[i], expected ? 1 : 0) << i;
                ASSERT_EQ((bits[i / 8] >> (i % 8) & 1) != 0, expected) << i;
            }
            for (std::size_t i = count; i < bits.size() * 8; ++i)
                ASSERT_EQ(bits[i / 8] >> (i % 8) & 1, 0) << "past the last point";
        }
    }
    EXPECT_TRUE(classifier.download(set, {}, {}).value().empty());
}

TEST_F(ParityPointsGlTest, PointsOfTheHostsBuffersAreReadInPlace) {
    const TriangleMesh ball = ref::makeIcosphere({0, 0, 0}, 0.8f, 3);
    const BuiltSprite built(device(), ball, fitSprite(ball.bounds(), {0, 0, 1}, 100).value());
    const DepthSprite* sprites[] = {&built.sprite};
    const SpriteSet set = test::spriteSet(device(), sprites);
    const auto points = test::randomPoints(kUnitBox, 500, 2);
    auto classifier = PointClassifier::create(device()).value();
    const auto expected = classifier.download(set, points, {.answer = PointAnswer::Bits}).value();
    // Particles of 28 bytes, from byte 20 on; answers from byte 12 on between sentinels.
    std::vector<std::uint32_t> particles(5 + 7 * points.size(), 0xffffffffu);
    for (std::size_t i = 0; i < points.size(); ++i)
        std::memcpy(particles.data() + 5 + 7 * i, &points[i], sizeof points[i]);
    std::vector<std::uint32_t> answers(3 + 16 + 1, 0xabababab);
    GLuint buffers[2];
    gl().CreateBuffers(2, buffers);
    gl().NamedBufferData(buffers[0], static_cast<GLsizeiptr>(particles.size() * 4 - 16),
                         particles.data(), GL_STATIC_DRAW);
    gl().NamedBufferData(buffers[1], static_cast<GLsizeiptr>(answers.size() * 4), answers.data(),
                         GL_STATIC_DRAW);
    PointBuffer input{.buffer = buffers[0], .offsetBytes = 20, .strideBytes = 28, .count = 500};
    ASSERT_TRUE(classifier.classify(set, input, {.answer = PointAnswer::Bits}, buffers[1], 12));
    gl().MemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
    gl().GetNamedBufferSubData(buffers[1], 0, static_cast<GLsizeiptr>(answers.size() * 4),
                               answers.data());
    EXPECT_EQ(std::memcmp(answers.data() + 3, expected.data(), 64), 0);
    EXPECT_EQ(answers[2], 0xababababu);
    EXPECT_EQ(answers[19], 0xababababu);

    const auto errorOf = [&](const PointBuffer& from, std::uint64_t offset, PointQuery query = {}) {
        const auto done = classifier.classify(set, from, query, buffers[1], offset);
        EXPECT_FALSE(done);
        return done ? std::string() : done.error().text;
    };
    EXPECT_THAT(errorOf({.buffer = 0, .count = 1}, 0),
                HasSubstr("GL buffers of points and answers"));
    EXPECT_THAT(errorOf({.buffer = buffers[0], .strideBytes = 8, .count = 1}, 0),
                HasSubstr("stride 8"));
    EXPECT_THAT(errorOf({.buffer = buffers[0], .count = 1}, 2), HasSubstr("answer offset 2"));
    input.count = 501;
    EXPECT_THAT(errorOf(input, 0), HasSubstr("a buffer that holds 501 points"));
    input.count = 500;
    EXPECT_THAT(errorOf(input, 0, {.answer = PointAnswer::Masks}),
                HasSubstr("2000 bytes for the answers"));
    EXPECT_THAT(errorOf(input, 0, {.directions = 2}),
                HasSubstr("found 2 directions and 1 sprites"));
    EXPECT_THAT(errorOf(input, 0, {.answer = PointAnswer::Classes, .directions = 1}),
                HasSubstr("no classes with them"));
    EXPECT_THAT(errorOf(input, 0, {.answer = static_cast<PointAnswer>(9)}),
                HasSubstr("expected a value of PointAnswer, found 9"));
    EXPECT_THAT(errorOf(input, 0, {.rule = static_cast<SpriteRule>(9)}),
                HasSubstr("expected a value of SpriteRule, found 9"));
    EXPECT_EQ(classifier.download(set, points, {.rule = static_cast<SpriteRule>(9)}).error().code,
              ErrorCode::InvalidArgument);
    device().setMemoryBudget(device().allocatedBytes() + 1000);
    EXPECT_THAT(classifier.download(set, points).error().text, HasSubstr("use fewer points"));
    device().setMemoryBudget(0);
    gl().DeleteBuffers(2, buffers);
}

TEST_F(ParityPointsGlTest, AMillionPointsInOneCallAtOddOffsets) {
    constexpr std::size_t kPoints = 1000003;
    const TriangleMesh ball = ref::makeIcosphere({0, 0, 0}, 0.8f, 3);
    const BuiltSprite built(device(), ball, fitSprite(ball.bounds(), {0, 0, 1}, 200).value());
    const DepthSprite* sprites[] = {&built.sprite};
    const SpriteSet set = test::spriteSet(device(), sprites);
    const SpriteLayers host = built.sprite.download().value();
    const auto points = test::randomPoints(kUnitBox, kPoints, 19);
    // 20 bytes from one to the next, from byte 4 on; the last one ends the buffer.
    std::vector<float> words(1 + 5 * (kPoints - 1) + 3, std::numeric_limits<float>::quiet_NaN());
    for (std::size_t i = 0; i < kPoints; ++i)
        std::memcpy(words.data() + 1 + 5 * i, &points[i], sizeof points[i]);
    const std::size_t bytes = PointClassifier::answerBytes(PointAnswer::Bytes, kPoints);
    std::vector<std::uint8_t> answers(bytes + 8, 0xab);
    GLuint buffers[2];
    gl().CreateBuffers(2, buffers);
    gl().NamedBufferStorage(buffers[0], static_cast<GLsizeiptr>(4 * words.size()), words.data(), 0);
    gl().NamedBufferStorage(buffers[1], static_cast<GLsizeiptr>(answers.size()), answers.data(), 0);
    auto classifier = PointClassifier::create(device()).value();
    const PointBuffer input{
        .buffer = buffers[0], .offsetBytes = 4, .strideBytes = 20, .count = kPoints};
    ASSERT_TRUE(classifier.classify(set, input, {}, buffers[1], 4));
    gl().MemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
    gl().GetNamedBufferSubData(buffers[1], 0, static_cast<GLsizeiptr>(answers.size()),
                               answers.data());
    gl().DeleteBuffers(2, buffers);
    std::size_t wrong = 0;
    for (std::size_t i = 0; i < kPoints; ++i)
        wrong += answers[4 + i] != (host.inside(points[i]) ? 1 : 0) ? 1 : 0;
    EXPECT_LE(wrong, kPoints / 2000) << "shaders place a point in single precision";
    EXPECT_EQ(answers[4 + kPoints], 0) << "past the last point";
    for (const std::size_t i : {std::size_t{0}, std::size_t{3}, bytes + 4, bytes + 7})
        EXPECT_EQ(answers[i], 0xab) << "not ours";
}

TEST_F(ParityPointsGlTest, PointsFartherThanABindingReachesAreAskedInTurn) {
    GLint64 reach = 0;
    gl().GetInteger64v(GL_MAX_SHADER_STORAGE_BLOCK_SIZE, &reach);
    constexpr std::uint32_t kStride = 1u << 16u;
    const auto count = static_cast<std::size_t>(reach / kStride) + 70;
    if (reach > GLint64{1} << 28u)
        GTEST_SKIP() << "a buffer of " << reach << " bytes is too much for a test";
    const TriangleMesh box = ref::makeBox({-0.5f, -0.5f, -0.5f}, {0.5f, 0.5f, 0.5f});
    const BuiltSprite built(device(), box, fitSprite(box.bounds(), {0, 0, 1}, 64).value());
    const DepthSprite* sprites[] = {&built.sprite};
    const SpriteSet set = test::spriteSet(device(), sprites);
    auto classifier = PointClassifier::create(device()).value();
    const auto points = test::randomPoints({{-0.8, -0.8, -0.8}, {0.8, 0.8, 0.8}}, count, 29);
    GLuint buffers[2];
    gl().CreateBuffers(2, buffers);
    gl().NamedBufferStorage(buffers[0], static_cast<GLsizeiptr>(kStride * count), nullptr,
                            GL_DYNAMIC_STORAGE_BIT);
    for (std::size_t i = 0; i < count; ++i)
        gl().NamedBufferSubData(buffers[0], static_cast<GLintptr>(kStride * i), sizeof points[i],
                                &points[i]);
    for (const PointAnswer answer : {PointAnswer::Bits, PointAnswer::Bytes, PointAnswer::Masks}) {
        const auto expected = classifier.download(set, points, {.answer = answer}).value();
        gl().NamedBufferData(buffers[1], static_cast<GLsizeiptr>(expected.size()), nullptr,
                             GL_STATIC_DRAW);
        ASSERT_TRUE(
            classifier.classify(set, {.buffer = buffers[0], .strideBytes = kStride, .count = count},
                                {.answer = answer}, buffers[1]));
        std::vector<std::uint8_t> found(expected.size());
        gl().MemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
        gl().GetNamedBufferSubData(buffers[1], 0, static_cast<GLsizeiptr>(found.size()),
                                   found.data());
        EXPECT_EQ(found, expected);
    }
    gl().DeleteBuffers(2, buffers);
}

TEST_F(ParityPointsGlTest, NoPointsAreNoError) {
    const auto set = SpriteSet::create(device()).value();
    auto classifier = PointClassifier::create(device()).value();
    EXPECT_TRUE(classifier.classify(set, {}, {}, 0));
    EXPECT_EQ(PointClassifier::answerBytes(PointAnswer::Masks, 0), 0u);
    // A set without sprites contains no point.
    const glm::vec3 origin(0.0f);
    EXPECT_EQ(classifier.download(set, {&origin, 1}).value(), std::vector<std::uint8_t>(4));
}

} // namespace
} // namespace lamina
