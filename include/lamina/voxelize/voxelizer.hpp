#pragma once

#include <lamina/core/export.hpp>
#include <lamina/core/result.hpp>
#include <lamina/gl/device.hpp>
#include <lamina/grid/grid_transform.hpp>
#include <lamina/grid/voxel_grid.hpp>
#include <lamina/voxelize/geometry_source.hpp>
#include <lamina/voxelize/material.hpp>

#include <cstdint>
#include <memory>
#include <optional>
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
    /// Every voxel whose centre lies inside, as VoxelizerDesc::solidRule understands it. All the
    /// sources together are one mesh.
    Solid,
};

/// What is inside, for Coverage::Solid. See downloadSolidReport() for how sure a rule was.
enum class SolidRule : std::uint8_t {
    /// An odd number of triangles crosses the column's centre line beyond the voxel's centre
    /// (even-odd rule). Exact for closed meshes of any orientation, and the fastest. Where parts
    /// overlap an even number of times, they are hollow; a column through a hole of an open mesh is
    /// filled up to the nearest crossing without a partner.
    Parity,
    /// For open and dirty meshes: rays from each voxel's centre vote. Where the six along the axes
    /// of the grid agree, they decide; elsewhere the eight along its diagonals (in voxels) vote
    /// too, and 8 or more of the 14 must find the centre inside. A ray does so if the triangles
    /// that it crosses, counted with the side they show, do not cancel (non-zero winding rule: the
    /// rays estimate the generalized winding number [Jacobson et al. 2013]); on lines whose
    /// crossings come in pairs that do not cancel, which wrongly oriented triangles make, if it
    /// crosses an odd number.
    ///
    /// Equal to Parity for closed meshes without self-intersections, oriented outward or inward.
    /// Overlapping parts of one orientation become their union, a part of the opposite orientation
    /// inside another a cavity. Flipped, doubled and missing triangles are outvoted as long as few
    /// rays of a voxel meet them. A large opening is closed about where a sheet through its rim
    /// would be. Not exact: the rays are few, so near openings it matters which of them miss.
    /// Crossings are counted modulo 16: what lies inside of exactly 16 parts counts as outside.
    Voted,
    /// Everything that the outside cannot reach: a flood from the faces of the grid, through faces
    /// of voxels that no triangle touches. Contains every voxel of Coverage::Conservative, so it is
    /// up to a voxel larger than the solid; exact in that. Needs no orientation and closes openings
    /// narrower than a voxel; through wider ones the inside is lost. The mesh should lie within the
    /// grid: a solid that the grid cuts off is open there.
    FloodFill,
};

/// How voxels are made.
enum class Backend : std::uint8_t {
    /// Sampled, Filled, and whatever asks for local ranges: MrtSlicemap; Separating6: Overlap;
    /// Conservative, Solid: Overlap in the grids that it takes, else MrtSlicemap, call by call, and
    /// MrtSlicemap for all grids if they shall have the texture store. Solid by another rule than
    /// Parity: Overlap.
    Automatic,
    /// Bits by logic op, one pass of the geometry per 128 slices ([ED06] 2.1-2.3). Any grid; all
    /// coverages but Separating6. Solid by XOR (Eisemann and Decoret 2008), SolidRule::Parity
    /// alone.
    Slicemap,
    /// Exact triangle/voxel overlap by compute shaders. Orthographic grids with linear slices;
    /// Conservative, Separating6 and Solid.
    Overlap,
    /// The hit counts of a VolumeVoxelizer, a byte a voxel, packed to bits: all slices in one pass
    /// of the geometry ([CLN11] 2), but for triangles that span more than seven: they are drawn
    /// once more for each further 224 slices of the grid (of a DrawSource, all are). Any grid;
    /// Sampled.
    Volume,
    /// Slicemap whose columns divide near/far ranges of their own, found by one more pass of the
    /// geometry ([ED06] 2.3). Not for Solid.
    LocalSlicemap,
    /// Slicemap of 1024 slices a pass ([ED06] 2.4), in uniform or local ranges.
    MrtSlicemap,
};

[[nodiscard]] LAMINA_API std::string_view name(Coverage coverage); ///< "sampled"
[[nodiscard]] LAMINA_API std::string_view name(SolidRule rule);    ///< "parity"
[[nodiscard]] LAMINA_API std::string_view name(Backend backend);   ///< "slicemap"

