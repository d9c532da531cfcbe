#include <reference/attributes.hpp>

#include <reference/triangle_box.hpp>

#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include <map>
#include <tuple>

namespace lamina::reference {
namespace {

using Polygon = std::vector<glm::dvec3>;

/// The part of a convex polygon where side * (p[axis] - bound) <= 0.
Polygon cut(const Polygon& polygon, int axis, double bound, double side) {
    Polygon kept;
    for (std::size_t i = 0; i < polygon.size(); ++i) {
        const glm::dvec3& a = polygon[i];
        const glm::dvec3& b = polygon[(i + 1) % polygon.size()];
        const double outsideA = side * (a[axis] - bound);
        const double outsideB = side * (b[axis] - bound);
        if (outsideA <= 0.0)
            kept.push_back(a);
        if ((outsideA <= 0.0) != (outsideB <= 0.0))
            kept.push_back(a + (b - a) * (outsideA / (outsideA - outsideB)));
    }
    return kept;
}

Polygon inVoxel(Polygon polygon, const glm::ivec3& voxel, double grow) {
    for (int axis = 0; axis < 3; ++axis) {
        polygon = cut(polygon, axis, voxel[axis] - grow, -1.0);
        polygon = cut(polygon, axis, voxel[axis] + 1.0 + grow, 1.0);
    }
    return polygon;
}

struct Part {
    double area = 0.0;
    glm::dvec3 centroid{0.0};
};

Part measure(const Polygon& polygon) {
    Part part;
    for (std::size_t i = 2; i < polygon.size(); ++i) {
        const double area =
            0.5 * glm::length(glm::cross(polygon[i - 1] - polygon[0], polygon[i] - polygon[0]));
        part.area += area;
        part.centroid += area * (polygon[0] + polygon[i - 1] + polygon[i]) / 3.0;
    }
    if (part.area > 0.0)
        part.centroid /= part.area;
    return part;
}

/// Shares of the corners at a point of the triangle's plane.
glm::dvec3 shares(const std::array<glm::dvec3, 3>& corners, const glm::dvec3& point) {
    const glm::dvec3 normal = glm::cross(corners[1] - corners[0], corners[2] - corners[0]);
    glm::dvec3 areas;
    for (int i = 0; i < 3; ++i)
        areas[i] = glm::dot(normal,
                            glm::cross(corners[(i + 1) % 3] - point, corners[(i + 2) % 3] - point));
    return areas / (areas.x + areas.y + areas.z);
}

} // namespace

std::vector<VoxelSurface> surfaces(const TriangleMesh& mesh, const BitGrid& bits,
                                   const Options& options) {
    std::vector<VoxelSurface> found;
    std::map<std::tuple<unsigned, unsigned, unsigned>, std::size_t> index;
    bits.forEachSet([&](const glm::uvec3& voxel) {
        index[{voxel.x, voxel.y, voxel.z}] = found.size();
        found.emplace_back();
    });
    const glm::dmat3 normalMatrix = glm::transpose(glm::inverse(glm::dmat3(options.model)));
    for (const glm::uvec3& triangle : mesh.triangles) {
        std::array<glm::dvec3, 3> world, grid, normals;
        std::array<glm::dvec4, 3> colors;
        for (int i = 0; i < 3; ++i) {
            world[i] = glm::dvec3(options.model * glm::dvec4(mesh.positions[triangle[i]], 1.0));
            grid[i] = bits.transform().worldToGrid(world[i]);
        }
        const glm::dvec3 face = glm::cross(world[1] - world[0], world[2] - world[0]);
        for (int i = 0; i < 3; ++i) {
            normals[i] = mesh.normals.empty()
                             ? glm::normalize(face)
                             : glm::normalize(normalMatrix * glm::dvec3(mesh.normals[triangle[i]]));
            colors[i] =
                mesh.colors.empty() ? glm::dvec4(1.0) : glm::dvec4(mesh.colors[triangle[i]]);
        }
        const TriangleBoxTest<double> test(grid, VoxelShape::Cube, options.grow);
        const glm::ivec3 first = glm::max(test.first(), glm::ivec3(0));
        const glm::ivec3 last = glm::min(test.last(), glm::ivec3(bits.size()) - 1);
        for (int z = first.z; z <= last.z; ++z)
            for (int y = first.y; y <= last.y; ++y)
                for (int x = first.x; x <= last.x; ++x) {
                    const glm::ivec3 voxel(x, y, z);
                    if (!bits.test(voxel) || !test.overlaps(voxel))
                        continue;
                    VoxelSurface& surface = found[index.at({x, y, z})];
                    ++surface.hits;
                    Polygon polygon = inVoxel({grid[0], grid[1], grid[2]}, voxel, options.grow);
                    for (glm::dvec3& corner : polygon)
                        corner = bits.transform().gridToWorld(corner);
                    const Part part = measure(polygon);
                    if (!(part.area > 0.0))
                        continue;
                    const glm::dvec3 at = shares(world, part.centroid);
                    surface.area += part.area;
                    surface.largestPart = std::max(surface.largestPart, part.area);
                    surface.color +=
                        part.area * (at.x * colors[0] + at.y * colors[1] + at.z * colors[2]);
                    surface.normal +=
                        part.area *
                        glm::normalize(at.x * normals[0] + at.y * normals[1] + at.z * normals[2]);
                }
    }
    return found;
}

} // namespace lamina::reference
