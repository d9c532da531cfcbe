// lamina/parity.glsl from every stage, point batches, and their host twin.

#include "gl/support/parity_query.hpp"
#include "parity/parity_constants.hpp"

#include <lamina/gl/shaders.hpp>

#include <reference/shapes.hpp>

#include <gmock/gmock.h>

#include <glm/gtc/matrix_transform.hpp>

#include <limits>
#include <memory>
#include <optional>

namespace lamina {
namespace {

namespace ref = reference;
using test::BuiltSprite;
using test::kUnitBox;
using test::ParityQueryGlTest;
using test::parityText;
using testing::HasSubstr;

TEST_F(ParityQueryGlTest, EveryStageAndTheHostGiveTheSameAnswers) {
    const TriangleMesh knot = ref::makeTorusKnot({0, 0, 0}, 0.55f, 0.12f, 2, 3, 256, 24);
    const TriangleMesh sponge = ref::makeMengerSponge({0, 0, 0}, 1.5f, 2);
    const BuiltSprite first(device(), knot, fitSprite(kUnitBox, {0, 0, 1}, 200).value());
    const BuiltSprite second(device(), sponge, fitSprite(kUnitBox, {1, 2, -1}, 150).value());
    ASSERT_LE(first.sprite.layers(), 8u);
    ASSERT_GT(second.sprite.layers(), 8u) << "both ways of searching";
    const DepthSprite* sprites[] = {&first.sprite, &second.sprite};
    const SpriteSet set = test::spriteSet(device(), sprites);

    // A pixel a point; each stage writes what it says itself.
    constexpr GLsizei kSide = 128;
    constexpr std::size_t kPoints = kSide * kSide;
    const auto points = test::randomPoints({{-1.2, -1.2, -1.2}, {1.2, 1.2, 1.2}}, kPoints, 17);
    const std::string vertex = parityText(2) + R"(
layout(location = 0) in vec3 world;
layout(location = 0) out vec3 vertexWorld;
layout(location = 1) out uint vertexMask;
void main() {
    vertexWorld = world;
    vertexMask = laminaParityMask(world);
    vec2 pixel = vec2(gl_VertexID % 128, gl_VertexID / 128) + 0.5;
    gl_Position = vec4(pixel / 64.0 - 1.0, 0.0, 1.0);
})";
    const std::string geometry = parityText(2) + R"(
layout(points) in;
layout(points, max_vertices = 1) out;
layout(location = 0) in vec3 vertexWorld[];
layout(location = 1) in uint vertexMask[];
layout(location = 0) flat out vec3 world;
layout(location = 1) flat out uvec2 masks;
void main() {
    world = vertexWorld[0];
    masks = uvec2(vertexMask[0], laminaParityMask(vertexWorld[0]));
    gl_Position = gl_in[0].gl_Position;
    EmitVertex();
})";
    const std::string fragment = parityText(2) + R"(
layout(location = 0) flat in vec3 world;
layout(location = 1) flat in uvec2 masks;
layout(location = 0) out uvec4 answers;
void main() {
    answers = uvec4(masks, laminaParityMask(world), 7u);
})";
    const GLuint program = buildProgram({{GL_VERTEX_SHADER, vertex},
                                         {GL_GEOMETRY_SHADER, geometry},
                                         {GL_FRAGMENT_SHADER, fragment}});
    GLuint texture = 0, framebuffer = 0, vertexArray = 0, buffer = 0;
    gl().CreateTextures(GL_TEXTURE_2D, 1, &texture);
    gl().TextureStorage2D(texture, 1, GL_RGBA32UI, kSide, kSide);
    gl().CreateFramebuffers(1, &framebuffer);
    gl().NamedFramebufferTexture(framebuffer, GL_COLOR_ATTACHMENT0, texture, 0);
    gl().CreateVertexArrays(1, &vertexArray);
    gl().CreateBuffers(1, &buffer);
    gl().NamedBufferData(buffer, kPoints * sizeof(glm::vec3), points.data(), GL_STATIC_DRAW);
    gl().EnableVertexArrayAttrib(vertexArray, 0);
    gl().VertexArrayAttribFormat(vertexArray, 0, 3, GL_FLOAT, GL_FALSE, 0);
    gl().VertexArrayVertexBuffer(vertexArray, 0, buffer, 0, sizeof(glm::vec3));
    gl().BindFramebuffer(GL_FRAMEBUFFER, framebuffer);
    gl().Viewport(0, 0, kSide, kSide);
    gl().BindVertexArray(vertexArray);
    gl().UseProgram(program);
    set.bind();
    gl().DrawArrays(GL_POINTS, 0, static_cast<GLsizei>(kPoints));
    std::vector<glm::uvec4> drawn(kPoints);
    gl().ReadPixels(0, 0, kSide, kSide, GL_RGBA_INTEGER, GL_UNSIGNED_INT, drawn.data());
    gl().UseProgram(0);
    gl().BindVertexArray(0);
    gl().BindFramebuffer(GL_FRAMEBUFFER, 0);
    gl().DeleteTextures(1, &texture);
    gl().DeleteFramebuffers(1, &framebuffer);
    gl().DeleteVertexArrays(1, &vertexArray);
    gl().DeleteBuffers(1, &buffer);
    gl().DeleteProgram(program);

    const auto computed =
        ask(set, points, "vec4 ask(vec3 world) { return vec4(laminaParityMask(world)); }");
    const auto batch = masks(set, points);
    const SpriteLayers hosts[] = {first.sprite.download().value(),
                                  second.sprite.download().value()};
    std::size_t roundings = 0;
    std::size_t insides = 0;
    for (std::size_t i = 0; i < kPoints; ++i) {
        ASSERT_EQ(drawn[i].w, 7u) << i;
        ASSERT_EQ(drawn[i].x, drawn[i].z) << i;
        ASSERT_EQ(drawn[i].y, drawn[i].z) << i;
        ASSERT_EQ(static_cast<std::uint32_t>(computed[i].x), drawn[i].z) << i;
        ASSERT_EQ(batch[i], drawn[i].z) << i;
        const std::uint32_t host =
            (hosts[0].inside(points[i]) ? 1u : 0u) | (hosts[1].inside(points[i]) ? 2u : 0u);
        // Shaders place a point in single precision: at a column's edge it may fall into the next.
        roundings += host != drawn[i].z ? 1 : 0;
        insides += host != 0 ? 1 : 0;
    }
    EXPECT_LE(roundings, kPoints / 2000);
    EXPECT_GT(insides, kPoints / 20);
}

