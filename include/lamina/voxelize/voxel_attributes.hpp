#pragma once

#include <lamina/core/export.hpp>
#include <lamina/core/result.hpp>
#include <lamina/gl/device.hpp>
#include <lamina/grid/attribute_grid.hpp>
#include <lamina/grid/grid_transform.hpp>

#include <cstdint>
#include <memory>

namespace lamina {

struct VoxelAttributesDesc {
    /// Room for the attributes of so many set voxels, 16 bytes each; 0: as many as there are, for
    /// which an AttributeVoxelizer waits for the GPU to count them. Voxels beyond the room, by the
    /// order of BitGrid::forEachSet(), have no attributes.
    std::uint32_t maxVoxels = 0;
};

/// Colours, normals, hits and materials of the set voxels of a grid, in GL memory: the result of an
/// AttributeVoxelizer.
///
/// Memory follows the surface, not the volume: a record of 16 bytes for each set voxel, found by
/// its rank, the number of set voxels before it in the order of BitGrid::forEachSet(). A rank is
/// stored for each 128 slices of a column (4 bytes), the rest is counted in the grid's own bits.
/// `#include <lamina/attributes.glsl>` queries them, with the grid they were made for bound beside;
/// once that grid changes they mean nothing until they are made again. Reused across frames: memory
/// is allocated again only when more is needed. Move-only; see Device for threads and lifetime.
class LAMINA_API VoxelAttributes {
public:
    /// Attributes of no voxels. Allocates nothing, and cannot fail but for an argument.
    /// Errors: DeviceLimit (maxVoxels beyond what a texel buffer holds).
    [[nodiscard]] static Result<VoxelAttributes> create(const Device& device,
                                                        const VoxelAttributesDesc& desc = {});

    VoxelAttributes(VoxelAttributes&&) noexcept;
    VoxelAttributes& operator=(VoxelAttributes&&) noexcept;
    ~VoxelAttributes();

    /// The attributes of all set voxels, copied to host memory. Waits for the GPU.
    /// Errors: InvalidArgument before anything was voxelized; DeviceLimit if there was no room for
    /// all set voxels, naming both numbers; OutOfMemory.
    [[nodiscard]] Result<AttributeGrid> download() const;

    /// Binds what lamina/attributes.glsl reads: ranks to `textureUnit`
    /// (LAMINA_ATTRIBUTES_TEXTURE_UNIT of the shader), records to the next, and no sampler objects.
    /// Does nothing before anything was voxelized. GL: these bindings are what it changes; the
    /// caller restores them if need be.
    void bind(std::uint32_t textureUnit = 1) const;

    /// Where the voxels are; nothing before anything was voxelized.
    [[nodiscard]] const GridTransform* transform() const;
    /// Bytes of GL memory held.
    [[nodiscard]] std::uint64_t gpuBytes() const;

private:
    friend class AttributeVoxelizer;
    struct Impl;
    explicit VoxelAttributes(std::unique_ptr<Impl> impl);
    std::unique_ptr<Impl> mImpl;
};

} // namespace lamina
