#pragma once

#include "gl/device_state.hpp"
#include "voxelize/epipolar_constants.hpp"

#include <lamina/voxelize/epipolar_voxelizer.hpp>
#include <lamina/voxelize/geometry_source.hpp>

#include <cstdint>
#include <span>
#include <vector>

namespace lamina {

/// One depth map to draw: a layer of the texture.
struct DepthMapFace {
    glm::dmat4 worldToClip{1.0};
    bool clampsDepth = false; ///< Occluders before the map's depth range count as at its front.
};

/// The depth maps of one shadow volume, and what the rectify kernel must know about them.
struct DepthMapPlan {
    std::vector<DepthMapFace> faces;
    shared::LaminaEpipolarMap map{}; ///< Layers count from 0.
};

/// Which faces of a cube around the light the shadow volume's ranges need (one ordinary map for a
/// directional light), each fitted to the ranges. vsv: its index in the grid.
[[nodiscard]] DepthMapPlan planDepthMaps(const EpipolarTransform& transform,
                                         const EpipolarVoxelizerDesc& desc, std::uint32_t vsv);

/// The map block's part that does not depend on where depths come from: spot cone and index.
void setLight(shared::LaminaEpipolarMap& map, const EpipolarTransform& transform,
              std::uint32_t vsv);

/// Draws depth maps of geometry into the layers of one texture.
class LAMINA_API DepthMapRenderer {
public:
    DepthMapRenderer(std::shared_ptr<gl::DeviceState> device, std::uint32_t texels);

    /// Makes room for `layers` maps. Errors: DeviceLimit, OutOfMemory; what it had is then kept.
    [[nodiscard]] Result<void> reserve(std::uint32_t layers);
    /// Checks sources and builds their programs.
    [[nodiscard]] Result<std::vector<GLuint>>
    prepare(std::span<const GeometrySource> sources) const;
    /// Draws one map a layer from layer 0 on. programs: from prepare(). Leaves the GL state alone.
    void draw(std::span<const GeometrySource> sources, std::span<const GLuint> programs,
              std::span<const DepthMapFace> faces);

    [[nodiscard]] const gl::Texture& texture() const { return mDepths; }
    [[nodiscard]] std::uint64_t layerBytes() const {
        return std::uint64_t{mTexels} * mTexels * sizeof(float);
    }

private:
    [[nodiscard]] Result<GLuint> program(std::string shader, std::string hostSource) const;
    void uploadMatrices(std::span<const GeometrySource> sources,
                        std::span<const DepthMapFace> faces);

    std::shared_ptr<gl::DeviceState> mDevice;
    std::uint32_t mTexels;
    std::uint32_t mLayers = 0;
    gl::Texture mDepths;
    gl::Framebuffer mFramebuffer;
    gl::VertexArray mVertexArray;
    gl::Buffer mMatrices;
    std::vector<std::byte> mMatrixBytes;
    std::size_t mMatrixStride = 0;
};

} // namespace lamina