TEST_F(ParityQueryGlTest, SpritesMoveAndTurnInsideOut) {
    const TriangleMesh knot = ref::makeTorusKnot({0, 0, 0}, 0.55f, 0.2f, 2, 3, 128, 16);
    const BuiltSprite built(device(), knot, fitSprite(kUnitBox, {0, 0, 1}, 256).value());
    const SpriteLayers host = built.sprite.download().value();
    glm::dmat4 placement = glm::translate(glm::dmat4(1.0), {0.4, -0.2, 0.3});
    placement = glm::rotate(placement, 0.7, glm::dvec3(1, 2, 3));
    placement = glm::scale(placement, glm::dvec3(1.5, 0.8, 1.1));
    auto set = SpriteSet::create(device()).value();
    const SpriteInstance instances[] = {
        {.sprite = &built.sprite},
        {.sprite = &built.sprite, .localToWorld = placement},
        {.sprite = &built.sprite, .localToWorld = placement, .inverted = true}};
    ASSERT_TRUE(set.update(instances));
    const auto points = test::randomPoints({{-2, -2, -2}, {2, 2, 2}}, 20000, 3);
    const auto found = masks(set, points);
    const glm::dmat4 back = glm::inverse(placement);
    std::size_t wrong = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
        const bool here = host.inside(points[i]);
        const bool there = host.inside(glm::dvec3(back * glm::dvec4(glm::dvec3(points[i]), 1.0)));
        wrong += found[i] != ((here ? 1u : 0u) | (there ? 2u : 4u)) ? 1 : 0;
    }
    EXPECT_LE(wrong, points.size() / 1000) << "rounding of places";
}