struct VoxelizerDesc {
    Backend backend = Backend::Automatic;
    Coverage coverage = Coverage::Sampled;
    /// Slices divide the near/far range of each column instead of the grid's. Always so for
    /// LocalSlicemap, as asked for MrtSlicemap (and Automatic, which then takes it), an error for
    /// the others and for Solid and Separating6.
    bool localRanges = false;
    /// Where the words go. Nothing: the one that the backend writes; for MrtSlicemap, which writes
    /// to render targets (Texture) or by atomic operations of fragments (Buffer), the faster on the
    /// device. The first create() on a device that needs to know measures it and waits for the GPU
    /// meanwhile (some frames of 256 x 256 x 1024 voxels). Automatic takes MrtSlicemap with the
    /// texture, so that shaders need not follow the device.
    std::optional<VoxelStore> store{};
    SolidRule solidRule = SolidRule::Parity; ///< For Coverage::Solid; no matter to the others.
};

/// How voxelizeWith() sorts triangles into several grids.
enum class Split : std::uint8_t {
    None, ///< One grid.
    /// Two grids: triangles that show the grid's camera their front (their corners turn
    /// counter-clockwise in the space of their positions, so that a mirrored model matrix does not
    /// turn a mesh inside out) and those that show their back ([ED06] 3.3). Edge-on: front.
    Facing,
    /// One to eight grids: each triangle goes to the one that its material's colorClass numbers,
    /// if the material's orientation rule takes it ([ED06] 3.1). The material of a DrawSource's
    /// triangle is that of its last vertex.
    ColorClass,
};

struct VoxelizeOptions {
    Split split = Split::None;
    /// For Split::ColorClass: the material table, 1 to 4096 entries. Ids past its end use the last.
    std::span<const Material> materials{};
    /// With local ranges: what they enclose, instead of the sources themselves. Cheap hulls save
    /// the extra pass over the sources. What sticks out of the hull's range, or stands in a column
    /// where there is no hull, is not voxelized. Empty: the sources.
    std::span<const GeometrySource> bounds{};
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
    bool localRanges = false;               ///< Grids get local ranges.
    bool splits = false;                    ///< voxelizeWith() serves splits and bounds.
};

/// How far Coverage::Solid could tell inside from outside. What a rule does not know is 0.
struct SolidReport {
    /// Parity: columns whose centre line an odd number of triangles crosses. There the mesh is not
    /// closed. 0 for closed meshes, except in a perspective grid: the eye is then the end of the
    /// centre lines, and those are odd that leave a mesh in which it stands, rightly filled.
    std::uint64_t oddColumns = 0;
    /// Voted: voxels on which the axes disagreed and 5 or more of the 14 votes were against the
    /// majority. 0 for closed, consistently oriented meshes. FloodFill: voxels that the surface
    /// touches; each belongs to the solid, although its centre may lie outside.
    std::uint64_t doubtfulVoxels = 0;
    /// FloodFill: voxels of the solid that the surface does not touch; 0 if the flood got in.
    std::uint64_t enclosedVoxels = 0;
    /// FloodFill: the flood reached all it could. False for labyrinths: passages to the outside
    /// with more than some hundred turns; what lies behind those counts as solid.
    bool isFloodComplete = true;
};

/// What one voxelize() call did; known without waiting for the GPU.
struct VoxelizeStats {
    std::uint32_t sources = 0;
    std::uint32_t passes = 0; ///< Passes over the geometry; with local ranges one finds them.
    std::uint64_t meshTriangles = 0; ///< Triangles of the MeshView sources.
    std::uint64_t gridBytes = 0;     ///< GL memory of the grid.
};

