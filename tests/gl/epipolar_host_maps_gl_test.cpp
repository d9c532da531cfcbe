// Shadow volumes from depth maps that the host drew: every kind of texture and depth convention.

#include "gl/support/gl_test.hpp"

#include <lamina/voxelize/epipolar_voxelizer.hpp>

#include <reference/epipolar_agreement.hpp>
#include <reference/shapes.hpp>

#include <glm/gtc/matrix_transform.hpp>

#include <gmock/gmock.h>

#include <array>

namespace lamina {
namespace {

using testing::HasSubstr;

const GridCamera kEye = reference::frontEye();

/// Draws depth maps as a host would, with a renderer of its own.
class EpipolarHostMapsGlTest : public test::GlTest {
protected:
    void SetUp() override {
        GlTest::SetUp();
        mBuffers.emplace(MeshBuffers::upload(device(), mScene).value());
        mProgram = buildProgram({{GL_VERTEX_SHADER, R"(#version 450 core
layout(location = 0) in vec3 place;
uniform mat4 worldToClip;
void main() { gl_Position = worldToClip * vec4(place, 1.0); })"}});
        gl().CreateFramebuffers(1, &mFramebuffer);
        gl().NamedFramebufferDrawBuffer(mFramebuffer, GL_NONE);
        gl().CreateVertexArrays(1, &mVertexArray);
        gl().EnableVertexArrayAttrib(mVertexArray, 0);
        gl().VertexArrayAttribFormat(mVertexArray, 0, 3, GL_FLOAT, GL_FALSE, 0);
        gl().VertexArrayAttribBinding(mVertexArray, 0, 0);
        gl().VertexArrayVertexBuffer(mVertexArray, 0, mBuffers->view().vertexBuffer, 0, 12);
        gl().VertexArrayElementBuffer(mVertexArray, mBuffers->view().indexBuffer);
    }
    void TearDown() override {
        gl().DeleteTextures(static_cast<GLsizei>(mTextures.size()), mTextures.data());
        gl().DeleteFramebuffers(1, &mFramebuffer);
        gl().DeleteVertexArrays(1, &mVertexArray);
        gl().DeleteProgram(mProgram);
        mBuffers.reset();
        GlTest::TearDown();
    }

    GLuint depthTexture(GLenum target, GLenum format, const glm::ivec3& size) {
        GLuint texture = 0;
        gl().CreateTextures(target, 1, &texture);
        if (target == GL_TEXTURE_2D_ARRAY)
            gl().TextureStorage3D(texture, 1, format, size.x, size.y, size.z);
        else
            gl().TextureStorage2D(texture, 1, format, size.x, size.y);
        // As hosts set their shadow maps up: comparing, filtered.
        gl().TextureParameteri(texture, GL_TEXTURE_COMPARE_MODE, GL_COMPARE_REF_TO_TEXTURE);
        gl().TextureParameteri(texture, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
        mTextures.push_back(texture);
        return texture;
    }

    /// Draws the scene into a part of the bound layer. layer: of an array or cube, or -1.
    void drawDepths(GLuint texture, int layer, const glm::ivec4& part,
                    const glm::dmat4& worldToClip, bool isReversed) {
        const GladGLContext& gl = this->gl();
        if (layer < 0)
            gl.NamedFramebufferTexture(mFramebuffer, GL_DEPTH_ATTACHMENT, texture, 0);
        else
            gl.NamedFramebufferTextureLayer(mFramebuffer, GL_DEPTH_ATTACHMENT, texture, 0, layer);
        gl.BindFramebuffer(GL_FRAMEBUFFER, mFramebuffer);
        gl.Viewport(part.x, part.y, part.z, part.w);
        gl.Scissor(part.x, part.y, part.z, part.w);
        gl.Enable(GL_SCISSOR_TEST);
        gl.Enable(GL_DEPTH_TEST);
        gl.DepthFunc(isReversed ? GL_GREATER : GL_LESS);
        gl.ClipControl(GL_LOWER_LEFT, isReversed ? GL_ZERO_TO_ONE : GL_NEGATIVE_ONE_TO_ONE);
        const GLfloat empty = isReversed ? 0.0f : 1.0f;
        gl.ClearBufferfv(GL_DEPTH, 0, &empty);
        const glm::mat4 matrix(worldToClip);
        gl.ProgramUniformMatrix4fv(mProgram, gl.GetUniformLocation(mProgram, "worldToClip"), 1,
                                   GL_FALSE, &matrix[0][0]);
        gl.UseProgram(mProgram);
        gl.BindVertexArray(mVertexArray);
        gl.DrawElements(GL_TRIANGLES, static_cast<GLsizei>(mBuffers->view().indexCount),
                        GL_UNSIGNED_INT, nullptr);
        gl.BindVertexArray(0);
        gl.UseProgram(0);
        gl.ClipControl(GL_LOWER_LEFT, GL_NEGATIVE_ONE_TO_ONE);
        gl.DepthFunc(GL_LESS);
        gl.Disable(GL_DEPTH_TEST);
        gl.Disable(GL_SCISSOR_TEST);
        gl.BindFramebuffer(GL_FRAMEBUFFER, 0);
    }

    void expectAgreement(const EpipolarBits& bits, std::size_t vsv, std::size_t count = 20000) {
        const reference::Agreement found = compareWithRays(bits, vsv, mRays, kEye, count);
        EXPECT_GT(found.lit, found.points / 10);
        EXPECT_LT(found.lit, found.points * 95 / 100);
        EXPECT_LE(found.disagreements, found.points / 50);
        EXPECT_EQ(found.unproved, 0u);
    }

    const TriangleMesh mScene = reference::makeFenceScene();
    const reference::ShadowRays mRays{mScene};
    std::optional<MeshBuffers> mBuffers;
    GLuint mProgram = 0;
    GLuint mFramebuffer = 0;
    GLuint mVertexArray = 0;
    std::vector<GLuint> mTextures;
};

const EpipolarLight kSpot{.kind = LightKind::Spot,
                          .position = {2.0, 2.8, -3.0},
                          .direction = {-0.5, -0.6, 0.8},
                          .coneAngle = 0.5};
const EpipolarLight kSun{.kind = LightKind::Directional, .direction = {0.7, -0.6, 0.3}};
const EpipolarLight kLamp{.position = {0.6, 2.2, -2.6}};

glm::dmat4 spotToClip() {
    return glm::perspective(1.05, 1.0, 0.1, 20.0) *
           glm::lookAt(kSpot.position, kSpot.position + kSpot.direction, glm::dvec3(0, 1, 0));
}
glm::dmat4 sunToClip() {
    return glm::ortho(-6.5, 6.5, -6.5, 6.5, 0.0, 24.0) *
           glm::lookAt(-12.0 * kSun.direction, glm::dvec3(0), glm::dvec3(0, 1, 0));
}
/// Depth near / distance, in [0,1]: reversed and without a far plane.
glm::dmat4 reversedPerspective(double near) {
    glm::dmat4 matrix(0.0);
    matrix[0][0] = matrix[1][1] = 1.0;
    matrix[2][3] = -1.0;
    matrix[3][2] = near;
    return matrix;
}
/// The views of GL's cube map faces, in their order.
std::array<glm::dmat4, 6> cubeViews(const glm::dvec3& from) {
    const glm::dvec3 x(1, 0, 0);
    const glm::dvec3 y(0, 1, 0);
    const glm::dvec3 z(0, 0, 1);
    return {glm::lookAt(from, from + x, -y), glm::lookAt(from, from - x, -y),
            glm::lookAt(from, from + y, z),  glm::lookAt(from, from - y, -z),
            glm::lookAt(from, from + z, -y), glm::lookAt(from, from - z, -y)};
}

EpipolarTransform fitted(const EpipolarLight& light) {
    return EpipolarTransform::fit(kEye, light, {512, 512, 512}).value();
}

TEST_F(EpipolarHostMapsGlTest, PartsOfOneTexture) {
    const GLuint texture = depthTexture(GL_TEXTURE_2D, GL_DEPTH_COMPONENT24, {4200, 2300, 1});
    drawDepths(texture, -1, {60, 100, 2048, 2048}, spotToClip(), false);
    drawDepths(texture, -1, {2150, 7, 2048, 2048}, sunToClip(), false);
    LightDepthMap spot;
    spot.texture = texture;
    spot.firstTexel = {60, 100};
    spot.size = {2048, 2048};
    spot.worldToClip = spotToClip();
    LightDepthMap sun = spot;
    sun.firstTexel = {2150, 7};
    sun.worldToClip = sunToClip();
    const LightDepthMap maps[] = {spot, sun};
    const EpipolarTransform transforms[] = {fitted(kSpot), fitted(kSun)};
    auto voxelizer = EpipolarVoxelizer::create(device()).value();
    auto grid = EpipolarGrid::create(device()).value();
    const auto stats = voxelizer.voxelize(maps, transforms, grid);
    ASSERT_TRUE(stats) << stats.error().text;
    EXPECT_EQ(stats->batches, 1u);
    EXPECT_EQ(stats->depthBytes, 0u);
    const EpipolarBits bits = grid.download().value();
    expectAgreement(bits, 0);
    expectAgreement(bits, 1);
}

TEST_F(EpipolarHostMapsGlTest, ALayerOfAReversedArray) {
    const GLuint texture =
        depthTexture(GL_TEXTURE_2D_ARRAY, GL_DEPTH_COMPONENT32F, {2048, 2048, 3});
    const glm::dmat4 worldToClip =
        reversedPerspective(0.05) *
        glm::lookAt(kSpot.position, kSpot.position + kSpot.direction, glm::dvec3(0, 1, 0));
    drawDepths(texture, 2, {0, 0, 2048, 2048}, worldToClip, true);
    LightDepthMap map;
    map.texture = texture;
    map.kind = DepthMapKind::TextureArray;
    map.layer = 2;
    map.worldToClip = worldToClip;
    map.zeroToOneDepth = true;
    map.emptyDepth = 0.0f;
    const EpipolarTransform transform = fitted(kSpot);
    auto voxelizer = EpipolarVoxelizer::create(device()).value();
    auto grid = EpipolarGrid::create(device()).value();
    ASSERT_TRUE(voxelizer.voxelize({&map, 1}, {&transform, 1}, grid));
    expectAgreement(grid.download().value(), 0);
}

TEST_F(EpipolarHostMapsGlTest, CubeMapsOfBothConventions) {
    auto voxelizer = EpipolarVoxelizer::create(device()).value();
    auto grid = EpipolarGrid::create(device()).value();
    const EpipolarTransform transform = fitted(kLamp);
    for (const bool isReversed : {false, true}) {
        const GLuint texture =
            depthTexture(GL_TEXTURE_CUBE_MAP, GL_DEPTH_COMPONENT32F, {2048, 2048, 6});
        LightDepthMap map;
        map.texture = texture;
        map.kind = DepthMapKind::TextureCube;
        map.faceProjection = isReversed ? reversedPerspective(0.02)
                                        : glm::perspective(glm::radians(90.0), 1.0, 0.05, 30.0);
        map.zeroToOneDepth = isReversed;
        map.emptyDepth = isReversed ? 0.0f : 1.0f;
        const auto views = cubeViews(kLamp.position);
        for (int face = 0; face < 6; ++face)
            drawDepths(texture, face, {0, 0, 2048, 2048},
                       map.faceProjection * views[static_cast<std::size_t>(face)], isReversed);
        ASSERT_TRUE(voxelizer.voxelize({&map, 1}, {&transform, 1}, grid));
        SCOPED_TRACE(isReversed);
        expectAgreement(grid.download().value(), 0);
    }
}

TEST_F(EpipolarHostMapsGlTest, RaysThatMissTheMapAreLit) {
    const GLuint texture = depthTexture(GL_TEXTURE_2D, GL_DEPTH_COMPONENT24, {64, 64, 1});
    drawDepths(texture, -1, {0, 0, 64, 64}, spotToClip(), false);
    LightDepthMap map;
    map.texture = texture;
    map.worldToClip = spotToClip();
    EpipolarLight lamp = kLamp;
    lamp.position = kSpot.position;
    const EpipolarTransform transform = fitted(lamp);
    auto voxelizer = EpipolarVoxelizer::create(device()).value();
    auto grid = EpipolarGrid::create(device()).value();
    ASSERT_TRUE(voxelizer.voxelize({&map, 1}, {&transform, 1}, grid));
    const EpipolarBits bits = grid.download().value();
    EXPECT_TRUE(bits.lit(0, {3.5, -1.0, -3.9}));  // under the floor, outside the map
    EXPECT_FALSE(bits.lit(0, {0.0, -1.0, -0.5})); // under the floor, inside
}

TEST_F(EpipolarHostMapsGlTest, RefusesMapsThatDoNotFit) {
    const GLuint flat = depthTexture(GL_TEXTURE_2D, GL_DEPTH_COMPONENT24, {64, 32, 1});
    GLuint integers = 0;
    gl().CreateTextures(GL_TEXTURE_2D, 1, &integers);
    gl().TextureStorage2D(integers, 1, GL_R32UI, 8, 8);
    mTextures.push_back(integers);
    auto voxelizer = EpipolarVoxelizer::create(device()).value();
    auto grid = EpipolarGrid::create(device()).value();
    LightDepthMap good;
    good.texture = flat;
    good.worldToClip = spotToClip();
    const auto errorOf = [&](const LightDepthMap& map, const EpipolarLight& light) {
        const EpipolarTransform transform = fitted(light);
        const auto result = voxelizer.voxelize({&map, 1}, {&transform, 1}, grid);
        EXPECT_EQ(grid.texture(), 0u);
        return result ? std::string("no error") : result.error().text;
    };
    LightDepthMap map = good;
    map.texture = 12345;
    EXPECT_THAT(errorOf(map, kSpot), HasSubstr("expected the name of a GL texture, found 12345"));
    map = good;
    map.kind = DepthMapKind::TextureCube;
    EXPECT_THAT(errorOf(map, kSpot), HasSubstr("a texture of the kind that the map names"));
    map = good;
    map.texture = integers;
    EXPECT_THAT(errorOf(map, kSpot), HasSubstr("depth or float format"));
    map = good;
    map.firstTexel = {60, 0};
    map.size = {5, 32};
    EXPECT_THAT(errorOf(map, kSpot),
                HasSubstr("inside the texture of 64 x 32 texels, found 5 x 32 from 60 x 0"));
    EXPECT_THAT(errorOf(good, kLamp), HasSubstr("projection meet in the light"));
    EXPECT_THAT(errorOf(good, kSun), HasSubstr("projection meet in the light"));
    map = good;
    map.worldToClip[1][1] = NAN;
    EXPECT_THAT(errorOf(map, kSpot), HasSubstr("finite worldToClip"));
    map = good;
    map.worldToClip = glm::dmat4(0.0);
    EXPECT_THAT(errorOf(map, kSpot), HasSubstr("found a singular one"));
    const EpipolarTransform two[] = {fitted(kSpot), fitted(kSpot)};
    EXPECT_THAT(voxelizer.voxelize({&good, 1}, two, grid).error().text,
                HasSubstr("each of the 2 transforms, found 1"));
}

} // namespace
} // namespace lamina
