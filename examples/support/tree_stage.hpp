#pragma once

#include "engine_mesh.hpp"
#include "host_gl.hpp"

#include <lamina/core/box.hpp>
#include <lamina/gl/view.hpp>

#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace example {

inline constexpr std::size_t kLeafClasses = 3;
inline constexpr std::uint32_t kWoodMaterial = kLeafClasses; ///< After the leaves' classes.
/// Green, reddish, yellowish.
inline constexpr std::array<glm::vec3, kLeafClasses> kLeafColors{
    glm::vec3(0.26f, 0.42f, 0.09f), {0.55f, 0.13f, 0.06f}, {0.66f, 0.50f, 0.06f}};

/// A tree on a ground plane, in an engine's buffers.
class TreeStage {
public:
    /// leavesPerTwig: of 480 twigs. size: pixels a side of the view.
    TreeStage(const HostGl& gl, int leavesPerTwig, std::uint32_t size);

    /// What the engine draws before it shades; rows from the bottom.
    struct Pixels {
        std::vector<glm::vec4> positions;       ///< World space; w 0: background.
        std::vector<glm::vec4> normals, colors; ///< Colours: alpha 1 for leaves.
    };
    /// Draws the view. inColors: leaves of each class in its colour, else all green.
    [[nodiscard]] Pixels draw(bool inColors) const;

    [[nodiscard]] const lamina::View& view() const { return mView; }
    [[nodiscard]] GLuint depthTexture() const { return mDepth; }
    [[nodiscard]] GLuint normalTexture() const { return mTargets[1]; }
    /// An RGBA texture of the view's size.
    [[nodiscard]] std::vector<glm::vec4> read(GLuint texture) const;

    /// By class; material ids are the classes'.
    [[nodiscard]] const std::array<EngineMesh, kLeafClasses>& leaves() const { return mLeaves; }
    [[nodiscard]] const EngineMesh& wood() const { return mWood; }
    [[nodiscard]] const std::array<lamina::TriangleMesh, kLeafClasses>& leafMeshes() const {
        return mLeafMeshes;
    }
    [[nodiscard]] const lamina::TriangleMesh& woodMesh() const { return mWoodMesh; }
    /// Of leaves and wood.
    [[nodiscard]] const lamina::Box3& bounds() const { return mBounds; }

private:
    void makeTargets();
    void drawMesh(const EngineMesh& mesh, const glm::vec4& albedo) const;

    const HostGl& mGl;
    std::array<lamina::TriangleMesh, kLeafClasses> mLeafMeshes;
    lamina::TriangleMesh mWoodMesh;
    lamina::Box3 mBounds;
    std::array<EngineMesh, kLeafClasses> mLeaves;
    EngineMesh mWood, mGround;
    lamina::View mView;
    GLuint mProgram = 0, mFramebuffer = 0, mDepth = 0;
    std::array<GLuint, 3> mTargets{}; ///< Positions, normals, colours.
};

} // namespace example
