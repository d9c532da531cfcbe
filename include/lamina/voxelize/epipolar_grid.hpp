#pragma once

#include <lamina/core/export.hpp>
#include <lamina/core/result.hpp>
#include <lamina/gl/device.hpp>
#include <lamina/voxelize/epipolar_bits.hpp>

#include <cstdint>
#include <memory>
#include <span>

namespace lamina {

/// Voxelized shadow volumes in GL memory: what an EpipolarVoxelizer makes and shaders query
/// (`#include <lamina/epipolar.glsl>`).
///
/// A `GL_RGBA32UI` 2D array texture in which each shadow volume owns a tile of alpha x theta
/// texels; each texel holds 128 (or 127) phi samples, further ones are in further layers. A storage
/// buffer holds the volumes' constants. Reused across frames: memory is allocated again only for
/// volumes of another size or for more of them than ever before. Move-only; see Device for threads
/// and lifetime.
class LAMINA_API EpipolarGrid {
public:
    /// A grid without shadow volumes; a voxelizer, resize() or upload() gives it some.
    /// Errors: InvalidArgument (see EpipolarBits::create()).
    [[nodiscard]] static Result<EpipolarGrid> create(const Device& device,
                                                     const EpipolarLayout& layout = {});

    EpipolarGrid(EpipolarGrid&&) noexcept;
    EpipolarGrid& operator=(EpipolarGrid&&) noexcept;
    ~EpipolarGrid();

    /// Takes the shadow volumes of `transforms`; the voxels' values are then undefined.
    /// Errors: InvalidArgument (none, different sizes), DeviceLimit, OutOfMemory; the grid is then
    /// unchanged.
    [[nodiscard]] Result<void> resize(std::span<const EpipolarTransform> transforms);

    /// Takes layout, shadow volumes and voxels of `bits`. GL: no barrier needed before queries.
    /// Errors: as resize(); the grid is then unchanged.
    [[nodiscard]] Result<void> upload(const EpipolarBits& bits);

    /// The voxels, copied to host memory. Waits for the GPU.
    /// Errors: InvalidArgument on a grid without shadow volumes, OutOfMemory.
    [[nodiscard]] Result<EpipolarBits> download() const;

    /// Binds what lamina/epipolar.glsl reads: the storage buffer to storageBinding
    /// (LAMINA_EPIPOLAR_BLOCK_BINDING) and the texture, without a sampler object, to textureUnit
    /// (LAMINA_EPIPOLAR_TEXTURE_UNIT). Does nothing on a grid without shadow volumes. GL: these two
    /// bindings (and the sampler binding of the unit) are what it changes; the caller restores
    /// them.
    void bind(std::uint32_t storageBinding = 0, std::uint32_t textureUnit = 0) const;

    [[nodiscard]] std::span<const EpipolarTransform> transforms() const;
    [[nodiscard]] const EpipolarLayout& layout() const;
    /// First texel of a shadow volume's tile in the texture. vsv: in range (asserted).
    [[nodiscard]] glm::uvec2 tile(std::uint32_t vsv) const;
    /// Layers of the texture.
    [[nodiscard]] std::uint32_t groupCount() const;
    /// GL name of the texture; 0 for a grid without shadow volumes.
    [[nodiscard]] std::uint32_t texture() const;
    /// GL name of the storage buffer; 0 for a grid without shadow volumes.
    [[nodiscard]] std::uint32_t buffer() const;
    /// Bytes of GL memory held.
    [[nodiscard]] std::uint64_t gpuBytes() const;
    /// Building block for Lamina's own modules; not part of the stable API.
    [[nodiscard]] const gl::DeviceState* deviceState() const;

private:
    struct Impl;
    explicit EpipolarGrid(std::unique_ptr<Impl> impl);
    std::unique_ptr<Impl> mImpl;
};

} // namespace lamina
