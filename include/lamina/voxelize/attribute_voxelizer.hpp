#pragma once

#include <lamina/core/export.hpp>
#include <lamina/core/result.hpp>
#include <lamina/gl/device.hpp>
#include <lamina/grid/voxel_grid.hpp>
#include <lamina/voxelize/geometry_source.hpp>
#include <lamina/voxelize/material.hpp>
#include <lamina/voxelize/voxel_attributes.hpp>

#include <cstdint>
#include <memory>
#include <span>

namespace lamina {

/// What one AttributeVoxelizer::voxelize() call did.
struct AttributeStats {
    std::uint32_t sources = 0;
    std::uint32_t passes = 0;         ///< Passes over the geometry.
    std::uint64_t meshTriangles = 0;  ///< Triangles of the MeshView sources.
    std::uint64_t voxels = 0;         ///< That there is room for: all set ones, or maxVoxels.
    std::uint64_t attributeBytes = 0; ///< GL memory of the attributes.
    std::uint64_t scratchBytes = 0;   ///< GL memory of the voxelizer, kept for the next call.
};

/// Gives the set voxels of a grid, made by any voxelizer and of any coverage, the mean colour and
/// normal of the surface inside them, by compute shaders.
///
/// A triangle counts in every set voxel that it touches (Coverage::Conservative). It weighs as much
/// as the world area of its part in the voxel, so that means do not depend on how a surface is
/// divided into triangles; its colour and normal are the vertices', interpolated to the centroid of
/// that part. The voxel is enlarged by 4e-5 of its edge on every side: a face between two voxels
/// counts in both. A part without area (a triangle that just touches, a segment) weighs least, one
/// part in 2^20 of the voxel's largest section, which is also the step in which areas are counted.
/// Colours are the vertices' times the material's, averaged as stored (no transfer function);
/// normals are unit vectors in world space, the face's own where vertices have none; hits count
/// triangles; the material is that of the triangle with the largest part, of equals the greatest
/// id. A triangle's material is its first vertex's. Sums are 64-bit integers: they do not overflow
/// for any number of triangles and do not depend on the order. Material::orientation does not
/// matter.
/// Accuracy: colours within one step of 8 bits; normals within 0.04 degree of the exact mean where
/// a voxel's normals agree, more by as much as they cancel out; plus what the step of areas makes.
/// Move-only; see Device for threads and GL state.
class LAMINA_API AttributeVoxelizer {
public:
    /// Materials of one table.
    static constexpr std::size_t kMaxMaterials = 512;

    /// Errors: ShaderError, OutOfMemory. Cost: compiles programs (milliseconds).
    [[nodiscard]] static Result<AttributeVoxelizer> create(const Device& device);

    AttributeVoxelizer(AttributeVoxelizer&&) noexcept;
    AttributeVoxelizer& operator=(AttributeVoxelizer&&) noexcept;
    ~AttributeVoxelizer();

    /// Makes the attributes of the set voxels of `voxels`, which is not changed.
    /// sources: as given to the voxelizer that set the voxels; materials: by material id, at most
    /// kMaxMaterials; none: the default Material alone. Ids that a DrawSource's vertices give past
    /// the end use the last one. Waits for the GPU only if `out` has no maxVoxels, or for a
    /// DrawSource without maxTriangles.
    /// Errors: InvalidArgument (a grid of no size, a MeshView that does not fit its buffers, a
    /// material id or value out of range, a grid or attributes of another device), Unsupported (a
    /// perspective grid, or slices that are not linear: use VolumeVoxelizer; local ranges: see
    /// BitGrid::toUniform()), DeviceLimit, OutOfMemory, ShaderError (a DrawSource's vertex stage);
    /// the GL state is unchanged, `out` is unchanged or holds nothing. GL: `out` may be sampled at
    /// once, no barrier needed; writes of the host to its vertex buffers by shaders need
    /// GL_VERTEX_ATTRIB_ARRAY_BARRIER_BIT | GL_ELEMENT_ARRAY_BARRIER_BIT before the call. Cost: a
    /// pass over the grid's words, one over the geometry for each 512 slices and each batch of
    /// voxels whose sums (64 bytes each) one storage buffer binding holds. On software GL 8 to 13
    /// times Coverage::Conservative, a third each for the sums and for what is summed, by triangle
    /// and voxel; surfaces of one colour (no vertex colours, materials of one) take four sums less,
    /// an eighth of the time.
    [[nodiscard]] Result<AttributeStats> voxelize(std::span<const GeometrySource> sources,
                                                  std::span<const Material> materials,
                                                  const VoxelGrid& voxels, VoxelAttributes& out);

private:
    struct Impl;
    explicit AttributeVoxelizer(std::unique_ptr<Impl> impl);
    std::unique_ptr<Impl> mImpl;
};

} // namespace lamina
