#pragma once

#include <lamina/core/triangle_mesh.hpp>

#include <string>

namespace lamina::test {

/// Mesh files written plainly, with positions that read back as the same floats.
void writePly(const std::string& file, const TriangleMesh& mesh); ///< Binary, little-endian.
void writeObj(const std::string& file, const TriangleMesh& mesh);
void writeStl(const std::string& file, const TriangleMesh& mesh); ///< Binary.
void writeOff(const std::string& file, const TriangleMesh& mesh);

} // namespace lamina::test