TEST_F(ParityQueryGlTest, ThirtyTwoSpritesAnswerTogether) {
    // Slabs [s, s + 2) along x in a row of unit boxes.
    const TriangleMesh slab = ref::makeBox({0, 0, 0}, {2, 1, 1});
    const BuiltSprite built(device(), slab, fitSprite(slab.bounds(), {0, 0, 1}, 64).value());
    std::vector<SpriteInstance> instances(32, SpriteInstance{.sprite = &built.sprite});
    for (std::size_t s = 0; s < instances.size(); ++s)
        instances[s].localToWorld = glm::translate(glm::dmat4(1.0), {static_cast<double>(s), 0, 0});
    auto set = SpriteSet::create(device()).value();
    ASSERT_TRUE(set.update(instances));
    std::vector<glm::vec3> points;
    for (int x = -1; x < 35; ++x)
        points.emplace_back(static_cast<float>(x) + 0.5f, 0.5f, 0.5f);
    const auto found = masks(set, points);
    for (int x = -1; x < 35; ++x) {
        std::uint64_t expected = 0;
        for (int s = x - 1; s <= x; ++s)
            expected |= s >= 0 && s < 32 ? std::uint64_t{1} << s : 0;
        EXPECT_EQ(found[static_cast<std::size_t>(x + 1)], expected) << x;
    }
    instances.push_back(instances[0]);
    const auto tooMany = set.update(instances);
    ASSERT_FALSE(tooMany);
    EXPECT_THAT(tooMany.error().text, HasSubstr("expected at most 32 sprites, found 33"));
    EXPECT_EQ(set.size(), 32u);
    auto unbuilt = DepthSprite::create(device()).value();
    auto moved = DepthSprite::create(device()).value();
    const DepthSprite target = std::move(moved);
    for (const DepthSprite* missing :
         {static_cast<const DepthSprite*>(nullptr), static_cast<const DepthSprite*>(&unbuilt),
          static_cast<const DepthSprite*>(&moved)}) {
        const SpriteInstance none[] = {{.sprite = missing}};
        EXPECT_THAT(set.update(none).error().text,
                    HasSubstr("sprite 0: expected a sprite that was built"));
    }
    const SpriteInstance flat[] = {
        {.sprite = &built.sprite,
         .localToWorld = glm::scale(glm::dmat4(1.0), glm::dvec3(1, 1, 0))}};
    EXPECT_THAT(set.update(flat).error().text, HasSubstr("invertible localToWorld"));
    // Scales that double precision has and shaders have not.
    for (const glm::dvec3& scale : {glm::dvec3(1e-60), glm::dvec3(1e-45), glm::dvec3(1e60),
                                    glm::dvec3(1e42), glm::dvec3(1, 1e-44, 1)}) {
        const SpriteInstance extreme[] = {
            {.sprite = &built.sprite, .localToWorld = glm::scale(glm::dmat4(1.0), scale)}};
        const auto refused = set.update(extreme);
        ASSERT_FALSE(refused) << scale.y;
        EXPECT_EQ(refused.error().code, ErrorCode::InvalidArgument);
        EXPECT_THAT(refused.error().text,
                    HasSubstr("localToWorld whose inverse single-precision numbers hold"));
    }
    // Flat in single precision only: rows that its digits do not tell apart.
    glm::dmat4 worldToLocal(1.0);
    worldToLocal[0] = {1.0, 1.0, 0.0, 0.0};
    worldToLocal[1] = {1.0, 1.0 + 1e-9, 0.0, 0.0};
    const SpriteInstance sheared[] = {
        {.sprite = &built.sprite, .localToWorld = glm::inverse(worldToLocal)}};
    EXPECT_FALSE(set.update(sheared));
    for (const double scale : {1e-30, 1e-6, 1e30}) {
        const SpriteInstance fine[] = {
            {.sprite = &built.sprite,
             .localToWorld =
                 glm::rotate(glm::scale(glm::dmat4(1.0), glm::dvec3(-scale, scale, scale)), 0.3,
                             glm::dvec3(1, 2, 3))}};
        EXPECT_TRUE(set.update(fine)) << scale;
    }
    // A set without sprites contains nothing.
    ASSERT_TRUE(set.update({}));
    EXPECT_EQ(masks(set, points), std::vector<std::uint32_t>(points.size()));
}

TEST_F(ParityQueryGlTest, SetsSeeThatASpriteWasRebuiltOrDestroyed) {
    const TriangleMesh box = ref::makeBox({-1, -1, -1}, {1, 1, 1});
    const auto transform = fitSprite(box.bounds(), {0, 0, 1}, 32).value();
    auto sprite = std::make_unique<BuiltSprite>(device(), box, transform);
    const GeometrySource source = sprite->buffers.view();
    auto builder = SpriteBuilder::create(device()).value();
    auto classifier = PointClassifier::create(device()).value();
    auto set = SpriteSet::create(device()).value();
    const std::vector<glm::vec3> points = {{0, 0, 0}};
    const auto update = [&] {
        const SpriteInstance instances[] = {{.sprite = &sprite->sprite}};
        ASSERT_TRUE(set.update(instances));
        EXPECT_EQ(set.outdatedSprite(), std::nullopt);
        EXPECT_EQ(classifier.download(set, points).value()[0], 1);
    };
    const auto expectOutdated = [&] {
        EXPECT_EQ(set.outdatedSprite(), 0u);
        const auto stale = classifier.download(set, points);
        ASSERT_FALSE(stale);
        EXPECT_EQ(stale.error().code, ErrorCode::InvalidArgument);
        EXPECT_THAT(stale.error().text,
                    HasSubstr("sprite 0 was rebuilt or destroyed; call SpriteSet::update()"));
        set.bind();
        EXPECT_EQ(gl().GetError(), static_cast<GLenum>(GL_NO_ERROR));
    };
    const auto rebuild = [&](const GridTransform& other, std::uint32_t layers) {
        EXPECT_TRUE(builder.build({&source, 1}, other, layers, sprite->sprite));
    };
    update();
    // The same columns, layers and transform, as in every frame of a shape that moves.
    rebuild(transform, 2);
    EXPECT_EQ(set.outdatedSprite(), std::nullopt);
    rebuild(transform, 8);
    expectOutdated();
    update();
    rebuild(fitSprite(box.bounds(), {0, 0, 1}, 64).value(), 8);
    expectOutdated();
    update();
    rebuild(fitSprite(box.bounds(), {1, 0, 0}, 64).value(), 8);
    expectOutdated();
    update();
    DepthSprite moved = std::move(sprite->sprite);
    EXPECT_EQ(set.outdatedSprite(), std::nullopt) << "it only changed its owner";
    moved = DepthSprite::create(device()).value();
    expectOutdated();
    EXPECT_TRUE(classifier.download(set, {}).value().empty());
}

