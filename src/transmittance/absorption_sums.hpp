#pragma once

#include "gl/device_state.hpp"
#include "transmittance/light_faces.hpp"

#include <lamina/voxelize/volume_voxelizer.hpp>

#include <span>

namespace lamina {

/// The absorption before each voxel of a light's grids ([CLN11] 3), faces one after the other in
/// one 3D texture, and the uniform buffers that describe the grids to lamina/grid.glsl.
class AbsorptionSums {
public:
    [[nodiscard]] static Result<AbsorptionSums> create(const Device& device,
                                                       std::uint32_t maxFaces);

    /// Voxelizes the sources into each face's grid and sums along its columns.
    [[nodiscard]] Result<VolumeStats> build(std::span<const GeometrySource> sources,
                                            std::span<const Material> materials,
                                            const LightFaces& faces);

    [[nodiscard]] GLuint texture() const { return mSums.id(); }
    [[nodiscard]] GLuint gridBlock(std::size_t face) const { return mGridBlocks[face].id(); }
    [[nodiscard]] std::uint64_t gpuBytes() const;

private:
    AbsorptionSums(const Device& device, VolumeVoxelizer voxelizer, VolumeGrid volume);
    [[nodiscard]] Result<void> reserve(const glm::uvec3& size);
    void scan(const glm::uvec3& size, std::size_t face);

    std::shared_ptr<gl::DeviceState> mDevice;
    VolumeVoxelizer mVoxelizer;
    VolumeGrid mVolume; ///< Of one face at a time.
    GLuint mProgram = 0;
    gl::Texture mSums;
    glm::uvec3 mSize{0};
    std::vector<gl::Buffer> mGridBlocks;
};

} // namespace lamina
