// Refraction of a G-buffer and in a forward shader, environments, GL state and errors.

#include "gl/support/gl_state.hpp"
#include "gl/support/gl_test.hpp"
#include "gl/support/host_draw.hpp"

#include <lamina/gl/shaders.hpp>
#include <lamina/refraction/refraction.hpp>

#include <reference/shapes.hpp>

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/gtc/matrix_transform.hpp>
#include <gmock/gmock.h>

#include <cmath>
#include <limits>
#include <optional>

namespace lamina {
namespace {

constexpr glm::uvec2 kSize{96, 64};
constexpr RefractionModel kModels[] = {RefractionModel::VolumeIntegral,
                                       RefractionModel::TwoSurfaces, RefractionModel::ManySurfaces};

class RefractionApplyGlTest : public test::GlTest {
protected:
    void SetUp() override {
        GlTest::SetUp();
        mMesh = reference::makeIcosphere({0, 0, 0}, 1.0f, 4);
        mBuffers.emplace(MeshBuffers::upload(device(), mMesh).value());
        mSource = mBuffers->view();
        mView.size = kSize;
        mView.worldToClip =
            glm::perspective(0.7, static_cast<double>(kSize.x) / kSize.y, 0.5, 40.0) *
            glm::lookAt(glm::dvec3(0.5, 0.8, 3.6), glm::dvec3(0.0), glm::dvec3(0, 1, 0));
        mGlass.refractiveIndex = 1.5f;
        gl().Enable(GL_TEXTURE_CUBE_MAP_SEAMLESS);
    }
    void TearDown() override {
        mBuffers.reset();
        gl().Disable(GL_TEXTURE_CUBE_MAP_SEAMLESS);
        GlTest::TearDown();
    }

    gl::Texture texture(GLenum format, const glm::uvec2& size = kSize) {
        return test::makeTexture(device(), format, size);
    }

    /// An environment whose light is f(direction).
    template<class Function>
    Environment environmentOf(Function f, const EnvironmentDesc& desc) {
        constexpr unsigned kRows = 64;
        std::vector<glm::vec3> texels;
        for (unsigned y = 0; y < kRows; ++y)
            for (unsigned x = 0; x < 2 * kRows; ++x) {
                const float around = ((x + 0.5f) / (2 * kRows) - 0.5f) * 6.2831853f;
                const float up = ((y + 0.5f) / kRows - 0.5f) * 3.14159265f;
                texels.push_back(f(glm::vec3(std::cos(up) * std::sin(around), std::sin(up),
                                             -std::cos(up) * std::cos(around))));
            }
        const gl::Texture flat = texture(GL_RGB32F, {2 * kRows, kRows});
        gl().TextureSubImage2D(flat.id(), 0, 0, 0, 2 * kRows, kRows, GL_RGB, GL_FLOAT,
                               texels.data());
        auto environment = Environment::create(device(), desc).value();
        const auto loaded = environment.loadEquirectangular(flat.id());
        EXPECT_TRUE(loaded) << loaded.error().text;
        return environment;
    }

    static glm::vec3 smooth(const glm::vec3& direction) { return 0.5f + 0.4f * direction; }

    std::vector<glm::vec4> readLevel(const Environment& environment, unsigned level) {
        const unsigned size = std::max(environment.desc().size >> level, 1u);
        std::vector<glm::vec4> texels(std::size_t{6} * size * size);
        gl().GetTextureImage(environment.texture(), static_cast<GLint>(level), GL_RGBA, GL_FLOAT,
                             static_cast<GLsizei>(texels.size() * sizeof(glm::vec4)),
                             texels.data());
        return texels;
    }

    std::vector<glm::vec4> read(GLuint texture) {
        return test::readPixels(device(), texture, kSize);
    }

    RefractionObject object() const { return {{&mSource, 1}, {&mGlass, 1}, mMesh.bounds()}; }

