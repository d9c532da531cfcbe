#pragma once

#include "gl/program_cache.hpp"

#include <lamina/core/box.hpp>
#include <lamina/voxelize/volume_voxelizer.hpp>

#include <glm/vec4.hpp>

#include <optional>
#include <span>

namespace lamina {

/// The surfaces of an object in a cube of voxels, for rays that march through it ([CLN11] 4): a
/// plane a voxel, and optics where materials differ. Made by three VolumeVoxelizer passes, which
/// look along x, y and z, so that no surface has gaps.
class OpticalVolume {
public:
    [[nodiscard]] static Result<OpticalVolume> create(const Device& device, std::uint32_t voxels,
                                                      float slabOverlap);

    /// Errors: those of VolumeVoxelizer::voxelize(), InvalidArgument (bounds); the volume is then
    /// undefined.
    [[nodiscard]] Result<VolumeStats> build(std::span<const GeometrySource> sources,
                                            std::span<const Material> materials,
                                            const Box3& bounds);

    /// Binds planes, optics and bricks to three units from `unit`.
    void bind(GLuint unit) const;

    /// Low corner, voxels per world unit.
    [[nodiscard]] const glm::vec4& place() const { return mPlace; }
    [[nodiscard]] std::uint32_t voxels() const { return mVoxels; }
    /// Refractive index and transmittance per world unit that all materials share.
    [[nodiscard]] const std::optional<glm::vec4>& sharedOptics() const { return mSharedOptics; }
    [[nodiscard]] std::uint64_t gpuBytes() const;

private:
    OpticalVolume(std::shared_ptr<gl::DeviceState> device, VolumeVoxelizer voxelizer,
                  VolumeGrid planesAlong, VolumeGrid opticsAlong, std::uint32_t voxels)
        : mDevice(std::move(device))
        , mVoxelizer(std::move(voxelizer))
        , mPlanesAlong(std::move(planesAlong))
        , mOpticsAlong(std::move(opticsAlong))
        , mVoxels(voxels) {}

    [[nodiscard]] Result<void> reserve();
    [[nodiscard]] Result<void> merge(const VolumeGrid& along, int axis);

    std::shared_ptr<gl::DeviceState> mDevice;
    VolumeVoxelizer mVoxelizer;
    VolumeGrid mPlanesAlong; ///< Along one axis: normals and offsets.
    VolumeGrid mOpticsAlong; ///< Normals, optics and colours.
    std::uint32_t mVoxels;
    gl::Texture mPlanes, mOptics, mBricks;
    std::optional<glm::vec4> mSharedOptics;
    glm::vec4 mPlace{0.0f};
};

} // namespace lamina
