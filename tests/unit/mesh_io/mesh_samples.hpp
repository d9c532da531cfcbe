#pragma once

#include <lamina/mesh_io/mesh_file.hpp>

#include <bit>
#include <cstring>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

/// Small mesh files, written here and not by the library.
namespace lamina::samples {

inline Result<TriangleMesh> parse(std::string_view content, MeshFormat format,
                                  MeshReadOptions options = {}) {
    options.format = format;
    return parseMesh(std::as_bytes(std::span(content.data(), content.size())), options);
}

/// The unit cube: corner i at (i & 1, i >> 1 & 1, i >> 2 & 1), outward.
inline std::vector<glm::vec3> cubePositions() {
    std::vector<glm::vec3> positions;
    for (int i = 0; i < 8; ++i)
        positions.emplace_back(i & 1, i >> 1 & 1, i >> 2 & 1);
    return positions;
}
inline std::vector<glm::uvec4> cubeQuads() {
    return {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
}
inline std::vector<glm::uvec3> cubeTriangles() {
    std::vector<glm::uvec3> triangles;
    for (const glm::uvec4& q : cubeQuads()) {
        triangles.emplace_back(q.x, q.y, q.z);
        triangles.emplace_back(q.x, q.z, q.w);
    }
    return triangles;
}
inline TriangleMesh cube() {
    return {cubePositions(), {}, {}, cubeTriangles()};
}

inline std::string cubeObj() {
    std::ostringstream out;
    out << "# a cube\nmtllib /dev/zero\no cube\n";
    for (const glm::vec3& p : cubePositions())
        out << "v " << p.x << ' ' << p.y << ' ' << p.z << '\n';
    out << "usemtl red\ns off\n";
    for (const glm::uvec4& q : cubeQuads())
        out << "f " << q.x + 1 << ' ' << q.y + 1 << ' ' << q.z + 1 << ' ' << q.w + 1 << '\n';
    return out.str();
}

inline std::string cubeOff() {
    std::ostringstream out;
    out << "OFF\n# a cube\n8 6 12\n";
    for (const glm::vec3& p : cubePositions())
        out << p.x << ' ' << p.y << ' ' << p.z << '\n';
    for (const glm::uvec4& q : cubeQuads())
        out << "4 " << q.x << ' ' << q.y << ' ' << q.z << ' ' << q.w << '\n';
    return out.str();
}

inline std::string cubeAsciiPly() {
    std::ostringstream out;
    out << "ply\nformat ascii 1.0\ncomment a cube\nelement vertex 8\nproperty float x\n"
           "property float y\nproperty float z\nelement face 6\n"
           "property list uchar int vertex_indices\nend_header\n";
    for (const glm::vec3& p : cubePositions())
        out << p.x << ' ' << p.y << ' ' << p.z << '\n';
    for (const glm::uvec4& q : cubeQuads())
        out << "4 " << q.x << ' ' << q.y << ' ' << q.z << ' ' << q.w << '\n';
    return out.str();
}

/// Appends a value's bytes in the order asked for.
template<class T>
void append(std::string& out, T value, std::endian order = std::endian::little) {
    char raw[sizeof(T)];
    std::memcpy(raw, &value, sizeof(T));
    const bool reverse = order != std::endian::native;
    for (std::size_t i = 0; i < sizeof(T); ++i)
        out += raw[reverse ? sizeof(T) - 1 - i : i];
}

inline std::string cubeBinaryPly(std::endian order) {
    std::string out = "ply\nformat ";
    out += order == std::endian::little ? "binary_little_endian" : "binary_big_endian";
    out += " 1.0\nelement vertex 8\nproperty float x\nproperty float y\nproperty float z\n"
           "element face 6\nproperty list uchar int vertex_indices\nend_header\n";
    for (const glm::vec3& p : cubePositions())
        for (int axis = 0; axis < 3; ++axis)
            append(out, p[axis], order);
    for (const glm::uvec4& q : cubeQuads()) {
        append(out, std::uint8_t{4}, order);
        for (int corner = 0; corner < 4; ++corner)
            append(out, static_cast<std::int32_t>(q[corner]), order);
    }
    return out;
}

inline std::string cubeBinaryStl(std::string_view header = "a cube") {
    std::string out(header);
    out.resize(80, ' ');
    append(out, std::uint32_t{12});
    for (const glm::uvec3& t : cubeTriangles()) {
        for (int axis = 0; axis < 3; ++axis)
            append(out, 0.0f);
        for (int corner = 0; corner < 3; ++corner)
            for (int axis = 0; axis < 3; ++axis)
                append(out, cubePositions()[t[corner]][axis]);
        append(out, std::uint16_t{0});
    }
    return out;
}

inline std::string cubeAsciiStl() {
    std::ostringstream out;
    out << "solid a cube\n";
    for (const glm::uvec3& t : cubeTriangles()) {
        out << "  facet normal nan nan nan\n    outer loop\n";
        for (int corner = 0; corner < 3; ++corner) {
            const glm::vec3 p = cubePositions()[t[corner]];
            out << "      vertex " << p.x << ' ' << p.y << ' ' << p.z << '\n';
        }
        out << "    endloop\n  endfacet\n";
    }
    out << "endsolid a cube\n";
    return out.str();
}

/// `text` with every occurrence of `from` replaced.
inline std::string replaced(std::string text, std::string_view from, std::string_view to) {
    for (std::size_t at = text.find(from); at != std::string::npos;
         at = text.find(from, at + to.size()))
        text.replace(at, from.size(), to);
    return text;
}

} // namespace lamina::samples
