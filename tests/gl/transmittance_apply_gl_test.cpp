// apply() over what a host has drawn, host shadow maps, GL state and errors.

#include "gl/state_guard.hpp"
#include "gl/support/gl_state.hpp"
#include "gl/support/host_draw.hpp"
#include "gl/support/transmittance_probe.hpp"

#include <glm/gtc/matrix_transform.hpp>
#include <gmock/gmock.h>
#include <reference/shapes.hpp>

#include <array>
#include <cmath>
#include <limits>
#include <random>

namespace lamina {
namespace {

constexpr glm::uvec2 kSize{160, 120};

/// A host that draws leaves, a ball and a floor with its own forward shader.
class TransmittanceApplyGlTest : public test::TransmittanceGlTest {
protected:
    void SetUp() override {
        TransmittanceGlTest::SetUp();
        // Leaves of a few columns, so that most pixels are far from any of their edges.
        mLeaves = reference::makeTriangleSoup({{-2, 1, -2}, {2, 3, 2}}, 120, 1.2f, 5);
        mOpaque = reference::makeIcosphere({0.5f, 2.2f, 0.3f}, 0.7f, 3);
        mScene = reference::merged(reference::merged(mLeaves, mOpaque),
                                   reference::makePlane({0, 0, 0}, {0, 1, 0}, 12.0f));
        mLeafBuffers.emplace(MeshBuffers::upload(device(), mLeaves).value());
        mOpaqueBuffers.emplace(MeshBuffers::upload(device(), mOpaque).value());
        mSceneBuffers.emplace(MeshBuffers::upload(device(), mScene).value());
        mLeafSource = mLeafBuffers->view();
        mOpaqueSource = mOpaqueBuffers->view();
        mView.worldToClip =
            glm::perspective(0.9, static_cast<double>(kSize.x) / kSize.y, 0.5, 40.0) *
            glm::lookAt(glm::dvec3(4, 5, 7), glm::dvec3(0, 1, 0), glm::dvec3(0, 1, 0));
        mView.size = kSize;
        mLight.direction = {0.3, -1.0, 0.2};
    }

    TransmittanceCasters casters() const {
        TransmittanceCasters casters;
        casters.leaves = {&mLeafSource, 1};
        casters.opaque = {&mOpaqueSource, 1};
        casters.bounds = {{-2.7, 0.3, -2.7}, {2.7, 3.7, 2.7}};
        return casters;
    }

    gl::Texture texture(GLenum format, const glm::uvec2& size = kSize) {
        return test::makeTexture(device(), format, size);
    }

    /// Depth, normals and the forward shader's T of the scene.
    struct Drawn {
        gl::Texture depth, normals, unsignedNormals, forward;
    };

