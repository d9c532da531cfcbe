#include <lamina/mesh_io/mesh_normals.hpp>

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <vector>

namespace lamina {
namespace {

/// A unit vector, or zero for vectors without a direction. Scales first: coordinates may be as
/// small or as large as a float can be.
glm::dvec3 directionOf(const glm::dvec3& v) {
    const double largest = std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
    if (!(largest > 0.0) || !std::isfinite(largest))
        return glm::dvec3(0.0);
    const glm::dvec3 scaled = v / largest;
    return scaled / std::sqrt(glm::dot(scaled, scaled));
}

} // namespace

void computeNormals(TriangleMesh& mesh) {
    std::vector<glm::dvec3> sums(mesh.positions.size(), glm::dvec3(0.0));
    for (const glm::uvec3& triangle : mesh.triangles) {
        const glm::dvec3 a(mesh.positions[triangle.x]);
        const glm::dvec3 b(mesh.positions[triangle.y]);
        const glm::dvec3 c(mesh.positions[triangle.z]);
        const glm::dvec3 ab = directionOf(b - a);
        const glm::dvec3 bc = directionOf(c - b);
        const glm::dvec3 ca = directionOf(a - c);
        const glm::dvec3 normal = directionOf(glm::cross(ab, bc));
        const auto angle = [](const glm::dvec3& in, const glm::dvec3& out) {
            return std::acos(std::clamp(-glm::dot(in, out), -1.0, 1.0));
        };
        sums[triangle.x] += angle(ca, ab) * normal;
        sums[triangle.y] += angle(ab, bc) * normal;
        sums[triangle.z] += angle(bc, ca) * normal;
    }
    mesh.normals.resize(sums.size());
    std::transform(sums.begin(), sums.end(), mesh.normals.begin(), [](const glm::dvec3& sum) {
        const glm::dvec3 direction = directionOf(sum);
        return direction == glm::dvec3(0.0) ? glm::vec3(0.0f, 0.0f, 1.0f) : glm::vec3(direction);
    });
}

} // namespace lamina