    Refraction prepared(RefractionModel model, const Environment& environment,
                        const RefractionSettings& settings = {}) {
        auto refraction =
            Refraction::create(device(), {.model = model, .thickness = {}, .voxels = 64}).value();
        refraction.setEnvironment(environment);
        EXPECT_TRUE(refraction.setSettings(settings));
        const auto stats = refraction.prepare(object(), mView);
        EXPECT_TRUE(stats) << stats.error().text;
        EXPECT_EQ(stats->meshTriangles, mMesh.triangles.size());
        return refraction;
    }

    /// The sphere as an engine draws it: a G-buffer, and the forward shader's colours if asked.
    struct Drawn {
        gl::Texture depth, normals, unsignedNormals, objects, forward;
    };

    Drawn draw(Refraction* forward = nullptr) {
        constexpr std::uint32_t kBlock = 1, kUnit = 4;
        std::string fragment = "#version 450 core\n";
        std::string shade = "vec4(0.0)";
        if (forward) {
            fragment += forward->shaderDefines(kBlock, kUnit) +
                        shaderSource("lamina/refraction.glsl").value();
            shade = "laminaRefraction(world, world, gl_FragCoord.xy)";
            forward->bind(kBlock, kUnit);
        }
        const GLuint program = buildProgram(
            {{GL_VERTEX_SHADER, test::kWorldVertexShader}, {GL_FRAGMENT_SHADER, fragment + R"(
in vec3 world;
layout(location = 0) out vec4 normals;
layout(location = 1) out vec4 unsignedNormals;
layout(location = 2) out uint object;
layout(location = 3) out vec4 forward;
void main() {
    normals = vec4(world, 0.0);
    unsignedNormals = vec4(normalize(world) * 0.5 + 0.5, 0.0);
    object = gl_FragCoord.x < 48.0 ? 7u : 8u;
    forward = )" + shade + ";\n}\n"}});
        Drawn drawn{texture(GL_DEPTH_COMPONENT32F), texture(GL_RGBA32F), texture(GL_RGBA16),
                    texture(GL_R32UI), texture(GL_RGBA32F)};
        const GLuint colors[] = {drawn.normals.id(), drawn.unsignedNormals.id(), drawn.objects.id(),
                                 drawn.forward.id()};
        const auto framebuffer = test::makeFramebuffer(device(), drawn.depth.id(), colors);
        constexpr GLfloat kZero[4] = {};
        gl().ClearNamedFramebufferfv(framebuffer.id(), GL_COLOR, 3, kZero);
        test::drawMesh(device(), program, framebuffer.id(), kSize, mView.worldToClip,
                       mBuffers->view());
        gl().DeleteProgram(program);
        return drawn;
    }

    RefractionReceiver receiver(const Drawn& drawn) const {
        RefractionReceiver receiver;
        receiver.view = mView;
        receiver.depthTexture = drawn.depth.id();
        receiver.normalTexture = drawn.normals.id();
        return receiver;
    }

    TriangleMesh mMesh;
    std::optional<MeshBuffers> mBuffers;
    GeometrySource mSource;
    Material mGlass;
    View mView;
};

/// Levels keep a constant and lose nothing: the mean light over the sphere stays; a smooth light
/// keeps its shape.
TEST_F(RefractionApplyGlTest, EnvironmentLevelsKeepLight) {
    for (const auto filter : {EnvironmentFilter::MipPyramid, EnvironmentFilter::Gaussian}) {
        const Environment constant = environmentOf(
            [](const glm::vec3&) { return glm::vec3(0.25f, 1.0f, 7.0f); }, {32, filter});
        ASSERT_EQ(constant.levels(), 6u);
        for (unsigned level = 0; level < constant.levels(); ++level)
            for (const glm::vec4& texel : readLevel(constant, level))
                ASSERT_LT(glm::distance(glm::vec3(texel), glm::vec3(0.25f, 1.0f, 7.0f)), 0.02f);
        const Environment varied = environmentOf(smooth, {32, filter});
        for (const unsigned level : {0u, 1u, 2u}) {
            // The middles of the faces: +x, -x, +y, -y, +z, -z.
            const auto texels = readLevel(varied, level);
            const unsigned size = 32u >> level;
            for (unsigned face = 0; face < 6; ++face) {
                glm::vec3 direction(0.0f);
                direction[static_cast<int>(face / 2)] = face % 2 == 0 ? 1.0f : -1.0f;
                const glm::vec3 found(
                    texels[(std::size_t{face} * size + size / 2) * size + size / 2]);
                // Half a texel beside the middle, and the blur.
                EXPECT_LT(glm::distance(found, smooth(direction)), 0.06f * (1u << level))
                    << face << ' ' << level;
            }
        }
    }
}

/// A bright spot spreads by the width that look-ups count on: 0.7 texels at each level.
TEST_F(RefractionApplyGlTest, GaussianLevelsHaveTheirWidth) {
    const Environment spot = environmentOf(
        [](const glm::vec3& direction) { return glm::vec3(direction.x > 0.998f ? 1000.0f : 0.0f); },
        {64, EnvironmentFilter::Gaussian});
    for (const unsigned level : {2u, 3u}) {
        const unsigned size = 64u >> level;
        const auto texels = readLevel(spot, level);
        double sum = 0.0, moment = 0.0;
        for (unsigned y = 0; y < size; ++y)
            for (unsigned x = 0; x < size; ++x) {
                const double weight = texels[std::size_t{y} * size + x].x;
                const double u = x + 0.5 - 0.5 * size, v = y + 0.5 - 0.5 * size;
                sum += weight;
                moment += weight * (u * u + v * v) / 2.0;
            }
        ASSERT_GT(sum, 0.0);
        // In units of the mean texel: a face's middle ones are 4 / pi times as wide. The spot
        // itself is a disc of 0.0632 radians; look-ups add a tent, 1/6.
        const double texel = 1.5707963 / size;
        const double stored = moment / sum * std::pow(4.0 / 3.14159265, 2.0);
        const double blur = stored - 0.25 * std::pow(0.0632 / texel, 2.0) + 1.0 / 6.0;
        EXPECT_NEAR(std::sqrt(blur), 0.7, 0.1) << level;
    }
}

TEST_F(RefractionApplyGlTest, ForwardShaderGivesTheSame) {
    const Environment environment = environmentOf(smooth, {64});
    for (const RefractionModel model : kModels) {
        RefractionSettings settings;
        settings.absorption = {0.1f, 0.4f, 0.9f};
        settings.bodyBlur = 0.1f;
        Refraction refraction = prepared(model, environment, settings);
        const Drawn drawn = draw(&refraction);
        const auto forward = read(drawn.forward.id());
        const auto applied = refraction.apply(receiver(drawn));
        ASSERT_TRUE(applied) << applied.error().text;
        const auto deferred = read(*applied);
        RefractionReceiver encoded = receiver(drawn);
        encoded.normalTexture = drawn.unsignedNormals.id();
        encoded.unsignedNormals = true;
        const auto decoded = read(refraction.apply(encoded).value());
        std::size_t shown = 0, apart = 0;
        for (std::size_t i = 0; i < forward.size(); ++i) {
            ASSERT_EQ(deferred[i].a, forward[i].a);
            shown += forward[i].a == 1.0f ? 1 : 0;
            // Half floats, and positions from depths; rays that graze a voxel may go elsewhere.
            const bool isClose = glm::distance(deferred[i], forward[i]) < 0.01f &&
                                 glm::distance(deferred[i], decoded[i]) < 0.01f;
            apart += isClose ? 0 : 1;
        }
        EXPECT_GT(shown, 1000u);
        EXPECT_LE(apart, shown / 50) << static_cast<int>(model);
    }
}

/// Index 1 does not bend: the environment behind, attenuated by the chord.
TEST_F(RefractionApplyGlTest, AttenuatesByTheLengthInside) {
    const Environment white = environmentOf([](const glm::vec3&) { return glm::vec3(1.0f); }, {16});
    mGlass.refractiveIndex = 1.0f;
    const Drawn drawn = draw();
    for (const RefractionModel model : kModels) {
        RefractionSettings settings;
        settings.refractiveIndex = 1.0f;
        settings.absorption = {0.2f, 0.7f, 1.9f};
        Refraction refraction = prepared(model, white, settings);
        const glm::vec4 middle = read(refraction.apply(receiver(drawn)).value())[32 * kSize.x + 48];
        for (int channel = 0; channel < 3; ++channel)
            EXPECT_NEAR(middle[channel], std::exp(-2.0f * settings.absorption[channel]), 0.02)
                << static_cast<int>(model);
        settings.attenuation = AttenuationModel::Power;
        settings.bodyColor = {0.1f, 0.5f, 0.9f};
        settings.opaqueLength = 4.0f;
        settings.exponent = 2.0f;
        ASSERT_TRUE(refraction.setSettings(settings));
        const glm::vec4 milky = read(refraction.apply(receiver(drawn)).value())[32 * kSize.x + 48];
        for (int channel = 0; channel < 3; ++channel)
            EXPECT_NEAR(milky[channel], 1.0f + 0.25f * (settings.bodyColor[channel] - 1.0f), 0.02);
    }
    // The material's own colour, per unit.
    mGlass.transmission = 0.5f;
    mGlass.color = {1.0f, 0.5f, 0.25f, 1.0f};
    Refraction refraction = prepared(RefractionModel::ManySurfaces, white);
    const glm::vec4 middle = read(refraction.apply(receiver(drawn)).value())[32 * kSize.x + 48];
    for (int channel = 0; channel < 3; ++channel)
        EXPECT_NEAR(middle[channel], std::pow(0.5f * mGlass.color[channel], 2.0f), 0.02f);
}

TEST_F(RefractionApplyGlTest, TakesOnlyItsObjectAndSeesWhatIsBehind) {
    const Environment black = environmentOf([](const glm::vec3&) { return glm::vec3(0.0f); }, {16});
    const Drawn drawn = draw();
    mGlass.refractiveIndex = 1.0f;
    RefractionSettings settings;
    settings.refractiveIndex = 1.0f;
    const gl::Texture color = texture(GL_RGBA16F);
    std::vector<glm::vec4> painted(kSize.x * kSize.y);
    for (std::size_t i = 0; i < painted.size(); ++i)
        painted[i] = {static_cast<float>(i % kSize.x) / kSize.x, 0.5f, 0.25f, 1.0f};
    for (const RefractionModel model : kModels) {
        Refraction refraction = prepared(model, black, settings);
        gl().TextureSubImage2D(color.id(), 0, 0, 0, kSize.x, kSize.y, GL_RGBA, GL_FLOAT,
                               painted.data());
        RefractionReceiver object = receiver(drawn);
        object.objectTexture = drawn.objects.id();
        object.objectId = 7;
        // Without what is behind, the object turns black, the rest stays.
        ASSERT_TRUE(refraction.apply(object, color.id()));
        const auto half = read(color.id());
        EXPECT_EQ(half[32 * kSize.x + 30], glm::vec4(0, 0, 0, 1));
        EXPECT_LT(glm::distance(half[32 * kSize.x + 60], painted[32 * kSize.x + 60]), 1e-3f);
        EXPECT_LT(glm::distance(half[2 * kSize.x + 2], painted[2 * kSize.x + 2]), 1e-3f);
        // Index 1 shows it where it is, through the target itself.
        gl().TextureSubImage2D(color.id(), 0, 0, 0, kSize.x, kSize.y, GL_RGBA, GL_FLOAT,
                               painted.data());
        object.objectId = 8;
        object.colorTexture = color.id();
        ASSERT_TRUE(refraction.apply(object, color.id()));
        const auto through = read(color.id());
        for (std::size_t i = 0; i < painted.size(); ++i)
            ASSERT_LT(glm::distance(through[i], painted[i]), 0.02f) << i;
    }
}

TEST_F(RefractionApplyGlTest, LeavesOddStateAsItWas) {
    const Drawn drawn = draw();
    const gl::Texture color = texture(GL_RGBA16F);
    const Environment loaded = environmentOf(smooth, {16});
    auto cube = gl::Texture::create(device().state(), "test", GL_TEXTURE_CUBE_MAP);
    gl().TextureStorage2D(cube.id(), 1, GL_RGBA16F, 8, 8);
    for (const RefractionModel model : kModels) {
        std::optional<test::OddGlState> odd(std::in_place, gl());
        const auto before = test::readGlState(gl());
        auto environment = Environment::create(device(), {.size = 16}).value();
        ASSERT_TRUE(environment.loadCubeMap(cube.id()));
        auto pyramid = Environment::create(device(), {16, EnvironmentFilter::MipPyramid}).value();
        ASSERT_TRUE(pyramid.loadCubeMap(loaded.texture()));
        Refraction refraction = prepared(model, pyramid);
        RefractionReceiver all = receiver(drawn);
        all.colorTexture = color.id();
        all.colorDepthTexture = drawn.depth.id();
        const auto applied = refraction.apply(all);
        ASSERT_TRUE(applied) << applied.error().text;
        EXPECT_THAT(test::differences(before, test::readGlState(gl())), testing::IsEmpty());
        odd.reset();
        std::size_t shown = 0;
        for (const glm::vec4& pixel : read(*applied))
            shown += pixel.a == 1.0f ? 1 : 0;
        EXPECT_GT(shown, 1000u);
    }
}

TEST_F(RefractionApplyGlTest, RefusesWhatItCannotUse) {
    const auto codeOf = [](const auto& result) { return result.error().code; };
    EXPECT_EQ(codeOf(Environment::create(device(), {.size = 48})), ErrorCode::InvalidArgument);
    EXPECT_EQ(codeOf(Refraction::create(device(), {RefractionModel::ManySurfaces, {}, 7, 0.0f})),
              ErrorCode::InvalidArgument);
    EXPECT_EQ(codeOf(Refraction::create(device(), {RefractionModel::ManySurfaces, {}, 64, 2.0f})),
              ErrorCode::InvalidArgument);
    auto environment = Environment::create(device(), {.size = 4}).value();
    EXPECT_EQ(environment.loadCubeMap(9999).error().text,
              "environment: expected the name of a cube map, found 9999, which is none");
    auto refraction = Refraction::create(device()).value();
    const Drawn drawn = draw();
    EXPECT_EQ(codeOf(refraction.apply(receiver(drawn))), ErrorCode::InvalidArgument);
    ASSERT_TRUE(refraction.prepare(object(), mView));
    EXPECT_EQ(codeOf(refraction.apply(receiver(drawn))), ErrorCode::InvalidArgument)
        << "no environment";
    refraction.setEnvironment(environment);
    EXPECT_TRUE(refraction.apply(receiver(drawn)));
    RefractionReceiver wrong = receiver(drawn);
    wrong.normalTexture = 0;
    EXPECT_EQ(codeOf(refraction.apply(wrong)), ErrorCode::InvalidArgument);
    wrong = receiver(drawn);
    wrong.view.size = {10, 10};
    EXPECT_EQ(codeOf(refraction.apply(wrong)), ErrorCode::InvalidArgument);
    RefractionSettings settings;
    settings.refractiveIndex = 0.5f;
    EXPECT_EQ(codeOf(refraction.setSettings(settings)), ErrorCode::InvalidArgument);
    settings = {};
    settings.absorption.y = std::numeric_limits<float>::quiet_NaN();
    EXPECT_EQ(codeOf(refraction.setSettings(settings)), ErrorCode::InvalidArgument);
    settings = {};
    settings.maxEvents = 0;
    EXPECT_EQ(codeOf(refraction.setSettings(settings)), ErrorCode::InvalidArgument);
    EXPECT_EQ(refraction.settings().maxEvents, 12u);
}

} // namespace
} // namespace lamina
