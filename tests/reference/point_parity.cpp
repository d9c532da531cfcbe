#include <reference/point_parity.hpp>

#include <reference/column_triangle.hpp>

#include <glm/geometric.hpp>
#include <glm/vec4.hpp>

#include <algorithm>
#include <cstdint>

namespace lamina::reference {
namespace {

constexpr std::uint32_t kColumns = 512;

/// A point in column space.
struct Place {
    glm::dvec2 column;
    double depth = 0.0;
    std::uint32_t point = 0;
};

int clampedCell(double column) {
    return static_cast<int>(std::clamp(column, 0.0, kColumns - 1.0));
}

/// Distance from a point to a triangle, by the regions of its nearest point.
double distanceToTriangle(const glm::dvec3& p, const glm::dvec3& a, const glm::dvec3& b,
                          const glm::dvec3& c) {
    const auto toSegment = [&](const glm::dvec3& from, const glm::dvec3& to) {
        const glm::dvec3 along = to - from;
        const double size = glm::dot(along, along);
        const double t = size > 0.0 ? std::clamp(glm::dot(p - from, along) / size, 0.0, 1.0) : 0.0;
        return glm::distance(p, from + t * along);
    };
    const glm::dvec3 normal = glm::cross(b - a, c - a);
    const auto isLeftOf = [&](const glm::dvec3& from, const glm::dvec3& to) {
        return glm::dot(glm::cross(to - from, p - from), normal) >= 0.0;
    };
    const double size = glm::length(normal);
    if (size > 0.0 && isLeftOf(a, b) && isLeftOf(b, c) && isLeftOf(c, a))
        return std::abs(glm::dot(p - a, normal)) / size;
    return std::min({toSegment(a, b), toSegment(b, c), toSegment(c, a)});
}

} // namespace

std::vector<char> pointParity(const TriangleMesh& mesh, std::span<const glm::vec3> points,
                              Axis axis) {
    Box3 box = mesh.bounds();
    for (const glm::vec3& point : points)
        box.extend(point);
    box.min -= 1e-3 * glm::length(box.size());
    box.max += 1e-3 * glm::length(box.size());
    const GridTransform transform = *GridTransform::box(box, glm::uvec3(kColumns), axis);

    std::vector<std::vector<Place>> cells(std::size_t{kColumns} * kColumns);
    const auto cellAt = [&](int x, int y) -> std::vector<Place>& {
        return cells[static_cast<std::size_t>(y) * kColumns + static_cast<std::size_t>(x)];
    };
    for (std::uint32_t i = 0; i < points.size(); ++i) {
        const glm::dvec4 place = transform.worldToColumn() * glm::dvec4(glm::dvec3(points[i]), 1.0);
        cellAt(clampedCell(place.x), clampedCell(place.y))
            .push_back({glm::dvec2(place), place.z, i});
    }
    std::vector<char> parity(points.size(), 0);
    for (const ColumnTriangle& triangle : columnTriangles(mesh, transform, glm::dmat4(1.0))) {
        const glm::dvec2 low = triangle.min();
        const glm::dvec2 high = triangle.max();
        for (int y = clampedCell(low.y); y <= clampedCell(high.y); ++y)
            for (int x = clampedCell(low.x); x <= clampedCell(high.x); ++x)
                for (const Place& place : cellAt(x, y))
                    if (owns(triangle, place.column) &&
                        depthAt(triangle, place.column) > place.depth)
                        parity[place.point] ^= 1;
    }
    return parity;
}

bool surfaceWithin(const TriangleMesh& mesh, const glm::dvec3& point, double distance) {
    return std::ranges::any_of(mesh.triangles, [&](const glm::uvec3& triangle) {
        const glm::dvec3 a(mesh.positions[triangle.x]);
        const glm::dvec3 b(mesh.positions[triangle.y]);
        const glm::dvec3 c(mesh.positions[triangle.z]);
        const glm::dvec3 low = glm::min(a, glm::min(b, c)) - distance;
        const glm::dvec3 high = glm::max(a, glm::max(b, c)) + distance;
        return glm::all(glm::lessThan(low, point)) && glm::all(glm::lessThan(point, high)) &&
               distanceToTriangle(point, a, b, c) < distance;
    });
}

} // namespace lamina::reference
