// Every call of lamina::parity leaves the GL state as it found it, from a state far from the
// defaults, and works all the same.

#include "gl/support/gl_state.hpp"
#include "gl/support/gl_test.hpp"
#include "gl/support/parity.hpp"

#include <reference/shapes.hpp>

#include <gmock/gmock.h>

namespace lamina {
namespace {

using test::OddGlState;
using test::readGlState;

class ParityStateGlTest : public test::GlTest {
protected:
    void expectEveryCallRestores();
};

void ParityStateGlTest::expectEveryCallRestores() {
    const TriangleMesh knot = reference::makeTorusKnot({0, 0, 0}, 0.55f, 0.12f, 2, 3, 96, 12);
    const auto transform = fitSprite(knot.bounds(), {0, 0, 1}, 50).value();
    const auto points = test::randomPoints(knot.bounds(), 3000, 8);
    // What is right, from the default state.
    const test::BuiltSprite built(device(), knot, transform);
    const SpriteLayers expected = built.sprite.download().value();
    const DepthSprite* builtSprites[] = {&built.sprite};
    const auto answers = test::classify(device(), builtSprites, points);
    ASSERT_GT(std::ranges::count(answers, 1), 100);

    const OddGlState odd(gl());
    auto buffers = MeshBuffers::upload(device(), knot).value();
    const GeometrySource source = buffers.view();
    std::optional<SpriteBuilder> builder;
    expectUnchanged("SpriteBuilder::create",
                    [&] { builder.emplace(SpriteBuilder::create(device()).value()); });
    std::optional<DepthSprite> sprite;
    expectUnchanged("DepthSprite::create",
                    [&] { sprite.emplace(DepthSprite::create(device()).value()); });
    for (const SpriteMethod method : {SpriteMethod::SinglePass, SpriteMethod::Peeling}) {
        expectUnchanged("build", [&] {
            ASSERT_TRUE(
                builder->build({&source, 1}, transform, expected.layers(), *sprite, method));
        });
        std::optional<SpriteLayers> layers;
        expectUnchanged("download", [&] { layers.emplace(sprite->download().value()); });
        EXPECT_TRUE(std::ranges::equal(layers->depths(), expected.depths()));
        expectUnchanged("buildAndWait", [&] {
            ASSERT_TRUE(builder->buildAndWait({&source, 1}, transform, *sprite, method));
        });
    }
    expectUnchanged("downloadReport", [&] {
        EXPECT_EQ(sprite->downloadReport()->crossings, built.report.crossings);
        EXPECT_EQ(builder->downloadReport({&source, 1}, transform)->crossings,
                  built.report.crossings);
    });
    expectUnchanged("downloadBestDirection", [&] {
        ASSERT_TRUE(
            builder->downloadBestDirection({&source, 1}, knot.bounds(), spriteDirections(), 32));
    });
    expectUnchanged("failed build", [&] {
        const GeometrySource broken = MeshView{};
        EXPECT_FALSE(builder->build({&broken, 1}, transform, 4, *sprite));
    });
    std::optional<SpriteSet> set;
    std::optional<PointClassifier> classifier;
    expectUnchanged("SpriteSet", [&] {
        set.emplace(SpriteSet::create(device()).value());
        const SpriteInstance instances[] = {{.sprite = &*sprite}, {.sprite = &*sprite}};
        ASSERT_TRUE(set->update(instances));
    });
    expectUnchanged("PointClassifier", [&] {
        classifier.emplace(PointClassifier::create(device()).value());
        for (const PointAnswer answer :
             {PointAnswer::Bits, PointAnswer::Bytes, PointAnswer::Classes, PointAnswer::Masks})
            ASSERT_TRUE(classifier->download(*set, points, {.answer = answer}));
        EXPECT_EQ(*classifier->download(*set, points), answers);
    });
    expectUnchanged("destruction", [&] {
        classifier.reset();
        set.reset();
        sprite.reset();
        builder.reset();
    });
}

TEST_F(ParityStateGlTest, EveryCallRestoresTheState) {
    expectEveryCallRestores();
}

TEST_F(ParityStateGlTest, BindChangesOnlyWhatItPromises) {
    const TriangleMesh box = reference::makeBox({0, 0, 0}, {1, 1, 1});
    const test::BuiltSprite built(device(), box, fitSprite(box.bounds(), {0, 0, 1}, 16).value());
    const DepthSprite* sprites[] = {&built.sprite, &built.sprite};
    const SpriteSet set = test::spriteSet(device(), sprites);
    const OddGlState odd(gl());
    const auto before = readGlState(gl());
    set.bind(5, 6);
    using testing::StartsWith;
    EXPECT_THAT(test::differences(before, readGlState(gl())),
                testing::UnorderedElementsAre(StartsWith("GL_UNIFORM_BUFFER_BINDING[5]:"),
                                              StartsWith("GL_TEXTURE_BINDING_2D_ARRAY[6]:"),
                                              StartsWith("GL_SAMPLER_BINDING[6]:"),
                                              StartsWith("GL_TEXTURE_BINDING_2D_ARRAY[7]:"),
                                              StartsWith("GL_SAMPLER_BINDING[7]:")));
}

TEST_F(ParityStateGlTest, TheCallersTransformFeedbackIsPausedAndResumed) {
    const char* text =
        "#version 450\nlayout(xfb_buffer = 0, xfb_offset = 0, xfb_stride = 4) out float value;\n"
        "void main() { value = 1.0; gl_Position = vec4(0.0); }";
    const GLuint program = buildProgram({{GL_VERTEX_SHADER, text}});
    GLuint feedback = 0, buffer = 0;
    gl().CreateTransformFeedbacks(1, &feedback);
    gl().CreateBuffers(1, &buffer);
    gl().NamedBufferData(buffer, 64, nullptr, GL_STATIC_DRAW);
    gl().TransformFeedbackBufferBase(feedback, 0, buffer);
    gl().BindTransformFeedback(GL_TRANSFORM_FEEDBACK, feedback);
    gl().UseProgram(program);
    gl().BeginTransformFeedback(GL_POINTS);
    const TriangleMesh box = reference::makeBox({0, 0, 0}, {1, 1, 1});
    expectUnchanged("build and classify", [&] {
        const test::BuiltSprite built(device(), box,
                                      fitSprite(box.bounds(), {0, 0, 1}, 16).value());
        EXPECT_EQ(built.report.layers, 2u);
        const DepthSprite* sprites[] = {&built.sprite};
        const glm::vec3 inside(0.5f);
        EXPECT_EQ(test::classify(device(), sprites, {&inside, 1})[0], 1);
    });
    gl().EndTransformFeedback();
    gl().BindTransformFeedback(GL_TRANSFORM_FEEDBACK, 0);
    gl().UseProgram(0);
    gl().DeleteTransformFeedbacks(1, &feedback);
    gl().DeleteBuffers(1, &buffer);
    gl().DeleteProgram(program);
}

} // namespace
} // namespace lamina
