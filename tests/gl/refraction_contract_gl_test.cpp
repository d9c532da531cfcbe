// What refraction refuses, and that nothing is lost by it.

#include "gl/support/ball_frame.hpp"

#include <reference/shapes.hpp>

#include <limits>
#include <optional>
#include <string>

namespace lamina {
namespace {

namespace ref = reference;
using test::Ball;
using test::kRefractionModels;
using test::kSize;
using RefractionContractGlTest = test::BallFrameTest;

TEST_F(RefractionContractGlTest, RefusesTexturesOfTheWrongKind) {
    const Ball ball{{0, 0, 0}, 1.0};
    auto buffers = MeshBuffers::upload(device(), ref::makeIcosphere({0, 0, 0}, 1.0f, 3)).value();
    const GeometrySource source = buffers.view();
    const GBuffer drawn = draw({&ball, 1});
    const Environment environment = whiteEnvironment();
    Refraction refraction = create(RefractionModel::ManySurfaces, environment);
    ASSERT_TRUE(
        refraction.prepare({{&source, 1}, {&mClear, 1}, {glm::dvec3(-1), glm::dvec3(1)}}, mView));
    const gl::Texture integers = test::makeTexture(device(), GL_RGBA32UI, kSize);
    const gl::Texture shared = test::makeTexture(device(), GL_RGB9_E5, kSize);
    const gl::Texture floats = test::makeTexture(device(), GL_RGBA16F, kSize);
    const gl::Texture otherDepths = test::makeTexture(device(), GL_R32F, kSize);
    const gl::Texture small = test::makeTexture(device(), GL_RGBA16F, {8, 8});
    const auto refused = [&](auto&& change, const std::string& text) {
        RefractionReceiver receiver = receiverOf(drawn);
        GLuint target = floats.id();
        change(receiver, target);
        const auto applied = refraction.apply(receiver, target);
        ASSERT_FALSE(applied) << text;
        EXPECT_EQ(applied.error().code, ErrorCode::InvalidArgument);
        EXPECT_NE(applied.error().text.find(text), std::string::npos) << applied.error().text;
    };
    using Receiver = RefractionReceiver;
    refused([&](Receiver& r, GLuint&) { r.depthTexture = integers.id(); }, "depths");
    refused([&](Receiver& r, GLuint&) { r.depthTexture = small.id(); }, "8 x 8");
    refused([&](Receiver& r, GLuint&) { r.normalTexture = integers.id(); }, "normal texture");
    refused([&](Receiver& r, GLuint&) { r.objectTexture = floats.id(); }, "an object texture");
    refused([&](Receiver& r, GLuint&) { r.colorTexture = integers.id(); }, "colour texture");
    refused([&](Receiver& r, GLuint&) { r.colorTexture = small.id(); }, "8 x 8");
    refused(
        [&](Receiver& r, GLuint&) {
            r.colorTexture = floats.id();
            r.colorDepthTexture = integers.id();
        },
        "behind");
    refused([&](Receiver&, GLuint& target) { target = integers.id(); }, "target");
    refused([&](Receiver&, GLuint& target) { target = shared.id(); }, "drawn to");
    refused([&](Receiver&, GLuint& target) { target = environment.texture(); },
            "which is no 2D texture");
    refused([&](Receiver&, GLuint& target) { target = 9999; }, "which is none");
    const std::string loop = "in both places";
    refused([&](Receiver& r, GLuint& target) { target = r.normalTexture; }, loop);
    refused([&](Receiver& r, GLuint& target) { target = r.depthTexture; }, loop);
    refused(
        [&](Receiver& r, GLuint& target) {
            r.colorTexture = floats.id();
            target = r.colorDepthTexture = otherDepths.id();
        },
        loop);
    refused([&](Receiver& r, GLuint&) { r.view.size = {0, 4}; }, "at least 1 x 1");
    RefractionReceiver both = receiverOf(drawn);
    both.colorTexture = floats.id();
    EXPECT_TRUE(refraction.apply(both, floats.id())) << "colours are copied";
    EXPECT_TRUE(refraction.apply(receiverOf(drawn), floats.id())) << "nothing is lost";
}

TEST_F(RefractionContractGlTest, RefusesSurroundingsOfTheWrongKind) {
    auto environment = Environment::create(device(), {.size = 4}).value();
    const auto cubeOf = [&](GLenum format) {
        auto cube = gl::Texture::create(device().state(), "test", GL_TEXTURE_CUBE_MAP);
        if (format != GL_NONE)
            gl().TextureStorage2D(cube.id(), 1, format, 4, 4);
        return cube;
    };
    const gl::Texture floats = test::makeTexture(device(), GL_RGBA16F, {8, 4});
    const gl::Texture integers = test::makeTexture(device(), GL_RGBA32UI, {8, 4});
    const gl::Texture depths = test::makeTexture(device(), GL_DEPTH_COMPONENT32F, {8, 4});
    const gl::Texture empty = gl::Texture::create(device().state(), "test", GL_TEXTURE_2D);
    // Only level 0 of a pyramid.
    const gl::Texture pyramid = gl::Texture::create(device().state(), "test", GL_TEXTURE_2D);
    gl().BindTexture(GL_TEXTURE_2D, pyramid.id());
    gl().TexImage2D(GL_TEXTURE_2D, 0, GL_RGBA16F, 8, 4, 0, GL_RGBA, GL_FLOAT, nullptr);
    gl().BindTexture(GL_TEXTURE_2D, 0);
    const gl::Texture cube = cubeOf(GL_RGBA16F);
    const gl::Texture cubeOfIntegers = cubeOf(GL_RGBA32UI);
    const gl::Texture cubeOfDepths = cubeOf(GL_DEPTH_COMPONENT32F);
    const gl::Texture cubeOfNothing = cubeOf(GL_NONE);
    const auto refused = [](const Result<void>& loaded, const std::string& text) {
        ASSERT_FALSE(loaded) << text;
        EXPECT_EQ(loaded.error().code, ErrorCode::InvalidArgument);
        EXPECT_NE(loaded.error().text.find(text), std::string::npos) << loaded.error().text;
    };
    refused(environment.loadEquirectangular(9999), "9999, which is none");
    refused(environment.loadEquirectangular(cube.id()), "which is no 2D texture");
    refused(environment.loadEquirectangular(integers.id()), "format");
    refused(environment.loadEquirectangular(depths.id()), "format");
    refused(environment.loadEquirectangular(empty.id()), "incomplete");
    refused(environment.loadEquirectangular(pyramid.id()), "incomplete");
    refused(environment.loadCubeMap(floats.id()), "which is no cube map");
    refused(environment.loadCubeMap(cubeOfIntegers.id()), "format");
    refused(environment.loadCubeMap(cubeOfDepths.id()), "format");
    refused(environment.loadCubeMap(cubeOfNothing.id()), "incomplete");
    EXPECT_TRUE(environment.loadEquirectangular(floats.id()));
    EXPECT_TRUE(environment.loadCubeMap(cube.id()));
    gl().TextureParameteri(pyramid.id(), GL_TEXTURE_MIN_FILTER, GL_LINEAR);
    EXPECT_TRUE(environment.loadEquirectangular(pyramid.id()));
}

TEST_F(RefractionContractGlTest, RefusesValuesOutsideTheirEnumerations) {
    const auto refused = [](const auto& result, const std::string& text) {
        ASSERT_FALSE(result) << text;
        EXPECT_EQ(result.error().code, ErrorCode::InvalidArgument);
        EXPECT_NE(result.error().text.find(text), std::string::npos) << result.error().text;
    };
    RefractionDesc desc;
    desc.model = static_cast<RefractionModel>(9);
    refused(Refraction::create(device(), desc), "a value of RefractionModel, found 9");
    refused(ThicknessMap::create(device(), {.method = static_cast<IntegralMethod>(7)}),
            "a value of IntegralMethod, found 7");
    refused(Environment::create(device(), {.filter = static_cast<EnvironmentFilter>(9)}),
            "a value of EnvironmentFilter, found 9");
    auto refraction = Refraction::create(device()).value();
    RefractionSettings settings;
    settings.attenuation = static_cast<AttenuationModel>(5);
    refused(refraction.setSettings(settings), "a value of AttenuationModel, found 5");
}

/// In words that do not allow what they refuse.
TEST_F(RefractionContractGlTest, NamesSettingsOutOfRange) {
    auto refraction = Refraction::create(device()).value();
    const auto textOf = [&](auto&& change) {
        RefractionSettings settings;
        change(settings);
        const auto set = refraction.setSettings(settings);
        return set ? std::string("accepted") : set.error().text;
    };
    const float infinity = std::numeric_limits<float>::infinity();
    using Settings = RefractionSettings;
    EXPECT_EQ(textOf([](Settings& s) { s.exponent = 0.0f; }),
              "refraction: expected a finite exponent above 0, found 0.000000");
    EXPECT_EQ(textOf([](Settings& s) { s.opaqueLength = 0.0f; }),
              "refraction: expected a finite opaque length above 0, found 0.000000");
    EXPECT_EQ(textOf([&](Settings& s) { s.absorption.x = infinity; }),
              "refraction: expected a finite absorption of 0.000000 or more, found inf");
    EXPECT_EQ(textOf([](Settings& s) { s.sameSurfaceAngle = 0.0f; }),
              "refraction: expected an angle of the same surface above 0, at most 1.570796, found "
              "0.000000");
    EXPECT_EQ(textOf([](Settings& s) { s.reflection = 2.0f; }),
              "refraction: expected a reflection of 0.000000 to 1.000000, found 2.000000");
}

/// Lengths whose squares are beyond floats.
TEST_F(RefractionContractGlTest, NormalsOfAnyLengthShowTheSame) {
    const Ball ball{{0, 0, 0}, 1.0};
    auto buffers = MeshBuffers::upload(device(), ref::makeIcosphere({0, 0, 0}, 1.0f, 3)).value();
    const GeometrySource source = buffers.view();
    const GBuffer drawn = draw({&ball, 1});
    const std::vector<glm::vec4> unit = read(drawn.normals.id());
    const Environment environment = environmentOf(
        [](const glm::vec3& d) { return 0.5f + 0.5f * glm::normalize(d); }, {.size = 8});
    Material glass;
    glass.refractiveIndex = 1.5f;
    for (const RefractionModel model : kRefractionModels) {
        Refraction refraction = create(model, environment);
        ASSERT_TRUE(refraction.prepare({{&source, 1}, {&glass, 1}, {glm::dvec3(-1), glm::dvec3(1)}},
                                       mView));
        const auto expected = read(refraction.apply(receiverOf(drawn)).value());
        for (const float length : {1e-30f, 1e-25f, 1e25f, 1e30f}) {
            std::vector<glm::vec4> normals;
            for (const glm::vec4& normal : unit)
                normals.push_back(normal * length);
            const gl::Texture scaled = texture(GL_RGBA32F, GL_RGBA, GL_FLOAT, normals);
            RefractionReceiver receiver = receiverOf(drawn);
            receiver.normalTexture = scaled.id();
            const auto pixels = read(refraction.apply(receiver).value());
            std::size_t apart = 0;
            for (std::size_t i = 0; i < pixels.size(); ++i)
                apart += glm::distance(pixels[i], expected[i]) < 0.01f ? 0 : 1;
            EXPECT_LE(apart, pixels.size() / 500) << length << ' ' << static_cast<int>(model);
        }
    }
}

/// What cannot be prepared says so; the next object can.
TEST_F(RefractionContractGlTest, RefusesObjectsAndGoesOn) {
    const Ball ball{{0, 0, 0}, 1.0};
    auto buffers = MeshBuffers::upload(device(), ref::makeIcosphere({0, 0, 0}, 1.0f, 3)).value();
    const GeometrySource source = buffers.view();
    const GBuffer drawn = draw({&ball, 1});
    const Environment environment = whiteEnvironment();
    const Box3 bounds{glm::dvec3(-1), glm::dvec3(1)};
    for (const RefractionModel model : kRefractionModels) {
        Refraction refraction = create(model, environment);
        const auto codeOf = [&](const RefractionObject& object) {
            const auto prepared = refraction.prepare(object, mView);
            return prepared ? std::optional<ErrorCode>{} : prepared.error().code;
        };
        const double nowhere = std::numeric_limits<double>::quiet_NaN();
        EXPECT_EQ(codeOf({{&source, 1}, {}, Box3{}}), ErrorCode::InvalidArgument);
        EXPECT_EQ(codeOf({{&source, 1}, {}, {glm::dvec3(nowhere), glm::dvec3(1)}}),
                  ErrorCode::InvalidArgument);
        EXPECT_EQ(codeOf({{&source, 1}, {}, {glm::dvec3(0), glm::dvec3(0)}}),
                  ErrorCode::InvalidArgument);
        EXPECT_EQ(codeOf({{&source, 1}, {}, {glm::dvec3(-1e300), glm::dvec3(1e300)}}),
                  ErrorCode::InvalidArgument);
        if (model != RefractionModel::VolumeIntegral) {
            EXPECT_EQ(codeOf({{&source, 1}, {}, {glm::dvec3(-1e30), glm::dvec3(1e30)}}),
                      ErrorCode::InvalidArgument);
        }
        MeshView beyond = buffers.view();
        beyond.indexCount += 3;
        const GeometrySource unfit = beyond;
        EXPECT_EQ(codeOf({{&unfit, 1}, {}, bounds}), ErrorCode::InvalidArgument);
        if (model != RefractionModel::VolumeIntegral) {
            for (const float index : {0.9f, 4.1f, 1e30f, std::numeric_limits<float>::quiet_NaN(),
                                      std::numeric_limits<float>::infinity()}) {
                Material odd = mClear;
                odd.refractiveIndex = index;
                EXPECT_EQ(codeOf({{&source, 1}, {&odd, 1}, bounds}), ErrorCode::InvalidArgument);
            }
            MeshView other = buffers.view();
            other.materialId = 1;
            const GeometrySource stranger = other;
            EXPECT_EQ(codeOf({{&stranger, 1}, {&mClear, 1}, bounds}), ErrorCode::InvalidArgument);
        }
        EXPECT_EQ(refraction.apply(receiverOf(drawn)).error().code, ErrorCode::InvalidArgument)
            << "nothing is prepared";
        device().setMemoryBudget(1);
        Refraction fresh = std::move(refraction);
        const auto poor = fresh.prepare({{&source, 1}, {&mClear, 1}, bounds}, mView);
        ASSERT_FALSE(poor);
        EXPECT_EQ(poor.error().code, ErrorCode::OutOfMemory) << poor.error().text;
        device().setMemoryBudget(0);
        EXPECT_TRUE(fresh.prepare({{&source, 1}, {&mClear, 1}, bounds}, mView));
        EXPECT_TRUE(fresh.apply(receiverOf(drawn)));
        EXPECT_TRUE(fresh.prepare({{}, {}, {glm::dvec3(-1, -1, 0), glm::dvec3(1, 1, 0)}}, mView))
            << "a flat box is no point";
    }
}

} // namespace
} // namespace lamina
