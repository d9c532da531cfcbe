// What an engine's frame asks of refraction: several objects, deformed ones, open ones, none.

#include "gl/support/ball_frame.hpp"
#include "gl/support/host_draw.hpp"

#include <reference/shapes.hpp>

#include <glm/exponential.hpp>
#include <glm/geometric.hpp>

#include <cmath>

namespace lamina {
namespace {

namespace ref = reference;
using test::Ball;
using test::kRefractionModels;
using test::kSize;

class RefractionFrameGlTest : public test::BallFrameTest {
protected:
    /// Light through a clear ball that takes `absorption`, as the formula has it, pixel by pixel.
    void expectAbsorbed(const std::vector<glm::vec4>& pixels, std::span<const Ball> balls,
                        std::span<const glm::vec3> absorption, const char* what) {
        for (unsigned y = 0; y < kSize.y; ++y)
            for (unsigned x = 0; x < kSize.x; ++x) {
                const glm::vec4& found = pixels[std::size_t{y} * kSize.x + x];
                const auto hit = hitBalls(balls, x, y);
                if (!hit) {
                    ASSERT_EQ(found, glm::vec4(0.0f)) << what << ' ' << x << ' ' << y;
                    continue;
                }
                // Near the rim the mesh's facets have other chords than the ball.
                if (hit->chord < 0.6 * balls[hit->ball].radius)
                    continue;
                const glm::vec3 expected =
                    glm::exp(-absorption[hit->ball] * static_cast<float>(hit->chord));
                ASSERT_LT(glm::distance(glm::vec3(found), expected), 0.02f)
                    << what << ' ' << x << ' ' << y;
            }
    }
};

/// One Refraction takes turns with three objects, each of its own colour, in one target.
TEST_F(RefractionFrameGlTest, SeveralObjectsWithDifferentMaterials) {
    const Ball balls[] = {{{-1.3, 0, 0}, 0.6}, {{0.1, -0.1, 0.3}, 0.7}, {{1.4, 0.2, -0.2}, 0.5}};
    const glm::vec3 absorption[] = {{1.5f, 0.2f, 0.0f}, {0.1f, 0.9f, 0.4f}, {0.0f, 0.3f, 2.0f}};
    const Environment environment = whiteEnvironment();
    const GBuffer drawn = draw(balls);
    std::vector<MeshBuffers> buffers;
    for (const Ball& ball : balls)
        buffers.push_back(
            MeshBuffers::upload(device(), ref::makeIcosphere(glm::vec3(ball.center),
                                                             static_cast<float>(ball.radius), 4))
                .value());
    for (const RefractionModel model : kRefractionModels) {
        Refraction refraction = create(model, environment);
        const gl::Texture target =
            texture(GL_RGBA16F, GL_RGBA, GL_FLOAT,
                    std::vector<glm::vec4>(std::size_t{kSize.x} * kSize.y, glm::vec4(0.0f)));
        for (std::uint32_t i = 0; i < 3; ++i) {
            const GeometrySource source = buffers[i].view();
            RefractionSettings settings;
            settings.refractiveIndex = 1.0f;
            settings.absorption = absorption[i];
            ASSERT_TRUE(refraction.setSettings(settings));
            const glm::dvec3 reach(balls[i].radius);
            const RefractionObject object{
                {&source, 1}, {&mClear, 1}, {balls[i].center - reach, balls[i].center + reach}};
            ASSERT_TRUE(refraction.prepare(object, mView));
            const auto applied = refraction.apply(receiverOf(drawn, i + 1), target.id());
            ASSERT_TRUE(applied) << applied.error().text;
        }
        expectAbsorbed(read(target.id()), balls, absorption, "model");
    }
}

/// Two objects of one prepare(): materials of their own, by the volume.
TEST_F(RefractionFrameGlTest, MaterialsOfOneVolume) {
    const Ball balls[] = {{{-0.8, 0, 0}, 0.6}, {{0.8, -0.1, 0.1}, 0.7}};
    const glm::vec3 absorption[] = {{1.5f, 0.2f, 0.1f}, {0.1f, 0.9f, 0.4f}};
    const Environment environment = whiteEnvironment();
    const GBuffer drawn = draw(balls);
    std::vector<MeshBuffers> buffers;
    std::vector<GeometrySource> sources;
    std::vector<Material> materials(2, mClear);
    for (std::uint32_t i = 0; i < 2; ++i) {
        buffers.push_back(MeshBuffers::upload(
                              device(), ref::makeIcosphere(glm::vec3(balls[i].center),
                                                           static_cast<float>(balls[i].radius), 4))
                              .value());
        MeshView view = buffers.back().view();
        view.materialId = i;
        sources.emplace_back(view);
        materials[i].color = glm::vec4(glm::exp(-absorption[i]), 1.0f);
    }
    for (const RefractionModel model :
         {RefractionModel::TwoSurfaces, RefractionModel::ManySurfaces}) {
        Refraction refraction = create(model, environment);
        const RefractionObject object{sources, materials, {{-1.5, -0.9, -0.7}, {1.6, 0.7, 0.9}}};
        ASSERT_TRUE(refraction.prepare(object, mView));
        const auto applied = refraction.apply(receiverOf(drawn));
        ASSERT_TRUE(applied) << applied.error().text;
        expectAbsorbed(read(*applied), balls, absorption, "one volume");
    }
}

/// A ball that the host's vertex stage moves and blows up, frame by frame.
TEST_F(RefractionFrameGlTest, DeformedByAVertexShader) {
    const TriangleMesh mesh = ref::makeIcosphere({0, 0, 0}, 1.0f, 4);
    auto buffers = MeshBuffers::upload(device(), mesh).value();
    const MeshView host = buffers.view();
    const auto vertexArray = test::makeVertexArray(device(), host);
    glm::vec4 place(0.0f);
    DrawSource draws;
    draws.vertexShader = R"(
layout(location = 2) uniform vec4 place;
layout(location = 0) in vec3 position;
LaminaVertex laminaVertex() {
    return LaminaVertex(place.xyz + place.w * position, position, 0u);
}
)";
    draws.draw = [&](const DrawContext& context) {
        gl().ProgramUniform4f(context.program, 2, place.x, place.y, place.z, place.w);
        gl().BindVertexArray(vertexArray.id());
        gl().DrawElements(GL_TRIANGLES, static_cast<GLsizei>(host.indexCount), GL_UNSIGNED_INT,
                          reinterpret_cast<const void*>(host.indexOffsetBytes));
    };
    const GeometrySource source = draws;
    const Environment environment = whiteEnvironment();
    const glm::vec3 absorption(0.9f, 0.4f, 0.1f);
    for (const RefractionModel model : kRefractionModels) {
        Refraction refraction = create(model, environment);
        RefractionSettings settings;
        settings.refractiveIndex = 1.0f;
        settings.absorption = absorption;
        ASSERT_TRUE(refraction.setSettings(settings));
        for (const Ball& ball : {Ball{{-0.4, 0.1, 0}, 0.5}, Ball{{0.3, -0.2, 0.2}, 1.0}}) {
            place = glm::vec4(glm::vec3(ball.center), static_cast<float>(ball.radius));
            const RefractionObject object{
                {&source, 1}, {&mClear, 1}, {glm::dvec3(-1.3), glm::dvec3(1.4)}};
            ASSERT_TRUE(refraction.prepare(object, mView));
            const auto applied = refraction.apply(receiverOf(draw({&ball, 1})));
            ASSERT_TRUE(applied) << applied.error().text;
            expectAbsorbed(read(*applied), {&ball, 1}, {&absorption, 1}, "deformed");
        }
    }
}

/// The half of a ball that faces the viewer, without the other: told, bounded and finite.
TEST_F(RefractionFrameGlTest, OpenMeshesAreReportedAndBounded) {
    const Ball ball{{0, 0, 0}, 1.0};
    const TriangleMesh closed = ref::makeIcosphere({0, 0, 0}, 1.0f, 4);
    TriangleMesh open = closed;
    const glm::vec3 towards(glm::normalize(mEye));
    std::erase_if(open.triangles, [&](const glm::uvec3& triangle) {
        return glm::dot(open.positions[triangle.x], towards) < 0.0f;
    });
    const Environment environment = whiteEnvironment();
    const GBuffer drawn = draw({&ball, 1});
    Material glass;
    glass.refractiveIndex = 1.5f;
    glass.transmission = 0.0f; // Opaque: no power of it may be anything but a number.
    for (const RefractionModel model : kRefractionModels) {
        Refraction refraction = create(model, environment);
        EXPECT_EQ(refraction.downloadReport().error().code, ErrorCode::InvalidArgument);
        std::uint64_t reported[2] = {};
        std::size_t shown = 0;
        for (const bool isOpen : {false, true}) {
            auto buffers = MeshBuffers::upload(device(), isOpen ? open : closed).value();
            const GeometrySource source = buffers.view();
            const RefractionObject object{
                {&source, 1}, {&glass, 1}, {glm::dvec3(-1), glm::dvec3(1)}};
            ASSERT_TRUE(refraction.prepare(object, mView));
            const auto applied = refraction.apply(receiverOf(drawn));
            ASSERT_TRUE(applied) << applied.error().text;
            shown = 0;
            for (const glm::vec4& pixel : read(*applied)) {
                shown += pixel.a == 1.0f ? 1 : 0;
                for (int channel = 0; channel < 3; ++channel) {
                    ASSERT_TRUE(std::isfinite(pixel[channel]));
                    ASSERT_GE(pixel[channel], 0.0f);
                    ASSERT_LE(pixel[channel], 1.001f);
                }
            }
            reported[isOpen ? 1 : 0] = refraction.downloadReport().value().openPixels;
        }
        EXPECT_LE(reported[0], shown / 50) << static_cast<int>(model);
        EXPECT_GE(reported[1], shown * 9 / 10) << static_cast<int>(model);
    }
}

TEST_F(RefractionFrameGlTest, NothingToShowIsNoError) {
    const Ball ball{{0, 0, 0}, 1.0};
    const Environment environment = whiteEnvironment();
    const GBuffer drawn = draw({&ball, 1});
    for (const RefractionModel model : kRefractionModels) {
        Refraction refraction = create(model, environment);
        const RefractionObject nothing{{}, {}, {glm::dvec3(-1), glm::dvec3(1)}};
        ASSERT_TRUE(refraction.prepare(nothing, mView));
        const auto applied = refraction.apply(receiverOf(drawn));
        ASSERT_TRUE(applied) << applied.error().text;
        for (const glm::vec4& pixel : read(*applied))
            for (int channel = 0; channel < 4; ++channel)
                ASSERT_TRUE(pixel[channel] >= 0.0f && pixel[channel] <= 1.001f);
    }
}

} // namespace
} // namespace lamina
