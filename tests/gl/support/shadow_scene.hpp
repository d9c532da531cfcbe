#pragma once

#include "gl/device_state.hpp"

#include <lamina/shadow_volumes/shadow_volumes.hpp>

#include <glm/gtc/matrix_transform.hpp>
#include <glm/mat4x4.hpp>

#include <optional>
#include <string>
#include <vector>

namespace lamina::test {

/// A mesh in a scene.
struct ScenePart {
    TriangleMesh mesh; ///< World space.
    bool casts = true;
    CasterSurface surface = CasterSurface::Automatic;
};

/// A host's scene: meshes in GL buffers, and a depth buffer drawn by the host.
class SceneHost {
public:
    SceneHost(const Device& device, std::vector<ScenePart> parts);
    ~SceneHost();
    SceneHost(const SceneHost&) = delete;
    SceneHost& operator=(const SceneHost&) = delete;

    /// Draws all parts as the view sees them. GL name of the depth texture.
    std::uint32_t drawDepth(const View& view);

    [[nodiscard]] const std::vector<ScenePart>& parts() const { return mParts; }
    [[nodiscard]] const std::vector<ShadowCaster>& casters() const { return mCasters; }
    [[nodiscard]] const std::vector<GeometrySource>& sources() const { return mSources; }
    /// All parts that cast, as one mesh.
    [[nodiscard]] TriangleMesh casterMesh() const;
    /// All parts as one mesh.
    [[nodiscard]] TriangleMesh wholeMesh() const;

private:
    const GladGLContext& mGl;
    std::shared_ptr<gl::DeviceState> mDevice;
    std::vector<ScenePart> mParts;
    std::vector<MeshBuffers> mBuffers;
    std::vector<ShadowTopology> mTopologies;
    std::vector<ShadowCaster> mCasters;
    std::vector<GeometrySource> mSources;
    GLuint mProgram = 0;
    gl::VertexArray mVertexArray;
    gl::Framebuffer mFramebuffer;
    gl::Texture mDepths;
};

/// A perspective view.
[[nodiscard]] View lookAt(const glm::dvec3& eye, const glm::dvec3& target, const glm::uvec2& size,
                          double near = 0.1, double far = 100.0);

/// Red values of a 2D texture.
[[nodiscard]] std::vector<float> readRed(const GladGLContext& gl, std::uint32_t texture,
                                         const glm::uvec2& size);

/// Writes a grey picture (binary PGM) if the environment variable LAMINA_TEST_PICTURES names a
/// folder. values: rows from the bottom; `white` is the value of white.
void savePicture(const std::string& name, const std::vector<float>& values, const glm::uvec2& size,
                 float white);

} // namespace lamina::test
