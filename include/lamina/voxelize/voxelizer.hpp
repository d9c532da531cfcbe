#pragma once

#include <lamina/core/export.hpp>
#include <lamina/core/result.hpp>
#include <lamina/gl/device.hpp>
#include <lamina/grid/grid_transform.hpp>
#include <lamina/grid/voxel_grid.hpp>
#include <lamina/voxelize/geometry_source.hpp>

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>

namespace lamina {

/// Which voxels count as hit by a triangle.
enum class Coverage : std::uint8_t {
    /// The slice of the triangle's depth at the column's centre, for each column whose centre the
    /// triangle covers ([ED06] 2.2). Steep triangles leave holes along the depth.
    Sampled,
    /// For each column whose centre the triangle covers, every slice that the part of the triangle
    /// inside the column spans. No holes along the depth. A triangle seen edge-on covers no centre,
    /// not even one that it passes through, and sets nothing; Conservative sees it.
    Filled,
    /// Every voxel that the triangle touches, its boundary included: nothing is missed. A face on
    /// the boundary of two voxels sets both. Triangles of no area, down to points, count.
    Conservative,
    /// Thin and gap-free [Schwarz & Seidel 2010]: every voxel whose crosshair, the segments through
    /// its centre along the axes and what they span, the triangle touches. A 6-connected path
    /// across
    /// the surface meets a set voxel. Subset of Conservative.
    Separating6,
    /// Every voxel whose centre lies inside: an odd number of triangles crosses the column's centre
    /// line beyond it. For closed meshes of any orientation; see downloadSolidReport(). All the
    /// sources together are one mesh.
    Solid,
};

/// How voxels are made.
enum class Backend : std::uint8_t {
    /// Sampled, Filled: Slicemap; Separating6: Overlap; Conservative, Solid: Overlap in the grids
    /// that it takes, else Slicemap, call by call.
    Automatic,
    /// Bits by logic op, one pass of the geometry per 128 slices ([ED06] 2.1-2.3). Any grid; all
    /// coverages but Separating6. Solid by XOR (Eisemann and Decoret 2008).
    Slicemap,
    /// Exact triangle/voxel overlap by compute shaders. Orthographic grids with linear slices;
    /// Conservative, Separating6 and Solid.
    Overlap,
    /// The hit counts of a VolumeVoxelizer, a byte a voxel, packed to bits: all slices in one pass
    /// of the geometry ([CLN11] 2). Any grid; Sampled.
    Volume,
};

[[nodiscard]] LAMINA_API std::string_view name(Coverage coverage); ///< "sampled"
[[nodiscard]] LAMINA_API std::string_view name(Backend backend);   ///< "slicemap"

struct VoxelizerDesc {
    Backend backend = Backend::Automatic;
    Coverage coverage = Coverage::Sampled;
};

/// What a voxelizer can do on its device.
struct VoxelizerCapabilities {
    std::uint32_t maxColumns = 0;           ///< In x and in y.
    std::uint32_t maxSlices = 0;            ///< Linear distribution.
    std::uint32_t slicesPerPass = 0;        ///< Slices made by one pass of the geometry.
    bool perspective = false;               ///< Perspective grids.
    bool anyDistribution = false;           ///< Logarithmic and custom slices.
    bool drawSources = false;               ///< Geometry by DrawSource.
    VoxelStore store = VoxelStore::Texture; ///< What voxelize() makes of the grid.
};

/// How far Coverage::Solid could tell inside from outside.
struct SolidReport {
    /// Columns whose centre line an odd number of triangles crosses. There the mesh is not closed,
    /// and the column is filled up to the nearest crossing without a partner. 0 for closed meshes,
    /// except in a perspective grid: the eye is then the end of the centre lines, and those are odd
    /// that leave a mesh in which it stands, rightly filled.
    std::uint64_t oddColumns = 0;
};

/// What one voxelize() call did; known without waiting for the GPU.
struct VoxelizeStats {
    std::uint32_t sources = 0;
    std::uint32_t passes = 0;        ///< Passes over the geometry.
    std::uint64_t meshTriangles = 0; ///< Triangles of the MeshView sources.
    std::uint64_t gridBytes = 0;     ///< GL memory of the grid.
};

/// Turns triangles into voxels, on the GPU, every frame.
///
/// Coverage is decided by exact edge and plane equations in double precision, not by the
/// rasterizer's snapped coordinates: all devices give the same voxels. Triangles with non-finite or
/// zero-area projections set none, except that Conservative and Separating6 see the latter. See
/// Device for threads, lifetime and GL state.
class LAMINA_API Voxelizer {
public:
    /// Errors: Unsupported (no backend serves `desc` here), ShaderError.
    /// Cost: compiles the backend's programs (milliseconds).
    [[nodiscard]] static Result<std::unique_ptr<Voxelizer>> create(const Device& device,
                                                                   const VoxelizerDesc& desc = {});
    virtual ~Voxelizer() = default;
    Voxelizer(const Voxelizer&) = delete;
    Voxelizer& operator=(const Voxelizer&) = delete;

    /// The backend in use; never Automatic. Where Backend::Automatic picks call by call, the one of
    /// the last voxelize() that succeeded, Overlap at first.
    [[nodiscard]] virtual Backend backend() const = 0;
    /// Of the backend in use; `perspective` and `anyDistribution` hold for all of Automatic.
    [[nodiscard]] virtual VoxelizerCapabilities capabilities() const = 0;
    /// Why the backend in use, in a sentence.
    [[nodiscard]] const std::string& reason() const { return mReason; }

    /// Voxelizes all `sources` into `out`, which takes the place of `transform`; what it held is
    /// replaced. An empty list of sources gives an empty grid. Does not wait for the GPU.
    /// Errors: InvalidArgument (a MeshView that does not fit its buffers, naming source, expected
    /// and found), DeviceLimit, OutOfMemory, ShaderError (a DrawSource's vertex stage); `out` and
    /// the GL state are then unchanged. GL: `out` may be sampled at once, no barrier needed; writes
    /// of the host to its vertex buffers by shaders need GL_VERTEX_ATTRIB_ARRAY_BARRIER_BIT |
    /// GL_ELEMENT_ARRAY_BARRIER_BIT before the call. Cost: one pass of the geometry per
    /// capabilities().slicesPerPass slices; a clear of the grid.
    [[nodiscard]] virtual Result<VoxelizeStats> voxelize(std::span<const GeometrySource> sources,
                                                         const GridTransform& transform,
                                                         VoxelGrid& out) = 0;

    /// What the last voxelize() with Coverage::Solid found. Waits for the GPU.
    /// Errors: InvalidArgument (another coverage, or nothing voxelized yet).
    [[nodiscard]] virtual Result<SolidReport> downloadSolidReport() const;

protected:
    Voxelizer() = default;
    /// Also tells the device's message callback.
    void setReason(gl::DeviceState& device, std::string reason);

private:
    std::string mReason;
};

} // namespace lamina
