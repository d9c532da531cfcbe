#pragma once

#include <lamina/core/box.hpp>
#include <lamina/core/export.hpp>
#include <lamina/core/result.hpp>
#include <lamina/gl/device.hpp>
#include <lamina/gl/view.hpp>
#include <lamina/grid/voxel_grid.hpp>
#include <lamina/voxelize/geometry_source.hpp>

#include <glm/vec2.hpp>

#include <cstdint>
#include <memory>
#include <span>

namespace lamina {

/// How the inner voxels of a column are counted. Both give the same numbers.
enum class IntegralMethod : std::uint8_t {
    Arithmetic, ///< On 32 slices at a time.
    Table,      ///< By look-ups of 8 slices in a 256 x 256 table, as [ED06] 3.3 do.
};

struct ThicknessDesc {
    /// Slices of each column's own near/far range, 1 to 1024. Memory: 32 bytes a pixel for each 128
    /// begun.
    std::uint32_t slices = 128;
    IntegralMethod method = IntegralMethod::Arithmetic;
};

/// What one ThicknessMap::build() did; known without waiting for the GPU.
struct ThicknessStats {
    std::uint32_t sources = 0;
    std::uint32_t passes = 0;        ///< Passes over the geometry.
    std::uint64_t meshTriangles = 0; ///< Triangles of the MeshView sources.
    std::uint64_t gpuBytes = 0;      ///< GL memory held.
};

/// How far the thickness can be trusted.
struct ThicknessReport {
    /// Pixels whose ray meets a back face first or a front face last: the surface is not closed
    /// there, or the viewer stands inside it. 0 for closed meshes seen from outside.
    std::uint64_t openColumns = 0;
    /// Pixels with a voxel that both front and back faces cross, where thickness is a guess to
    /// within a slice and what [ED06]'s rules make of the empty voxels beside.
    std::uint64_t ambiguousColumns = 0;
};

/// How much of a closed object a view ray passes through, pixel by pixel, in one pass over any
/// deforming, concave, self-occluding shape: the volume integral of [ED06] 3.3.
///
/// Front and back faces are voxelized into two slicemaps that share each column's near/far range;
/// inner voxels are counted by the rules of lamina/volume_integral.glsl and scaled to world units.
/// Each surface crossing is known to within a slice of the column's range: far and near, divided by
/// desc.slices. Open surfaces give bounded, finite numbers, and are reported. Move-only; see Device
/// for threads, lifetime and GL state.
class LAMINA_API ThicknessMap {
public:
    /// Errors: InvalidArgument (slices out of range), Unsupported, OutOfMemory, ShaderError.
    /// Cost: compiles programs (milliseconds).
    [[nodiscard]] static Result<ThicknessMap> create(const Device& device,
                                                     const ThicknessDesc& desc = {});

    ThicknessMap(ThicknessMap&&) noexcept;
    ThicknessMap& operator=(ThicknessMap&&) noexcept;
    ~ThicknessMap();

    /// Measures the object that all `sources` make together. Triangles turn counter-clockwise in
    /// world space as seen from outside; vertex normals do not matter. Does not wait for the GPU.
    /// bounds: a world box that holds the sources; what sticks out may be missed.
    /// Errors: InvalidArgument (a view that is not invertible, whose window's axes are not at right
    /// angles or, orthographic, whose rays do not meet it at right angles; off-centre windows and
    /// oblique near planes are fine; empty or non-finite bounds; sources as
    /// Voxelizer::voxelize() says), DeviceLimit, OutOfMemory, ShaderError; the map is then
    /// undefined and must be built again. GL: as Voxelizer::voxelize(); the texture may be sampled
    /// at once, no barrier needed. Cost: two passes over the geometry up to 512 slices, three
    /// beyond, and a full-screen pass.
    [[nodiscard]] Result<ThicknessStats> build(std::span<const GeometrySource> sources,
                                               const View& view, const Box3& bounds);

    /// GL name of a GL_R32F 2D texture of the view's size: the length inside the object along the
    /// pixel's ray, world units; 0 beside the object. 0 before build(). It stays the same until a
    /// view of another size.
    [[nodiscard]] std::uint32_t texture() const;
    [[nodiscard]] glm::uvec2 size() const; ///< Pixels.
    /// The slicemaps of the last build(), for queries of the engine's own.
    [[nodiscard]] const VoxelGrid& frontFaces() const;
    [[nodiscard]] const VoxelGrid& backFaces() const;

    /// Of the last build(). Waits for the GPU.
    /// Errors: InvalidArgument before build().
    [[nodiscard]] Result<ThicknessReport> downloadReport() const;

    [[nodiscard]] const ThicknessDesc& desc() const;
    /// Bytes of GL memory held.
    [[nodiscard]] std::uint64_t gpuBytes() const;

private:
    struct Impl;
    explicit ThicknessMap(std::unique_ptr<Impl> impl);
    std::unique_ptr<Impl> mImpl;
};

} // namespace lamina
