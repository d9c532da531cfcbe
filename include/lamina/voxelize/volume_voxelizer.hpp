#pragma once

#include <lamina/core/export.hpp>
#include <lamina/core/result.hpp>
#include <lamina/gl/device.hpp>
#include <lamina/grid/grid_transform.hpp>
#include <lamina/voxelize/geometry_source.hpp>
#include <lamina/voxelize/material.hpp>
#include <lamina/voxelize/volume_grid.hpp>

#include <cstdint>
#include <memory>
#include <span>

namespace lamina {

struct VolumeVoxelizerDesc {
    /// How far each slice's slab reaches into its neighbours, in slices, from 0 to 1. Above 0 a
    /// surface near a slice boundary hits both slices, so that marching rays miss fewer voxels
    /// ([CLN11] 4.1.1).
    float slabOverlap = 0.0f;
};

/// What one VolumeVoxelizer::voxelize() call did; known without waiting for the GPU.
struct VolumeStats {
    std::uint32_t sources = 0;
    std::uint32_t passes = 0;        ///< Draws of each DrawSource.
    std::uint64_t meshTriangles = 0; ///< Triangles of the MeshView sources.
    std::uint64_t volumeBytes = 0;   ///< GL memory of the volume.
    std::uint64_t scratchBytes = 0;  ///< GL memory of the voxelizer, kept for the next call.
    /// Could a voxel get more hits than one of the formats counts? True for DrawSources, whose
    /// triangles are not known; VolumeData tells whether it happened.
    bool mayReachCeiling = false;
};

/// Turns triangles into a VolumeGrid: a geometry shader sends each triangle to just the layers of
/// the volume that its depth range touches ([CLN11] 2).
///
/// A triangle hits voxel (i,j,k) if its projection owns the centre of column (i,j) (points on left
/// edges and horizontal top edges count) and its depth there lies in slice k grown by the slab
/// overlap. Coverage::Sampled is the same rule: without overlap the voxels with hits are its
/// voxels. Coverage and depth are decided in double precision, of triangles up to 1e7 times the
/// grid's size too. A hit's normal is interpolated from the vertices (the face's own without vertex
/// normals) and has unit length; its colour is the vertices' times the material's. Triangles with
/// non-finite or zero-area projections hit nothing. A triangle's material is its first vertex's.
/// Move-only; see Device for threads and GL state.
class LAMINA_API VolumeVoxelizer {
public:
    /// Materials of one table.
    static constexpr std::size_t kMaxMaterials = 512;

    /// Errors: InvalidArgument (slabOverlap), ShaderError. Cost: compiles programs (milliseconds).
    [[nodiscard]] static Result<VolumeVoxelizer> create(const Device& device,
                                                        const VolumeVoxelizerDesc& desc = {});

    VolumeVoxelizer(VolumeVoxelizer&&) noexcept;
    VolumeVoxelizer& operator=(VolumeVoxelizer&&) noexcept;
    ~VolumeVoxelizer();

    /// Voxelizes all `sources` into `out`, which takes the place of `transform`; what it held is
    /// replaced. Does not wait for the GPU.
    /// materials: by material id, at most kMaxMaterials; none: the default Material alone. Ids that
    /// a DrawSource's vertices give past the end use the last one.
    /// Errors: InvalidArgument (a MeshView that does not fit its buffers, a material id or value
    /// out of range, a volume of another device), DeviceLimit, OutOfMemory, ShaderError (a
    /// DrawSource's vertex stage); the volume's content and the GL state are then unchanged. GL:
    /// `out` may be sampled at once, no barrier needed; writes of the host to its vertex buffers by
    /// shaders need GL_VERTEX_ATTRIB_ARRAY_BARRIER_BIT | GL_ELEMENT_ARRAY_BARRIER_BIT before the
    /// call. Cost: one pass over the geometry, which draws seven layers of each triangle, and
    /// further ones for what spans more; a clear of the volume.
    [[nodiscard]] Result<VolumeStats> voxelize(std::span<const GeometrySource> sources,
                                               std::span<const Material> materials,
                                               const GridTransform& transform, VolumeGrid& out);

private:
    struct Impl;
    explicit VolumeVoxelizer(std::unique_ptr<Impl> impl);
    std::unique_ptr<Impl> mImpl;
};

} // namespace lamina
