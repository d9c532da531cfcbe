#pragma once

#include "gl/glad.hpp"

#include <lamina/area_light/area_light.hpp>
#include <lamina/voxelize/epipolar_transform.hpp>

#include <reference/epipolar_rays.hpp>

#include <vector>

namespace lamina::test {

/// The engine's side of a fog test: what a camera sees of a mesh, by ray casting, as depth and
/// normal textures.
class FogScene {
public:
    FogScene(const GladGLContext& gl, const TriangleMesh& mesh, const GridCamera& camera,
             const glm::uvec2& pixels);
    ~FogScene();
    FogScene(const FogScene&) = delete;
    FogScene& operator=(const FogScene&) = delete;

    [[nodiscard]] const View& view() const { return mView; }
    [[nodiscard]] SurfaceTextures surfaces() const;
    [[nodiscard]] const reference::ShadowRays& rays() const { return mRays; }
    [[nodiscard]] const glm::dvec3& eye() const { return mEye; }
    [[nodiscard]] std::size_t pixelCount() const { return mPoints.size(); }
    [[nodiscard]] bool isSky(std::size_t pixel) const { return mIsSky[pixel]; }
    /// World point of a pixel; of the sky one far away.
    [[nodiscard]] const glm::dvec3& point(std::size_t pixel) const { return mPoints[pixel]; }
    [[nodiscard]] const glm::dvec3& normal(std::size_t pixel) const { return mNormals[pixel]; }

    /// Texels of a float RGBA texture of the view's size.
    [[nodiscard]] std::vector<glm::vec4> read(GLuint texture) const;

private:
    const GladGLContext& mGl;
    reference::ShadowRays mRays;
    View mView;
    glm::dvec3 mEye{0.0};
    std::vector<glm::dvec3> mPoints;
    std::vector<glm::dvec3> mNormals;
    std::vector<bool> mIsSky;
    GLuint mDepth = 0;
    GLuint mNormal = 0;
};

/// A rectangle above and behind what the scenes show, for tests to which its picture is all one.
[[nodiscard]] RectangleLight smallRectangle(std::uint32_t texture = 0);

/// Few lights, voxels and texels, of no round numbers.
[[nodiscard]] AreaLightDesc smallDesc();

} // namespace lamina::test
