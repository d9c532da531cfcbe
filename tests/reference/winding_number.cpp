#include <reference/winding_number.hpp>

#include <glm/geometric.hpp>

#include <cmath>
#include <numbers>

namespace lamina::reference {

double windingNumber(const TriangleMesh& mesh, const glm::dvec3& point) {
    // Half the solid angle of a triangle by van Oosterom and Strackee (1983).
    double halfAngles = 0.0;
    for (const glm::uvec3& triangle : mesh.triangles) {
        const glm::dvec3 a = glm::dvec3(mesh.positions[triangle.x]) - point;
        const glm::dvec3 b = glm::dvec3(mesh.positions[triangle.y]) - point;
        const glm::dvec3 c = glm::dvec3(mesh.positions[triangle.z]) - point;
        const double la = glm::length(a);
        const double lb = glm::length(b);
        const double lc = glm::length(c);
        const double volume = glm::dot(a, glm::cross(b, c));
        const double spread =
            la * lb * lc + glm::dot(a, b) * lc + glm::dot(b, c) * la + glm::dot(c, a) * lb;
        halfAngles += std::atan2(volume, spread);
    }
    return halfAngles / (2.0 * std::numbers::pi);
}

} // namespace lamina::reference
