#include <reference/mesh_measures.hpp>

#include <glm/geometric.hpp>

#include <algorithm>
#include <map>
#include <utility>

namespace lamina::reference {

double signedVolume(const TriangleMesh& mesh) {
    double sixfold = 0.0;
    for (const glm::uvec3& triangle : mesh.triangles) {
        const glm::dvec3 a(mesh.positions[triangle.x]);
        const glm::dvec3 b(mesh.positions[triangle.y]);
        const glm::dvec3 c(mesh.positions[triangle.z]);
        sixfold += glm::dot(a, glm::cross(b, c));
    }
    return sixfold / 6.0;
}

double surfaceArea(const TriangleMesh& mesh) {
    double area = 0.0;
    for (const glm::uvec3& triangle : mesh.triangles) {
        const glm::dvec3 a(mesh.positions[triangle.x]);
        const glm::dvec3 b(mesh.positions[triangle.y]);
        const glm::dvec3 c(mesh.positions[triangle.z]);
        area += 0.5 * glm::length(glm::cross(b - a, c - a));
    }
    return area;
}

bool isWatertight(const TriangleMesh& mesh) {
    std::map<std::pair<unsigned, unsigned>, int> surplus;
    for (const glm::uvec3& triangle : mesh.triangles)
        for (int i = 0; i < 3; ++i) {
            const unsigned from = triangle[i];
            const unsigned to = triangle[(i + 1) % 3];
            surplus[std::minmax(from, to)] += from < to ? 1 : -1;
        }
    return std::all_of(surplus.begin(), surplus.end(),
                       [](const auto& edge) { return edge.second == 0; });
}

} // namespace lamina::reference
