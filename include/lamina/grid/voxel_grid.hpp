#pragma once

#include <lamina/core/export.hpp>
#include <lamina/core/result.hpp>
#include <lamina/gl/device.hpp>
#include <lamina/grid/bit_grid.hpp>
#include <lamina/grid/grid_transform.hpp>

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string_view>

namespace lamina {

/// Where a VoxelGrid keeps its words. The words and their order are the same.
enum class VoxelStore : std::uint8_t {
    Texture, ///< GL_RGBA32UI 2D array texture, a layer per 128 slices: what raster backends draw
             ///< to.
    Buffer,  ///< GL buffer, seen as a GL_RGBA32UI texel buffer: what compute backends write to.
};

[[nodiscard]] LAMINA_API std::string_view name(VoxelStore store); ///< "texture"

/// What the slices of a VoxelGrid divide.
enum class SliceRanges : std::uint8_t {
    Uniform, ///< [near, far] of the transform, in every column.
    Local,   ///< A range of each column's own, kept in a near/far map.
};

/// Voxels in GL memory, one bit each: the result of a Voxelizer, and what shaders query.
///
/// A texel is 128 slices of a column: bit (k & 31) of component (k >> 5) & 3 of layer k >> 7 is
/// slice k. In the texture store column (x, y) of a layer is texel (x, y, layer), in the buffer
/// store texel (layer * columns y + y) * columns x + x, four 32-bit words each. A uniform buffer
/// holds the grid's constants.
/// `#include <lamina/grid.glsl>` queries both. Reused across frames: memory is allocated again only
/// when the number of columns or layers, or the store, changes. Move-only; see Device for threads
/// and lifetime.
class LAMINA_API VoxelGrid {
public:
    /// An empty grid of no size; a Voxelizer, resize() or upload() gives it one. A Voxelizer also
    /// changes the store to the one its backend writes (VoxelizerCapabilities::store).
    /// Errors: OutOfMemory (for the 16 KiB uniform buffer).
    [[nodiscard]] static Result<VoxelGrid> create(const Device& device,
                                                  VoxelStore store = VoxelStore::Texture);

    VoxelGrid(VoxelGrid&&) noexcept;
    VoxelGrid& operator=(VoxelGrid&&) noexcept;
    ~VoxelGrid();

    /// Takes the shape and place of `transform`; the voxels' values are then undefined. For hosts
    /// that write the texture themselves; a Voxelizer does it by itself.
    /// Errors: DeviceLimit, OutOfMemory; the grid is then unchanged.
    [[nodiscard]] Result<void> resize(const GridTransform& transform);
    /// The same, and keeps the voxels in `store` from now on.
    [[nodiscard]] Result<void> resize(const GridTransform& transform, VoxelStore store,
                                      SliceRanges ranges = SliceRanges::Uniform);
    /// The same for several grids at once; with local ranges they share one near/far map.
    /// Errors: as resize(); all grids are then unchanged.
    [[nodiscard]] static Result<void> resizeAll(std::span<VoxelGrid> grids,
                                                const GridTransform& transform, VoxelStore store,
                                                SliceRanges ranges = SliceRanges::Uniform);

    /// Takes shape, place, voxels and local ranges of `bits`. GL: no barrier needed before queries.
    /// Errors: as resize(); the grid is then unchanged.
    [[nodiscard]] Result<void> upload(const BitGrid& bits);

    /// The voxels, and the near/far map if there is one, copied to host memory. Waits for the GPU.
    /// Errors: InvalidArgument on a grid of no size, OutOfMemory.
    [[nodiscard]] Result<BitGrid> download() const;

    /// Binds grid number `grid` of lamina/grid.glsl: the uniform buffer to binding
    /// uniformBufferBinding + grid, the texture (and no sampler object) to unit textureUnit + grid,
    /// where the bases are LAMINA_GRID_BLOCK_BINDING and LAMINA_GRID_TEXTURE_UNIT of the shader,
    /// which must be compiled with LAMINA_GRID_BUFFER_STORE 1 for the buffer store, 0 for the
    /// other. With local ranges, also the near/far map to unit rangeTextureUnit + grid
    /// (LAMINA_GRID_RANGE_UNIT; by default 8 after textureUnit) of a shader compiled with
    /// LAMINA_GRID_LOCAL_RANGES 1. Does nothing on a grid of no size. GL: these bindings (and the
    /// sampler bindings of the units) are what it changes; the caller restores them if need be.
    void bind(std::uint32_t uniformBufferBinding = 0, std::uint32_t textureUnit = 0,
              std::uint32_t grid = 0, std::optional<std::uint32_t> rangeTextureUnit = {}) const;

    /// Where the voxels are; nothing for a grid of no size.
    [[nodiscard]] const GridTransform* transform() const;
    [[nodiscard]] VoxelStore store() const;
    /// GL name of the 2D array texture or, in the buffer store, of the texel buffer texture; 0 for
    /// a grid of no size.
    [[nodiscard]] std::uint32_t texture() const;
    /// GL name of the buffer; 0 in the texture store and for a grid of no size.
    [[nodiscard]] std::uint32_t buffer() const;
    [[nodiscard]] bool hasLocalRanges() const;
    /// GL name of the near/far map, 0 without local ranges: a GL_RG32F 2D texture, a texel a
    /// column, that holds the nearest depth of the column and the negated farthest, eye depths in
    /// world units; in an empty column, the largest float twice. A Voxelizer rounds them outwards.
    [[nodiscard]] std::uint32_t rangeTexture() const;
    /// GL name of the uniform buffer.
    [[nodiscard]] std::uint32_t uniformBuffer() const;
    /// Bytes of GL memory held, a shared near/far map counted in full.
    [[nodiscard]] std::uint64_t gpuBytes() const;
    /// Building block for Lamina's own modules; not part of the stable API.
    [[nodiscard]] const gl::DeviceState* deviceState() const;

private:
    struct Impl;
    explicit VoxelGrid(std::unique_ptr<Impl> impl);
    std::unique_ptr<Impl> mImpl;
};

} // namespace lamina
