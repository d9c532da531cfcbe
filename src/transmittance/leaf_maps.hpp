#pragma once

#include "gl/device_state.hpp"
#include "transmittance/light_faces.hpp"

#include <lamina/voxelize/voxelizer.hpp>

#include <span>
#include <vector>

namespace lamina {

/// The slicemaps that count leaves before a point ([ED06] 3.1): a face of the light has one for
/// each class, one after the other in an array texture, of one place and one set of near/far
/// ranges. So six faces and any number of classes fit the least texture units that GL promises.
class LeafMaps {
public:
    [[nodiscard]] static Result<LeafMaps> create(const Device& device,
                                                 const TransmittanceDesc& desc);

    /// Voxelizes the leaves for each face. Errors: those of Voxelizer::voxelize(), OutOfMemory.
    [[nodiscard]] Result<void> build(std::span<const GeometrySource> leaves,
                                     std::span<const Material> materials, const LightFaces& faces,
                                     TransmittanceStats& stats);

    /// Binds desc.maxFaces grids of lamina/grid.glsl; faces that the light does not need get the
    /// first one's: no binding stays empty.
    void bind(GLuint uniformBufferBinding, GLuint wordUnit, GLuint rangeUnit) const;

    [[nodiscard]] std::uint64_t gpuBytes() const;

private:
    /// The classes of a face, once there are several.
    struct Face {
        gl::Buffer block;
        gl::Texture words, ranges;
    };

    LeafMaps(const Device& device, const TransmittanceDesc& desc,
             std::unique_ptr<Voxelizer> voxelizer);
    [[nodiscard]] bool isStacked() const { return mClasses > 1; }
    [[nodiscard]] Result<Face> makeFace(const glm::uvec3& size) const;
    void stack(const Face& face, const glm::uvec3& size) const;

    std::shared_ptr<gl::DeviceState> mDevice;
    std::unique_ptr<Voxelizer> mVoxelizer;
    std::uint32_t mClasses, mMaxFaces;
    bool mIsLocal;
    /// One class: a grid a face. Several: the grids of their classes, of one face at a time.
    std::vector<VoxelGrid> mGrids;
    std::vector<Face> mFaces;
    std::size_t mFaceCount = 0; ///< Of the last light.
};

} // namespace lamina
