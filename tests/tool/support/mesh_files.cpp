#include "support/mesh_files.hpp"

#include <cstdint>
#include <fstream>
#include <limits>

namespace lamina::test {
namespace {

/// Tests run on little-endian machines only, as binary PLY and STL demand.
template<class Value>
void put(std::ostream& stream, const Value& value) {
    stream.write(reinterpret_cast<const char*>(&value), sizeof value);
}

std::ofstream textFile(const std::string& file) {
    std::ofstream stream(file);
    stream.precision(std::numeric_limits<float>::max_digits10);
    return stream;
}

} // namespace

void writePly(const std::string& file, const TriangleMesh& mesh) {
    std::ofstream stream(file, std::ios::binary);
    stream << "ply\nformat binary_little_endian 1.0\nelement vertex " << mesh.positions.size()
           << "\nproperty float x\nproperty float y\nproperty float z\n"
           << (mesh.colors.empty() ? ""
                                   : "property float red\nproperty float green\n"
                                     "property float blue\nproperty float alpha\n")
           << "element face " << mesh.triangles.size()
           << "\nproperty list uchar int vertex_indices\nend_header\n";
    for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
        put(stream, mesh.positions[i]);
        if (!mesh.colors.empty())
            put(stream, mesh.colors[i]);
    }
    for (const glm::uvec3& triangle : mesh.triangles) {
        put(stream, std::uint8_t{3});
        put(stream, triangle);
    }
}

void writeObj(const std::string& file, const TriangleMesh& mesh) {
    std::ofstream stream = textFile(file);
    for (const glm::vec3& p : mesh.positions)
        stream << "v " << p.x << ' ' << p.y << ' ' << p.z << '\n';
    for (const glm::uvec3& t : mesh.triangles)
        stream << "f " << t.x + 1 << ' ' << t.y + 1 << ' ' << t.z + 1 << '\n';
}

void writeStl(const std::string& file, const TriangleMesh& mesh) {
    std::ofstream stream(file, std::ios::binary);
    stream << std::string(80, ' ');
    put(stream, static_cast<std::uint32_t>(mesh.triangles.size()));
    for (const glm::uvec3& triangle : mesh.triangles) {
        put(stream, glm::vec3(0.0f));
        for (int corner = 0; corner < 3; ++corner)
            put(stream, mesh.positions[triangle[corner]]);
        put(stream, std::uint16_t{0});
    }
}

void writeOff(const std::string& file, const TriangleMesh& mesh) {
    std::ofstream stream = textFile(file);
    stream << "OFF\n" << mesh.positions.size() << ' ' << mesh.triangles.size() << " 0\n";
    for (const glm::vec3& p : mesh.positions)
        stream << p.x << ' ' << p.y << ' ' << p.z << '\n';
    for (const glm::uvec3& t : mesh.triangles)
        stream << "3 " << t.x << ' ' << t.y << ' ' << t.z << '\n';
}

} // namespace lamina::test