/// Turns triangles into voxels, on the GPU, every frame.
///
/// Coverage is decided by exact edge and plane equations in double precision, not by the
/// rasterizer's snapped coordinates: all devices give the same voxels, of triangles up to 1e7 times
/// the grid's size too. Backends may differ by the few voxels that a triangle all but touches:
/// Overlap's voxels are larger by 4e-5 of their edge on every side (up to 1e-4 after rounding), so
/// that a face this near to a boundary sets both layers, a slicemap's Conservative columns by 1e-5.
/// Triangles with non-finite or zero-area projections set none, except that Conservative and
/// Separating6 see the latter. See Device for threads, lifetime and GL state.
class LAMINA_API Voxelizer {
public:
    /// Errors: InvalidArgument (a value outside its enumeration), Unsupported (no backend serves
    /// `desc` here), NoContext, ShaderError.
    /// Cost: compiles the backend's programs (milliseconds).
    [[nodiscard]] static Result<std::unique_ptr<Voxelizer>> create(const Device& device,
                                                                   const VoxelizerDesc& desc = {});
    virtual ~Voxelizer() = default;
    Voxelizer(const Voxelizer&) = delete;
    Voxelizer& operator=(const Voxelizer&) = delete;

    /// The backend in use; never Automatic. Where Backend::Automatic picks call by call, the one of
    /// the last voxelize() that succeeded, Overlap at first.
    [[nodiscard]] virtual Backend backend() const = 0;
    /// Of the backend in use; `perspective`, `anyDistribution` and `splits` hold for all
    /// of Automatic.
    [[nodiscard]] virtual VoxelizerCapabilities capabilities() const = 0;
    /// Why the backend in use, in a sentence.
    [[nodiscard]] const std::string& reason() const { return mReason; }

    /// Voxelizes all `sources` into `out`, which takes the place of `transform`; what it held is
    /// replaced. An empty list of sources gives an empty grid. Does not wait for the GPU.
    /// Errors: InvalidArgument (a MeshView that does not fit its buffers, naming source, expected
    /// and found; a grid of another device), NoContext, DeviceLimit, OutOfMemory, ShaderError (a
    /// DrawSource's vertex stage); `out` and the GL state are then unchanged. GL: `out` may be
    /// sampled at once, no barrier needed; writes of the host to its vertex buffers by shaders need
    /// GL_VERTEX_ATTRIB_ARRAY_BARRIER_BIT | GL_ELEMENT_ARRAY_BARRIER_BIT before the call. Cost: one
    /// pass of the geometry per capabilities().slicesPerPass slices; a clear of the grid.
    /// SolidRule::Voted: closed, consistently oriented meshes without overlaps take one pass
    /// and 1.2 to 1.5 times the work of Parity; with overlaps two passes and 3 to 6 times the work;
    /// others 15 to 45 times, more the larger the grid: four passes and, where rays disagree, four
    /// more. The device finds out which: VoxelizeStats::passes counts all. Four times the grid's
    /// memory and up to 512 MiB more, kept for the next call. FloodFill: as Conservative, then some
    /// sweeps over the grid; twice its memory.
    [[nodiscard]] virtual Result<VoxelizeStats> voxelize(std::span<const GeometrySource> sources,
                                                         const GridTransform& transform,
                                                         VoxelGrid& out) = 0;

    /// As voxelize(), for slicemap backends, with options: into one grid, or with a split into as
    /// many as it takes. One pass of the geometry fills, for all grids, as many groups of 128
    /// slices as eight render targets hold (one group for Slicemap and LocalSlicemap). Split grids
    /// keep their words in the texture store. With local ranges all grids share one near/far map;
    /// together the grids of Split::Facing hold what one grid would.
    /// Errors: as voxelize(), for all grids; InvalidArgument (a number of grids or a material table
    /// that does not fit the split, bounds without local ranges); Unsupported (Overlap, a split
    /// with Solid).
    [[nodiscard]] virtual Result<VoxelizeStats>
    voxelizeWith(std::span<const GeometrySource> sources, const GridTransform& transform,
                 const VoxelizeOptions& options, std::span<VoxelGrid> grids);

    /// What the last voxelize() with Coverage::Solid found. Waits for the GPU.
    /// Errors: InvalidArgument (another coverage, or nothing voxelized yet).
    [[nodiscard]] virtual Result<SolidReport> downloadSolidReport() const;

    /// The voxels that SolidReport::doubtfulVoxels counts, for SolidRule::Voted. Waits for the GPU.
    /// Errors: InvalidArgument (another coverage or rule, or nothing voxelized yet), OutOfMemory.
    [[nodiscard]] virtual Result<BitGrid> downloadDoubtfulVoxels() const;

protected:
    Voxelizer() = default;
    /// Also tells the device's message callback.
    void setReason(gl::DeviceState& device, std::string reason);

private:
    std::string mReason;
};

} // namespace lamina
