#pragma once

#include "mesh_io/read_support.hpp"

#include <string_view>

/// The readers of the file formats. Each gives a mesh with indices in range and finite positions;
/// normals as the file has them, not normalized. Error texts start with the line or byte.
namespace lamina::detail {

[[nodiscard]] Result<TriangleMesh> readObj(std::string_view text, ReadJob& job);
[[nodiscard]] Result<TriangleMesh> readPly(std::string_view bytes, ReadJob& job);
[[nodiscard]] Result<TriangleMesh> readStl(std::string_view bytes, ReadJob& job);
[[nodiscard]] Result<TriangleMesh> readOff(std::string_view text, ReadJob& job);

/// Is this a binary STL file by its size?
[[nodiscard]] bool isBinaryStl(std::string_view bytes);

} // namespace lamina::detail
