#include "gl/support/fog_scene.hpp"

#include <glm/geometric.hpp>
#include <glm/gtc/matrix_transform.hpp>
#include <glm/matrix.hpp>

#include <cmath>

namespace lamina::test {

FogScene::FogScene(const GladGLContext& gl, const TriangleMesh& mesh, const GridCamera& camera,
                   const glm::uvec2& pixels)
    : mGl(gl)
    , mRays(mesh) {
    mView.worldToClip = glm::frustum(camera.left, camera.right, camera.bottom, camera.top,
                                     camera.near, camera.far) *
                        camera.worldToEye;
    mView.size = pixels;
    mEye = glm::dvec3(glm::inverse(camera.worldToEye)[3]);
    const glm::dmat4 clipToWorld = glm::inverse(mView.worldToClip);
    std::vector<float> depths;
    std::vector<glm::vec4> normals;
    const auto directionAt = [&](const glm::dvec2& pixel) {
        const glm::dvec2 clip = 2.0 * pixel / glm::dvec2(pixels) - 1.0;
        const glm::dvec4 point = clipToWorld * glm::dvec4(clip, 0.0, 1.0);
        return glm::normalize(glm::dvec3(point) / point.w - mEye);
    };
    for (std::uint32_t y = 0; y < pixels.y; ++y)
        for (std::uint32_t x = 0; x < pixels.x; ++x) {
            const glm::dvec2 center(x + 0.5, y + 0.5);
            const glm::dvec3 direction = directionAt(center);
            const double distance = mRays.firstHit(mEye, direction);
            const glm::dvec4 clip =
                mView.worldToClip * glm::dvec4(mEye + distance * direction, 1.0);
            const bool isSky = std::isinf(distance) || clip.z > clip.w;
            mIsSky.push_back(isSky);
            depths.push_back(isSky ? 1.0f : static_cast<float>(0.5 * clip.z / clip.w + 0.5));
            constexpr double kFar = 1e4;
            mPoints.push_back(mEye + (isSky ? kFar : distance) * direction);
            // The plane through hits close by.
            constexpr double kApart = 1e-3;
            glm::dvec3 normal(0.0);
            if (!isSky) {
                const auto hit = [&](const glm::dvec2& offset) {
                    const glm::dvec3 beside = directionAt(center + offset);
                    return mEye + mRays.firstHit(mEye, beside) * beside;
                };
                normal = glm::cross(hit({kApart, 0.0}) - hit({-kApart, 0.0}),
                                    hit({0.0, kApart}) - hit({0.0, -kApart}));
                normal = glm::length(normal) > 0.0 ? glm::normalize(normal) : glm::dvec3(0.0);
            }
            mNormals.push_back(normal);
            normals.emplace_back(glm::vec3(normal), 0.0f);
        }
    const auto width = static_cast<GLsizei>(pixels.x);
    const auto height = static_cast<GLsizei>(pixels.y);
    mGl.CreateTextures(GL_TEXTURE_2D, 1, &mDepth);
    mGl.TextureStorage2D(mDepth, 1, GL_R32F, width, height);
    mGl.TextureSubImage2D(mDepth, 0, 0, 0, width, height, GL_RED, GL_FLOAT, depths.data());
    mGl.CreateTextures(GL_TEXTURE_2D, 1, &mNormal);
    mGl.TextureStorage2D(mNormal, 1, GL_RGBA32F, width, height);
    mGl.TextureSubImage2D(mNormal, 0, 0, 0, width, height, GL_RGBA, GL_FLOAT, normals.data());
}

FogScene::~FogScene() {
    mGl.DeleteTextures(1, &mDepth);
    mGl.DeleteTextures(1, &mNormal);
}

SurfaceTextures FogScene::surfaces() const {
    SurfaceTextures surfaces;
    surfaces.depth = mDepth;
    surfaces.normal = mNormal;
    return surfaces;
}

std::vector<glm::vec4> FogScene::read(GLuint texture) const {
    GLint width = 0;
    GLint height = 0;
    mGl.GetTextureLevelParameteriv(texture, 0, GL_TEXTURE_WIDTH, &width);
    mGl.GetTextureLevelParameteriv(texture, 0, GL_TEXTURE_HEIGHT, &height);
    std::vector<glm::vec4> texels(static_cast<std::size_t>(width) *
                                  static_cast<std::size_t>(height));
    mGl.GetTextureImage(texture, 0, GL_RGBA, GL_FLOAT,
                        static_cast<GLsizei>(texels.size() * sizeof texels[0]), texels.data());
    return texels;
}

RectangleLight smallRectangle(std::uint32_t texture) {
    RectangleLight light;
    light.corner = {-1.0, 2.6, -3.0};
    light.edgeU = {2.0, 0.0, 0.0};
    light.edgeV = {0.0, 1.0, 0.4};
    light.emission.texture = texture;
    return light;
}

AreaLightDesc smallDesc() {
    AreaLightDesc desc;
    desc.virtualLights = 20;
    desc.voxels = {32, 24, 130};
    desc.mapTexels = 33;
    desc.imperfect = {4096, 1024, 3};
    return desc;
}

} // namespace lamina::test