    Drawn drawScene(Transmittance& transmittance) {
        constexpr std::uint32_t kBlock = 1, kUnit = 4;
        const GLuint program =
            buildProgram({{GL_VERTEX_SHADER, test::kWorldVertexShader},
                          {GL_FRAGMENT_SHADER,
                           "#version 450 core\n" + transmittance.shaderDefines(kBlock, kUnit) +
                               shaderSource("lamina/transmittance.glsl").value() + R"(
in vec3 world;
layout(location = 0) out vec4 normals;
layout(location = 1) out vec4 unsignedNormals;
layout(location = 2) out vec4 forward;
void main() {
    vec3 normal = normalize(cross(dFdx(world), dFdy(world)));
    normals = vec4(normal, 0.0);
    unsignedNormals = vec4(normal * 0.5 + 0.5, 0.0);
    forward = vec4(laminaTransmittance(world, normal), 1.0);
}
)"}});
        Drawn drawn{texture(GL_DEPTH_COMPONENT32F), texture(GL_RGBA32F), texture(GL_RGBA16),
                    texture(GL_RGBA32F)};
        const GLuint colors[] = {drawn.normals.id(), drawn.unsignedNormals.id(),
                                 drawn.forward.id()};
        const auto framebuffer = test::makeFramebuffer(device(), drawn.depth.id(), colors);
        constexpr GLfloat kOne[] = {1.0f, 1.0f, 1.0f, 1.0f};
        gl().ClearNamedFramebufferfv(framebuffer.id(), GL_COLOR, 2, kOne);
        transmittance.bind(kBlock, kUnit);
        test::drawMesh(device(), program, framebuffer.id(), kSize, mView.worldToClip,
                       mSceneBuffers->view());
        gl().DeleteProgram(program);
        return drawn;
    }

    std::vector<glm::vec4> read(GLuint texture) {
        return test::readPixels(device(), texture, kSize);
    }

    static double shareBeyond(const std::vector<glm::vec4>& first,
                              const std::vector<glm::vec4>& second, float tolerance) {
        std::size_t count = 0;
        for (std::size_t i = 0; i < first.size(); ++i)
            for (int channel = 0; channel < 4; ++channel)
                if (!(std::abs(first[i][channel] - second[i][channel]) <= tolerance)) {
                    ++count;
                    break;
                }
        return static_cast<double>(count) / static_cast<double>(first.size());
    }

    TriangleMesh mLeaves, mOpaque, mScene;
    std::optional<MeshBuffers> mLeafBuffers, mOpaqueBuffers, mSceneBuffers;
    GeometrySource mLeafSource, mOpaqueSource;
    View mView;
    TransmittanceLight mLight;
};

TEST_F(TransmittanceApplyGlTest, AgreesWithTheEnginesForwardShader) {
    struct Case {
        TransmittanceModel model;
        bool local;
        LightKind kind;
        std::uint32_t classes = 1;
    };
    for (const Case& test : {Case{TransmittanceModel::LeafCount, false, LightKind::Directional},
                             Case{TransmittanceModel::LeafCount, true, LightKind::Directional},
                             Case{TransmittanceModel::Absorption, false, LightKind::Directional},
                             Case{TransmittanceModel::LeafCount, true, LightKind::Spot},
                             Case{TransmittanceModel::LeafCount, true, LightKind::Point},
                             Case{TransmittanceModel::LeafCount, true, LightKind::Point, 3},
                             Case{TransmittanceModel::Absorption, false, LightKind::Point}}) {
        SCOPED_TRACE(std::to_string(static_cast<int>(test.model)) + " light " +
                     std::to_string(static_cast<int>(test.kind)) + (test.local ? " local" : ""));
        TransmittanceDesc desc;
        desc.model = test.model;
        desc.size = {64, 64, 64};
        desc.localRanges = test.local;
        desc.classes = test.classes;
        desc.opaqueMapTexels = 256;
        desc.maxFaces = test.kind == LightKind::Point ? 6 : 1;
        auto transmittance = Transmittance::create(device(), desc).value();
        mLight.kind = test.kind;
        mLight.position =
            test.kind == LightKind::Point ? glm::dvec3(-0.7, 2.4, -0.6) : glm::dvec3(0.0, 6.0, 0.0);
        mLight.direction = {0.3, -1.0, 0.2};
        std::vector<Material> materials(1);
        materials[0].absorption = 0.3f;
        TransmittanceCasters all = casters();
        all.materials = materials;
        const auto stats = transmittance.prepare(mLight, all);
        ASSERT_TRUE(stats) << stats.error().text;
        const Drawn drawn = drawScene(transmittance);
        const auto forward = read(drawn.forward.id());

        gl().TextureParameteri(drawn.depth.id(), GL_TEXTURE_COMPARE_MODE,
                               GL_COMPARE_REF_TO_TEXTURE);
        TransmittanceReceiver receiver{mView, drawn.depth.id(), drawn.normals.id()};
        const auto applied = transmittance.apply(receiver);
        ASSERT_TRUE(applied) << applied.error().text;
        const auto deferred = read(*applied);
        // World points from the depth buffer are off by its rounding: at the edges of columns, of
        // local ranges and of the opaque map that moves a few pixels to the other side.
        EXPECT_LT(shareBeyond(forward, deferred, 2e-3f), 0.01);

        const gl::Texture own = texture(GL_RGBA32F);
        ASSERT_TRUE(transmittance.apply(receiver, own.id()));
        EXPECT_EQ(shareBeyond(read(own.id()), deferred, 1e-3f), 0.0); // half floats: 2^-11
        receiver.normalTexture = drawn.unsignedNormals.id();
        receiver.normalEncoding = NormalEncoding::Unsigned;
        ASSERT_TRUE(transmittance.apply(receiver, own.id()));
        EXPECT_LT(shareBeyond(read(own.id()), deferred, 2e-3f), 0.01);
        receiver.normalTexture = 0;
        ASSERT_TRUE(transmittance.apply(receiver, own.id()));
        // At the outlines of surfaces normals from depths are wrong.
        EXPECT_LT(shareBeyond(read(own.id()), deferred, 1e-2f), 0.12);

        std::size_t lit = 0, dark = 0, between = 0;
        for (const glm::vec4& value : deferred) {
            lit += value.x == 1.0f ? 1 : 0;
            dark += value.x == 0.0f ? 1 : 0;
            between += value.x > 0.0f && value.x < 1.0f ? 1 : 0;
        }
        EXPECT_GT(lit, deferred.size() / 50);
        EXPECT_GT(between, deferred.size() / 20);
        EXPECT_GT(dark, deferred.size() / 100);
    }
}

TEST_F(TransmittanceApplyGlTest, HostShadowMapsOfAllKinds) {
    const GLuint program =
        buildProgram({{GL_VERTEX_SHADER, test::kWorldVertexShader},
                      {GL_FRAGMENT_SHADER, "#version 450 core\nvoid main() {}\n"}});
    std::mt19937 random(1);
    std::uniform_real_distribution<double> unit(-3.0, 3.0);
    std::vector<test::ProbePoint> points;
    for (int i = 0; i < 20000; ++i)
        points.push_back({{unit(random), unit(random), unit(random)}});
    auto transmittance =
        Transmittance::create(device(), {.size = {64, 64, 64}, .maxFaces = 6}).value();
    constexpr glm::uvec2 kMap{512, 512};
    const auto framebuffer = test::makeFramebuffer(device(), 0, {});
    const MeshView opaque = mOpaqueBuffers->view();

    // The ball fills most of one face of the cube after the other.
    const glm::dvec3 ball(0.5, 2.2, 0.3);
    struct Case {
        DepthMapKind kind;
        glm::dvec3 position{0.0};
    };
    for (const auto& [kind, position] :
         {Case{DepthMapKind::Texture2D}, Case{DepthMapKind::TextureArray},
          Case{DepthMapKind::TextureCube, ball + glm::dvec3(1.5, 0.3, 0.4)},
          Case{DepthMapKind::TextureCube, ball - glm::dvec3(1.5, -0.3, 0.4)},
          Case{DepthMapKind::TextureCube, ball + glm::dvec3(0.4, 1.5, 0.3)},
          Case{DepthMapKind::TextureCube, ball - glm::dvec3(0.4, 1.5, -0.3)},
          Case{DepthMapKind::TextureCube, ball + glm::dvec3(0.4, -0.3, 1.5)},
          Case{DepthMapKind::TextureCube, ball - glm::dvec3(-0.4, -0.3, 1.5)}}) {
        SCOPED_TRACE(std::to_string(static_cast<int>(kind)) + " x " + std::to_string(position.x) +
                     " y " + std::to_string(position.y));
        LightDepthMap map;
        map.kind = kind;
        GLuint id = 0;
        if (kind == DepthMapKind::TextureCube) {
            mLight.kind = LightKind::Point;
            mLight.position = position;
            map.faceProjection = glm::perspective(glm::radians(90.0), 1.0, 0.05, 20.0);
            gl().CreateTextures(GL_TEXTURE_CUBE_MAP, 1, &id);
            gl().TextureStorage2D(id, 1, GL_DEPTH_COMPONENT24, kMap.x, kMap.y);
            constexpr glm::dvec3 kAlong[] = {{1, 0, 0},  {-1, 0, 0}, {0, 1, 0},
                                             {0, -1, 0}, {0, 0, 1},  {0, 0, -1}};
            constexpr glm::dvec3 kUp[] = {{0, -1, 0}, {0, -1, 0}, {0, 0, 1},
                                          {0, 0, -1}, {0, -1, 0}, {0, -1, 0}};
            for (int face = 0; face < 6; ++face) {
                gl().NamedFramebufferTextureLayer(framebuffer.id(), GL_DEPTH_ATTACHMENT, id, 0,
                                                  face);
                test::drawMesh(device(), program, framebuffer.id(), kMap,
                               map.faceProjection * glm::lookAt(mLight.position,
                                                                mLight.position + kAlong[face],
                                                                kUp[face]),
                               opaque);
            }
        } else {
            mLight.direction = {0.3, -1.0, 0.2};
            map.worldToClip =
                glm::ortho(-5.0, 5.0, -4.0, 6.0, 1.0, 12.0) *
                glm::lookAt(-6.0 * mLight.direction, glm::dvec3(0.0), glm::dvec3(0, 0, 1));
            const bool isArray = kind == DepthMapKind::TextureArray;
            if (isArray) {
                gl().CreateTextures(GL_TEXTURE_2D_ARRAY, 1, &id);
                gl().TextureStorage3D(id, 1, GL_DEPTH_COMPONENT32F, kMap.x, kMap.y, 3);
                map.layer = 1;
                gl().NamedFramebufferTextureLayer(framebuffer.id(), GL_DEPTH_ATTACHMENT, id, 0, 1);
                test::drawMesh(device(), program, framebuffer.id(), kMap, map.worldToClip, opaque);
            } else {
                // As glTexImage2D leaves it, larger than the part in use.
                const gl::Texture part = texture(GL_DEPTH_COMPONENT16, kMap);
                gl().NamedFramebufferTexture(framebuffer.id(), GL_DEPTH_ATTACHMENT, part.id(), 0);
                test::drawMesh(device(), program, framebuffer.id(), kMap, map.worldToClip, opaque);
                gl().GenTextures(1, &id);
                gl().BindTexture(GL_TEXTURE_2D, id);
                gl().TexImage2D(GL_TEXTURE_2D, 0, GL_DEPTH_COMPONENT16, 700, 600, 0,
                                GL_DEPTH_COMPONENT, GL_FLOAT, nullptr);
                gl().TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
                gl().TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAX_LEVEL, 0);
                gl().BindTexture(GL_TEXTURE_2D, 0);
                map.firstTexel = {100, 50};
                map.size = kMap;
                gl().CopyImageSubData(part.id(), GL_TEXTURE_2D, 0, 0, 0, 0, id, GL_TEXTURE_2D, 0,
                                      100, 50, 0, kMap.x, kMap.y, 1);
            }
        }
        map.texture = id;
        TransmittanceCasters all = casters();
        auto stats = transmittance.prepare(mLight, all);
        ASSERT_TRUE(stats) << stats.error().text;
        const auto own = probe(transmittance, points);
        all.opaque = {};
        all.opaqueMap = &map;
        stats = transmittance.prepare(mLight, all);
        ASSERT_TRUE(stats) << stats.error().text;
        gl().DeleteTextures(1, &id);
        const auto host = probe(transmittance, points);
        std::size_t differing = 0, dark = 0;
        for (std::size_t i = 0; i < points.size(); ++i) {
            differing += std::abs(own[i].x - host[i].x) > 0.5f * own[i].x + 1e-3f ? 1 : 0;
            dark += host[i].x == 0.0f ? 1 : 0;
        }
        // Only where the ball's outline is filtered through other texels.
        EXPECT_LT(differing, points.size() / 100);
        EXPECT_GT(dark, points.size() / 100);

        map.size = {5000, 1};
        map.texture = mView.size.x + 12345;
        const auto refused = transmittance.prepare(mLight, all);
        ASSERT_FALSE(refused);
        EXPECT_EQ(refused.error().code, ErrorCode::InvalidArgument);
    }
    gl().DeleteProgram(program);
}

TEST_F(TransmittanceApplyGlTest, LeavesOddStateAsItWasAndHeedsNoneOfIt) {
    struct Case {
        TransmittanceDesc desc;
        LightKind kind = LightKind::Directional;
    };
    std::vector<Case> cases{
        {{.size = {32, 32, 64}}},
        {{.model = TransmittanceModel::Absorption, .size = {32, 32, 64}}},
        {{.size = {32, 32, 160}, .localRanges = true, .classes = 3, .maxFaces = 6},
         LightKind::Point}};
    std::vector<Material> materials(1);
    materials[0].absorption = 0.3f;
    materials[0].colorClass = 0;
    for (const Case& test : cases) {
        mLight.kind = test.kind;
        mLight.position = {-0.7, 2.4, -0.6};
        TransmittanceCasters all = casters();
        all.materials = materials;
        auto usual = Transmittance::create(device(), test.desc).value();
        ASSERT_TRUE(usual.prepare(mLight, all));
        const Drawn drawn = drawScene(usual);
        const TransmittanceReceiver receiver{mView, drawn.depth.id(), drawn.normals.id()};
        const auto expected = read(usual.apply(receiver).value());
        ASSERT_GT(
            shareBeyond(expected, std::vector<glm::vec4>(expected.size(), glm::vec4(1.0f)), 0.1f),
            0.01);

        LightDepthMap map;
        map.texture = drawn.depth.id();
        std::vector<glm::vec4> found;
        {
            const test::OddGlState odd(gl());
            const auto before = test::readGlState(gl());
            const auto expectUnchanged = [&](const char* what) {
                EXPECT_THAT(test::differences(before, test::readGlState(gl())), testing::IsEmpty())
                    << what;
                EXPECT_EQ(gl().GetError(), static_cast<GLenum>(GL_NO_ERROR)) << what;
            };
            std::optional<Transmittance> transmittance(
                Transmittance::create(device(), test.desc).value());
            expectUnchanged("create");
            ASSERT_TRUE(transmittance->setSettings({}));
            expectUnchanged("setSettings");
            if (test.kind == LightKind::Directional) {
                TransmittanceCasters hosts = all;
                hosts.opaqueMap = &map;
                ASSERT_TRUE(transmittance->prepare(mLight, hosts));
                expectUnchanged("prepare with a host map");
            }
            ASSERT_TRUE(transmittance->prepare(mLight, all));
            expectUnchanged("prepare");
            EXPECT_FALSE(transmittance->prepare(mLight, {}));
            expectUnchanged("failed prepare");
            ASSERT_TRUE(transmittance->prepare(mLight, all));
            const auto applied = transmittance->apply(receiver);
            ASSERT_TRUE(applied);
            expectUnchanged("apply");
            EXPECT_FALSE(transmittance->apply({mView, 0}));
            expectUnchanged("failed apply");
            {
                const gl::PixelPackGuard pack(*device().state());
                found = read(*applied);
            }
            transmittance.reset();
            expectUnchanged("destruction");
        }
        EXPECT_TRUE(found == expected);
    }
}

TEST_F(TransmittanceApplyGlTest, ErrorsSayWhatIsWrong) {
    const auto codeOf = [&](const TransmittanceDesc& desc) {
        const auto made = Transmittance::create(device(), desc);
        return made ? std::string() : made.error().text;
    };
    EXPECT_EQ(codeOf({}), "");
    EXPECT_THAT(codeOf({.classes = 0}), testing::HasSubstr("1 to 8 classes"));
    EXPECT_THAT(codeOf({.classes = 9}), testing::HasSubstr("1 to 8 classes"));
    EXPECT_THAT(codeOf({.maxFaces = 0}), testing::HasSubstr("1 to 6 faces"));
    EXPECT_THAT(codeOf({.maxFaces = 7}), testing::HasSubstr("1 to 6 faces"));
    EXPECT_THAT(codeOf({.opaqueMapTexels = 0}), testing::HasSubstr("opaque shadow map"));
    EXPECT_THAT(codeOf({.model = TransmittanceModel::Absorption, .localRanges = true}),
                testing::HasSubstr("local ranges"));

    auto transmittance = Transmittance::create(device(), {.size = {32, 32, 32}}).value();
    const gl::Texture depth = texture(GL_DEPTH_COMPONENT32F);
    EXPECT_THAT(transmittance.apply({mView, depth.id()}).error().text,
                testing::HasSubstr("prepare()"));
    TransmittanceSettings settings;
    settings.attenuation[3].y = 1.5f;
    EXPECT_EQ(transmittance.setSettings(settings).error().code, ErrorCode::InvalidArgument);
    settings = {};
    settings.filterWidth = 8.0f;
    EXPECT_EQ(transmittance.setSettings(settings).error().code, ErrorCode::InvalidArgument);
    EXPECT_EQ(transmittance.settings().filterWidth, 1.0f);

    TransmittanceCasters wrong = casters();
    wrong.bounds = {};
    EXPECT_THAT(transmittance.prepare(mLight, wrong).error().text, testing::HasSubstr("bounds"));
    TransmittanceLight light = mLight;
    light.direction = glm::dvec3(0.0);
    EXPECT_THAT(transmittance.prepare(light, casters()).error().text,
                testing::HasSubstr("direction"));
    light.kind = LightKind::Spot;
    light.direction = mLight.direction;
    light.coneAngle = 1.5;
    EXPECT_THAT(transmittance.prepare(light, casters()).error().text,
                testing::HasSubstr("cone angle"));
    light.coneAngle = 0.5;
    light.near = 0.0;
    EXPECT_THAT(transmittance.prepare(light, casters()).error().text, testing::HasSubstr("near"));
    MeshView broken = std::get<MeshView>(mLeafSource);
    broken.indexCount *= 2;
    const GeometrySource sources[] = {broken};
    wrong = casters();
    wrong.leaves = sources;
    EXPECT_EQ(transmittance.prepare(mLight, wrong).error().code, ErrorCode::InvalidArgument);

    ASSERT_TRUE(transmittance.prepare(mLight, casters()));
    EXPECT_THAT(transmittance.apply({mView, 0}).error().text, testing::HasSubstr("depth"));
    const gl::Texture small = texture(GL_RGBA16F, {8, 8});
    EXPECT_THAT(transmittance.apply({mView, depth.id(), small.id()}).error().text,
                testing::HasSubstr("8 x 8"));
    EXPECT_THAT(transmittance.apply({mView, depth.id()}, small.id()).error().text,
                testing::HasSubstr("target"));
    View view = mView;
    view.size = {0, 0};
    EXPECT_EQ(transmittance.apply({view, depth.id()}).error().code, ErrorCode::InvalidArgument);
    EXPECT_TRUE(transmittance.apply({mView, depth.id()}));
}

TEST_F(TransmittanceApplyGlTest, BadLightsAndGridsAreRefused) {
    constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
    auto transmittance =
        Transmittance::create(device(), {.size = {32, 32, 32}, .maxFaces = 6}).value();
    const auto expectRefused = [&](const TransmittanceLight& light, const char* text) {
        const auto prepared = transmittance.prepare(light, casters());
        ASSERT_FALSE(prepared) << text;
        EXPECT_EQ(prepared.error().code, ErrorCode::InvalidArgument);
        EXPECT_THAT(prepared.error().text, testing::HasSubstr(text));
    };
    TransmittanceLight light = mLight;
    for (const glm::dvec3& direction :
         {glm::dvec3(kNan, -1, 0), glm::dvec3(0, 1e200, 1e200), glm::dvec3(0.0)}) {
        light.direction = direction;
        light.kind = LightKind::Directional;
        expectRefused(light, "direction");
        light.kind = LightKind::Spot;
        expectRefused(light, "direction");
    }
    light = mLight;
    light.kind = LightKind::Point;
    light.position.z = kNan;
    expectRefused(light, "position");
    light.position = {0.0, 2.0, 0.0};
    light.near = kNan;
    expectRefused(light, "near");
    light.near = 0.01;
    light.direction = glm::dvec3(kNan); // Of no use to a point light.
    ASSERT_TRUE(transmittance.prepare(light, casters()));
    for (const glm::vec3& value : probe(transmittance, std::array{test::ProbePoint{{0, 1, 0}}}))
        EXPECT_TRUE(value.x >= 0.0f && value.x <= 1.0f);

    EXPECT_THAT(Transmittance::create(device(), {.size = {32, 0, 32}}).error().text,
                testing::HasSubstr("32 x 0 x 32"));
    for (const glm::uvec3& size :
         {glm::uvec3(100'000, 16, 16), glm::uvec3(16, 16, 1u << 20), glm::uvec3((1u << 31) - 1)})
        for (const TransmittanceModel model :
             {TransmittanceModel::LeafCount, TransmittanceModel::Absorption}) {
            auto large = Transmittance::create(device(), {.model = model, .size = size}).value();
            const auto prepared = large.prepare(mLight, casters());
            ASSERT_FALSE(prepared);
            EXPECT_EQ(prepared.error().code, ErrorCode::DeviceLimit) << prepared.error().text;
            const gl::Texture depth = texture(GL_DEPTH_COMPONENT32F);
            EXPECT_THAT(large.apply({mView, depth.id()}).error().text,
                        testing::HasSubstr("prepare()"));
        }
    auto opaque =
        Transmittance::create(device(), {.size = {16, 16, 16}, .opaqueMapTexels = 1u << 20})
            .value();
    EXPECT_EQ(opaque.prepare(mLight, casters()).error().code, ErrorCode::DeviceLimit);
    for (const float sigma : {-0.01f, 1.01f, std::numeric_limits<float>::quiet_NaN()}) {
        TransmittanceSettings settings;
        settings.attenuation[0].z = sigma;
        EXPECT_THAT(transmittance.setSettings(settings).error().text,
                    testing::HasSubstr("attenuation in [0,1]"));
    }
    EXPECT_EQ(gl().GetError(), static_cast<GLenum>(GL_NO_ERROR));
}

TEST_F(TransmittanceApplyGlTest, ValuesOfNoEnumerationAreRefused) {
    const auto expectRefused = [](const auto& result, const char* text) {
        ASSERT_FALSE(result) << text;
        EXPECT_EQ(result.error().code, ErrorCode::InvalidArgument);
        EXPECT_THAT(result.error().text, testing::HasSubstr(text));
    };
    expectRefused(Transmittance::create(device(), {.model = static_cast<TransmittanceModel>(9)}),
                  "TransmittanceModel, found 9");
    auto transmittance = Transmittance::create(device(), {.size = {32, 32, 32}}).value();
    TransmittanceSettings settings;
    settings.slices = static_cast<SliceLookup>(7);
    expectRefused(transmittance.setSettings(settings), "SliceLookup, found 7");
    settings = {};
    settings.absorptionForm = static_cast<AbsorptionForm>(7);
    expectRefused(transmittance.setSettings(settings), "AbsorptionForm, found 7");
    TransmittanceLight light = mLight;
    light.kind = static_cast<LightKind>(9);
    expectRefused(transmittance.prepare(light, casters()), "LightKind, found 9");
    ASSERT_TRUE(transmittance.prepare(mLight, casters()));
    const gl::Texture depth = texture(GL_DEPTH_COMPONENT32F);
    expectRefused(transmittance.apply({mView, depth.id(), 0, static_cast<NormalEncoding>(9)}),
                  "NormalEncoding, found 9");
}

TEST_F(TransmittanceApplyGlTest, MatricesAndBoundsOfNoFloatAreRefused) {
    auto transmittance = Transmittance::create(device(), {.size = {32, 32, 32}}).value();
    TransmittanceCasters wrong = casters();
    wrong.bounds = {glm::dvec3(-1e300), glm::dvec3(1e300)};
    auto prepared = transmittance.prepare(mLight, wrong);
    ASSERT_FALSE(prepared);
    EXPECT_EQ(prepared.error().code, ErrorCode::InvalidArgument);
    EXPECT_THAT(prepared.error().text, testing::HasSubstr("bounds"));

    const gl::Texture depth = texture(GL_DEPTH_COMPONENT32F);
    LightDepthMap map{.texture = depth.id()};
    wrong = casters();
    wrong.opaque = {};
    wrong.opaqueMap = &map;
    ASSERT_TRUE(transmittance.prepare(mLight, wrong));
    for (const double value : {std::numeric_limits<double>::quiet_NaN(), 0.0, 1e300}) {
        map.worldToClip = glm::dmat4(value);
        prepared = transmittance.prepare(mLight, wrong);
        ASSERT_FALSE(prepared) << value;
        EXPECT_EQ(prepared.error().code, ErrorCode::InvalidArgument);
        EXPECT_THAT(prepared.error().text, testing::HasSubstr("worldToClip"));
    }
    map = {.texture = depth.id(), .kind = DepthMapKind::HemisphereArray};
    prepared = transmittance.prepare(mLight, wrong);
    ASSERT_FALSE(prepared);
    EXPECT_THAT(prepared.error().text, testing::HasSubstr("DepthMapKind value 3"));
}

TEST_F(TransmittanceApplyGlTest, TargetsThatAreReadAreRefused) {
    auto transmittance = Transmittance::create(device(), {.size = {32, 32, 32}}).value();
    ASSERT_TRUE(transmittance.prepare(mLight, casters()));
    const gl::Texture depth = texture(GL_R32F);
    const gl::Texture normals = texture(GL_RGBA16F);
    for (const GLuint target : {depth.id(), normals.id()}) {
        const auto applied = transmittance.apply({mView, depth.id(), normals.id()}, target);
        ASSERT_FALSE(applied);
        EXPECT_EQ(applied.error().code, ErrorCode::InvalidArgument);
        EXPECT_THAT(applied.error().text, testing::HasSubstr("a target that is not read"));
    }
}

TEST_F(TransmittanceApplyGlTest, TexturesOfOtherFormatsAreRefused) {
    auto transmittance = Transmittance::create(device(), {.size = {32, 32, 32}}).value();
    ASSERT_TRUE(transmittance.prepare(mLight, casters()));
    const gl::Texture depth = texture(GL_DEPTH_COMPONENT32F);
    const gl::Texture target = texture(GL_RGBA8);
    ASSERT_TRUE(transmittance.apply({mView, depth.id()}, target.id()));
    const auto before = read(target.id());
    for (const GLenum format : {GL_RGBA8UI, GL_R32I, GL_RGB9_E5, GL_DEPTH_COMPONENT24}) {
        const gl::Texture wrong = texture(format);
        const auto applied = transmittance.apply({mView, depth.id()}, wrong.id());
        ASSERT_FALSE(applied) << format;
        EXPECT_EQ(applied.error().code, ErrorCode::InvalidArgument);
        EXPECT_THAT(applied.error().text, testing::HasSubstr("target"));
        if (format == GL_RGB9_E5)
            continue; // Can be read.
        const auto shaded = transmittance.apply({mView, depth.id(), wrong.id()}, target.id());
        ASSERT_FALSE(shaded) << format;
        EXPECT_THAT(shaded.error().text, testing::HasSubstr("normals"));
        if (format == GL_DEPTH_COMPONENT24)
            continue;
        const auto behind = transmittance.apply({mView, wrong.id()}, target.id());
        ASSERT_FALSE(behind) << format;
        EXPECT_THAT(behind.error().text, testing::HasSubstr("depth"));
    }
    EXPECT_EQ(shareBeyond(read(target.id()), before, 0.0f), 0.0);
    EXPECT_EQ(gl().GetError(), static_cast<GLenum>(GL_NO_ERROR));
}

TEST_F(TransmittanceApplyGlTest, BindTakesWhatItSays) {
    auto transmittance =
        Transmittance::create(device(), {.size = {32, 32, 32}, .localRanges = true, .classes = 3})
            .value();
    EXPECT_EQ(transmittance.uniformBufferCount(), 2u);
    EXPECT_EQ(transmittance.textureUnitCount(), 4u);
    const auto before = test::readGlState(gl());
    transmittance.bind(2, 3);
    EXPECT_THAT(test::differences(before, test::readGlState(gl())), testing::IsEmpty());
    ASSERT_TRUE(transmittance.prepare(mLight, casters()));
    transmittance.bind(2, 3);
    EXPECT_THAT(test::differences(before, test::readGlState(gl())),
                testing::Not(testing::IsEmpty()));
    EXPECT_GT(transmittance.gpuBytes(), std::uint64_t{3} * 32 * 32 * 16);
    EXPECT_LE(transmittance.gpuBytes(), device().allocatedBytes());
}

} // namespace
} // namespace lamina
