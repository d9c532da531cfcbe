#pragma once

#include <lamina/core/export.hpp>
#include <lamina/core/result.hpp>
#include <lamina/gl/device.hpp>
#include <lamina/grid/bit_grid.hpp>
#include <lamina/grid/grid_transform.hpp>

#include <cstdint>
#include <memory>

namespace lamina {

/// Voxels in GL memory, one bit each: the result of a Voxelizer, and what shaders query.
///
/// A `GL_RGBA32UI` 2D array texture of columns x by columns y, one layer per 128 slices: bit (k &
/// 31) of component (k >> 5) & 3 of layer k >> 7 is slice k. A uniform buffer holds the grid's
/// constants.
/// `#include <lamina/grid.glsl>` queries both. Reused across frames: memory is allocated again only
/// when the number of columns or layers changes. Move-only; see Device for threads and lifetime.
class LAMINA_API VoxelGrid {
public:
    /// An empty grid of no size; a Voxelizer, resize() or upload() gives it one.
    /// Errors: OutOfMemory (for the 16 KiB uniform buffer).
    [[nodiscard]] static Result<VoxelGrid> create(const Device& device);

    VoxelGrid(VoxelGrid&&) noexcept;
    VoxelGrid& operator=(VoxelGrid&&) noexcept;
    ~VoxelGrid();

    /// Takes the shape and place of `transform`; the voxels' values are then undefined. For hosts
    /// that write the texture themselves; a Voxelizer does it by itself.
    /// Errors: DeviceLimit, OutOfMemory; the grid is then unchanged.
    [[nodiscard]] Result<void> resize(const GridTransform& transform);

    /// Takes shape, place and voxels of `bits`. GL: no barrier needed before queries.
    /// Errors: as resize(); the grid is then unchanged.
    [[nodiscard]] Result<void> upload(const BitGrid& bits);

    /// The voxels, copied to host memory. Waits for the GPU.
    /// Errors: InvalidArgument on a grid of no size, OutOfMemory.
    [[nodiscard]] Result<BitGrid> download() const;

    /// Binds grid number `grid` of lamina/grid.glsl: the uniform buffer to binding
    /// uniformBufferBinding + grid, the texture (and no sampler object) to unit textureUnit + grid,
    /// where the bases are LAMINA_GRID_BLOCK_BINDING and LAMINA_GRID_TEXTURE_UNIT of the shader.
    /// Does nothing on a grid of no size. GL: these two bindings (and the sampler binding of the
    /// unit) are what it changes; the caller restores them if need be.
    void bind(std::uint32_t uniformBufferBinding = 0, std::uint32_t textureUnit = 0,
              std::uint32_t grid = 0) const;

    /// Where the voxels are; nothing for a grid of no size.
    [[nodiscard]] const GridTransform* transform() const;
    /// GL name of the texture; 0 for a grid of no size.
    [[nodiscard]] std::uint32_t texture() const;
    /// GL name of the uniform buffer.
    [[nodiscard]] std::uint32_t uniformBuffer() const;
    /// Bytes of GL memory held.
    [[nodiscard]] std::uint64_t gpuBytes() const;

private:
    struct Impl;
    explicit VoxelGrid(std::unique_ptr<Impl> impl);
    std::unique_ptr<Impl> mImpl;
};

} // namespace lamina
