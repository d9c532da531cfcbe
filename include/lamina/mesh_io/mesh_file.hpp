#pragma once

#include <lamina/core/export.hpp>
#include <lamina/core/result.hpp>
#include <lamina/core/triangle_mesh.hpp>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>
#include <string_view>

namespace lamina {

/// The mesh files Lamina reads.
///
/// - Obj: `v` (with optional weight or colour), `vn`, `vt` (checked, then dropped) and `f` with
///   absolute or relative indices. Names, groups, materials, lines and curves are skipped; no other
///   file is opened. File normals are kept if every corner of every face has one; a vertex that has
///   several is split.
/// - Ply: ascii and binary of either byte order. Reads x y z, nx ny nz, red green blue (alpha) of
///   `vertex`, the index lists of `face` and `tristrips`; skips the rest.
/// - Stl: ascii and binary. Corners at identical positions become one vertex; facet normals are
///   dropped.
/// - Off: OFF with the prefixes ST, C and N; no binary, 4-dimensional or n-dimensional files.
enum class MeshFormat : std::uint8_t { Automatic, Obj, Ply, Stl, Off };

/// "OBJ", "PLY", "STL", "OFF" or "automatic".
[[nodiscard]] LAMINA_API std::string_view name(MeshFormat format);

/// Settings for readMesh() and parseMesh(). Defaults always work.
struct MeshReadOptions {
    /// Automatic: readMesh() goes by the file name's extension, parseMesh() by the content.
    MeshFormat format = MeshFormat::Automatic;
    /// Fill TriangleMesh::normals (see computeNormals()) when the file has none.
    bool computeNormals = true;
    /// Larger files are refused before memory is reserved; bytes, 0: no limit.
    std::uint64_t maxFileBytes = 0;
    /// Called now and then on the reading thread with the share done, in [0,1]; returns false to
    /// cancel. Must not throw.
    std::function<bool(float share)> progress;
};

/// Reads a mesh file: polygons become triangles (concave ones too), normals unit vectors.
///
/// The result passes validate(): at least one triangle, indices in range, finite positions. A
/// vertex that no triangle uses keeps its index; if it is not finite it is moved to the origin.
/// Normals without a direction are computed. A broken file is refused as a whole.
///
/// Errors, each naming the file, the line or byte, what was expected and what was found:
/// NotFound; UnknownFormat (extension); InputOutput (not a regular file, unreadable); InvalidFile;
/// InvalidMesh (no triangle, an index out of range, a non-finite vertex that a triangle uses);
/// Unsupported (a variant of the format); OutOfMemory (also maxFileBytes); Cancelled.
/// Cost: linear in the file's size; peak memory at most 64 bytes per file byte, usually 3 to 8.
/// Threads: any number at once.
[[nodiscard]] LAMINA_API Result<TriangleMesh> readMesh(const std::filesystem::path& file,
                                                       const MeshReadOptions& options = {});

/// As readMesh(), for the content of a file in memory. `bytes` is borrowed for the call.
[[nodiscard]] LAMINA_API Result<TriangleMesh> parseMesh(std::span<const std::byte> bytes,
                                                        const MeshReadOptions& options = {});

} // namespace lamina