TEST_F(ParityQueryGlTest, PointsWithoutAPlaceAreOutside) {
    const TriangleMesh box = ref::makeBox({-1, -1, -1}, {1, 1, 1});
    const BuiltSprite built(device(), box, fitSprite(box.bounds(), {0, 0, 1}, 32).value());
    auto set = SpriteSet::create(device()).value();
    const SpriteInstance instances[] = {{.sprite = &built.sprite},
                                        {.sprite = &built.sprite, .inverted = true}};
    ASSERT_TRUE(set.update(instances));
    const float nan = std::numeric_limits<float>::quiet_NaN();
    const float infinity = std::numeric_limits<float>::infinity();
    const std::vector<glm::vec3> points = {{nan, 0, 0},      {0, nan, 0},       {0, 0, nan},
                                           {infinity, 0, 0}, {0, -infinity, 0}, {1e38f, 0, 0},
                                           {0, 0, 5},        {0, 0, 0}};
    const std::vector<std::uint32_t> expected = {2, 2, 2, 2, 2, 2, 2, 1};
    EXPECT_EQ(masks(set, points), expected);
    EXPECT_EQ(masks(set, points, {.answer = PointAnswer::Masks, .directions = 1}), expected);
    // The shader's other questions.
    const auto found = ask(set, points, R"(
vec4 ask(vec3 world) {
    return vec4(laminaParityClassify(0, world), laminaParityClassify(1, world),
                laminaParityProbe(0, world).inside, laminaParityNormal(0, world) == vec3(0.0));
})");
    for (std::size_t i = 0; i < points.size(); ++i) {
        const bool isInside = expected[i] == 1;
        EXPECT_EQ(found[i].x, isInside ? 1 : 0) << i;
        EXPECT_EQ(found[i].y, isInside ? 0 : 1) << i;
        EXPECT_EQ(found[i].z, isInside ? 1 : 0) << i;
        EXPECT_EQ(found[i].w, isInside || i == 6 ? 0 : 1) << i;
    }
}

TEST_F(ParityQueryGlTest, SharedLayoutsMatchTheLinkedProgram) {
    const GLuint program = buildProgram({{GL_COMPUTE_SHADER, parityText(2) + R"(
layout(local_size_x = 1) in;
layout(std430, binding = 1) buffer Out { LaminaSpriteReport report; };
void main() { report.crossingsHigh = laminaParityMask(vec3(0.0)); }
)"}});
    const auto offsetOf = [&](GLenum interface, const char* name) {
        const GLuint index = gl().GetProgramResourceIndex(program, interface, name);
        EXPECT_NE(index, GL_INVALID_INDEX) << name;
        constexpr GLenum kOffset = GL_OFFSET;
        GLint value = -1;
        gl().GetProgramResourceiv(program, interface, index, 1, &kOffset, 1, nullptr, &value);
        return static_cast<std::size_t>(value);
    };
    using Sprite = shared::LaminaSpriteConstants;
    constexpr std::size_t kFirst = offsetof(shared::ParityBlock, sprites);
    EXPECT_EQ(offsetOf(GL_UNIFORM, "laminaParitySprite[0].worldToSprite[0]"), kFirst);
    EXPECT_EQ(offsetOf(GL_UNIFORM, "laminaParitySprite[1].size"),
              kFirst + sizeof(Sprite) + offsetof(Sprite, size));
    EXPECT_EQ(offsetOf(GL_UNIFORM, "laminaParitySprite[0].scale"),
              kFirst + offsetof(Sprite, scale));
    EXPECT_EQ(offsetOf(GL_BUFFER_VARIABLE, "report.crossingsHigh"),
              offsetof(shared::LaminaSpriteReport, crossingsHigh));
    gl().DeleteProgram(program);
}

} // namespace
} // namespace lamina
