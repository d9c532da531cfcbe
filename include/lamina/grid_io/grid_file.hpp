#pragma once

#include <lamina/core/export.hpp>
#include <lamina/core/result.hpp>
#include <lamina/grid/attribute_grid.hpp>
#include <lamina/grid/bit_grid.hpp>
#include <lamina/grid_io/progress.hpp>

#include <cstdint>
#include <filesystem>
#include <string_view>
#include <vector>

namespace lamina {

/// Voxel file formats. All store an axis-aligned world box; (i,j,k) below counts voxels along world
/// x, y, z from the box's low corner.
enum class GridFormat : std::uint8_t {
    Automatic, ///< By the file name's extension.
    /// binvox 1 (.binvox): run lengths, `dim NX NZ NY`, y fastest, then z, then x. `translate` is
    /// the low corner, `scale` the longest side: a voxel's edge is scale / max(dim). Cubic voxels
    /// only. Holds no attributes.
    Binvox,
    /// MagicaVoxel 150 (.vox): a palette of 255 colours, or one without colours; z is up there, see
    /// GridWriteOptions::up. Up to 256 voxels a side: one model of the grid's size. Beyond: models
    /// of at most 256 a side where voxels are set, placed by a scene graph so that the grid stands
    /// centred on the origin. Drops the world position and the voxel size. At most about 536
    /// million set voxels. Up to 255 different colours are kept as they are; more are brought
    /// together by variance cuts, a palette entry for the mean of each. Alpha and normals are
    /// dropped.
    Vox,
    /// NumPy 1.0 (.npy): uint8 array of shape (NZ, NY, NX) in C order, a[k][j][i] is 0 or 1. Drops
    /// the world position and the voxel size. Colours and normals go to files of their own beside
    /// it, NAME.color.npy (uint8, shape (N, 4), RGBA) and NAME.normal.npy (float32, shape (N, 3)),
    /// a row for each of the N set voxels in C order: `full[a != 0] = rows`.
    Npy,
    /// VTK ImageData (.vti): uint8 cell array "occupancy", 0 or 1, zlib-compressed; cell arrays
    /// "color" (uint8, RGBA) and "normal" (float32, three components), zero in empty cells.
    Vti,
    /// OpenVDB (.vdb): float fog volume "density", 1 in set voxels, 0 elsewhere, as Blender and
    /// Houdini load it. Index (i,j,k) maps to the voxel's centre in world space. Vector grids
    /// "color" (red, green, blue in [0,1], as given) and "normal", active where known.
    Vdb,
};

/// The extension without dot ("vti"); "automatic" for Automatic.
[[nodiscard]] LAMINA_API std::string_view name(GridFormat format);

/// The format a file name's extension stands for, upper or lower case.
/// Errors: UnknownFormat, listing the extensions there are.
[[nodiscard]] LAMINA_API Result<GridFormat> gridFormat(const std::filesystem::path& path);

/// Was this library built to write `format`? True for all but Vdb, which needs OpenVDB.
[[nodiscard]] LAMINA_API bool canWrite(GridFormat format);

/// Does `format` hold the colours, the normals of voxels?
[[nodiscard]] LAMINA_API bool holdsColors(GridFormat format);
[[nodiscard]] LAMINA_API bool holdsNormals(GridFormat format);

struct GridWriteOptions {
    GridFormat format = GridFormat::Automatic;
    /// The world axis that points up in formats with a fixed up axis (Vox). World x, y, z become
    /// MagicaVoxel's (y, z, x) for X, (x, -z, y) for Y, (x, y, z) for Z.
    Axis up = Axis::Y;
    /// Colours and normals of the set voxels to be written where the format holds them; borrowed.
    /// Voxels of which hits are known to be 0 count as without.
    const AttributeGrid* attributes = nullptr;
    ProgressCallback progress;
};

/// The files that writeGrid() makes: `path`, then those for attributes that stand beside it (Npy).
/// Errors: UnknownFormat.
[[nodiscard]] LAMINA_API Result<std::vector<std::filesystem::path>>
gridFiles(const std::filesystem::path& path, const GridWriteOptions& options = {});

/// Writes a grid made by GridTransform::box() with linear slices, along any axis, to a file that
/// appears whole or not at all.
/// Cost: one pass over the grid; memory beyond it is a few slices, for Vdb also OpenVDB's tree,
/// with attributes 8 bytes for each 128 slices of each column. Errors: InvalidArgument (attributes
/// of another number of voxels); UnknownFormat; Unsupported (a camera grid, non-linear slices,
/// local ranges: see BitGrid::toUniform(), what the format cannot store, Vdb in a build without
/// OpenVDB); NotFound, InputOutput (see AtomicFile); OutOfMemory; Cancelled (by the progress
/// callback: no file is made, an old one stays). Threads: different files may be written at the
/// same time.
[[nodiscard]] LAMINA_API Result<void> writeGrid(const std::filesystem::path& path,
                                                const BitGrid& grid,
                                                const GridWriteOptions& options = {});

/// Reads a .binvox or .npy file (by extension) as a box grid with columns along z.
/// .npy: one-byte integer or bool arrays of three dimensions in C order; every non-zero element is
/// a set voxel; the box is (0,0,0) to (NX,NY,NZ).
/// Strict: a file that is too short, too long or inconsistent is an error. Memory is bounded by the
/// file's size (see binvox's run lengths: 32 times that, plus 512 MiB).
/// Errors: UnknownFormat; Unsupported (a format that is only written, an array type or order not
/// named above); NotFound; InputOutput; InvalidFile, naming line or byte; OutOfMemory.
[[nodiscard]] LAMINA_API Result<BitGrid> readGrid(const std::filesystem::path& path);

} // namespace lamina
