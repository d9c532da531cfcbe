#include <reference/shapes.hpp>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <map>
#include <numbers>
#include <random>
#include <utility>
#include <vector>

namespace lamina::reference {
namespace {

constexpr double kTau = 2.0 * std::numbers::pi;

/// The same numbers with every standard library, unlike <random>'s distributions.
class Random {
public:
    explicit Random(std::uint32_t seed)
        : mEngine(seed) {}
    /// Uniform in [0, 1).
    double number() { return mEngine() * (1.0 / 4294967296.0); }
    glm::dvec3 inside(const Box3& bounds) {
        const double x = number(), y = number(), z = number();
        return bounds.min + glm::dvec3(x, y, z) * bounds.size();
    }
    glm::dvec3 direction() {
        const double z = 2.0 * number() - 1.0;
        const double angle = kTau * number();
        const double radius = std::sqrt(1.0 - z * z);
        return {radius * std::cos(angle), radius * std::sin(angle), z};
    }

private:
    std::mt19937 mEngine;
};

/// A unit vector at right angles to `direction`.
glm::dvec3 anyNormal(const glm::dvec3& direction) {
    const glm::dvec3 a = glm::abs(direction);
    const glm::dvec3 other = a.x <= a.y && a.x <= a.z ? glm::dvec3(1, 0, 0)
                             : a.y <= a.z             ? glm::dvec3(0, 1, 0)
                                                      : glm::dvec3(0, 0, 1);
    return glm::normalize(glm::cross(direction, other));
}

std::uint32_t addVertex(TriangleMesh& mesh, const glm::dvec3& position) {
    mesh.positions.emplace_back(position);
    return static_cast<std::uint32_t>(mesh.positions.size() - 1);
}

void addTriangle(TriangleMesh& mesh, const glm::dvec3& a, const glm::dvec3& b,
                 const glm::dvec3& c) {
    const std::uint32_t first = addVertex(mesh, a);
    addVertex(mesh, b);
    addVertex(mesh, c);
    mesh.triangles.emplace_back(first, first + 1, first + 2);
}

/// Vertices a, b, c, d counter-clockwise.
void addQuad(TriangleMesh& mesh, std::uint32_t a, std::uint32_t b, std::uint32_t c,
             std::uint32_t d) {
    mesh.triangles.emplace_back(a, b, c);
    mesh.triangles.emplace_back(a, c, d);
}

/// Triangles of a grid of rows x columns vertices that closes on itself both ways.
void addClosedGrid(TriangleMesh& mesh, unsigned rows, unsigned columns) {
    for (unsigned i = 0; i < rows; ++i)
        for (unsigned j = 0; j < columns; ++j) {
            const unsigned nextRow = (i + 1) % rows * columns;
            const unsigned next = (j + 1) % columns;
            addQuad(mesh, i * columns + j, nextRow + j, nextRow + next, i * columns + next);
        }
}

/// The surface of a set of cells of a cubic lattice, one quad a face, vertices shared.
/// solid(cell): for cells in [0, count)^3.
template<class Solid>
TriangleMesh makeLatticeSurface(const glm::dvec3& corner, double cellEdge, int count,
                                Solid&& solid) {
    TriangleMesh mesh;
    std::map<std::array<int, 3>, std::uint32_t> vertices;
    const auto vertexAt = [&](const glm::ivec3& point) {
        const auto [entry, isNew] = vertices.try_emplace({point.x, point.y, point.z}, 0u);
        if (isNew)
            entry->second = addVertex(mesh, corner + cellEdge * glm::dvec3(point));
        return entry->second;
    };
    const auto isSolid = [&](const glm::ivec3& cell) {
        return glm::all(glm::greaterThanEqual(cell, glm::ivec3(0))) &&
               glm::all(glm::lessThan(cell, glm::ivec3(count))) && solid(cell);
    };
    for (int index = 0; index < count * count * count; ++index) {
        const glm::ivec3 cell(index % count, index / count % count, index / (count * count));
        if (!isSolid(cell))
            continue;
        for (int axis = 0; axis < 3; ++axis)
            for (int side = 0; side < 2; ++side) {
                glm::ivec3 out(0);
                out[axis] = 2 * side - 1;
                if (isSolid(cell + out))
                    continue;
                glm::ivec3 origin = cell;
                origin[axis] += side;
                glm::ivec3 u(0), v(0);
                u[(axis + (side == 1 ? 1 : 2)) % 3] = 1;
                v[(axis + (side == 1 ? 2 : 1)) % 3] = 1;
                addQuad(mesh, vertexAt(origin), vertexAt(origin + u), vertexAt(origin + u + v),
                        vertexAt(origin + v));
            }
    }
    return mesh;
}

bool isInMengerSponge(glm::ivec3 cell, unsigned levels) {
    for (unsigned level = 0; level < levels; ++level, cell /= 3) {
        const glm::ivec3 digit = cell % 3;
        if ((digit.x == 1) + (digit.y == 1) + (digit.z == 1) >= 2)
            return false;
    }
    return true;
}

} // namespace

TriangleMesh makeBox(const glm::vec3& min, const glm::vec3& max) {
    assert(glm::all(glm::lessThan(min, max)));
    TriangleMesh mesh;
    for (int i = 0; i < 8; ++i)
        addVertex(mesh, {(i & 1 ? max : min).x, (i & 2 ? max : min).y, (i & 4 ? max : min).z});
    addQuad(mesh, 0, 4, 6, 2);
    addQuad(mesh, 1, 3, 7, 5);
    addQuad(mesh, 0, 1, 5, 4);
    addQuad(mesh, 2, 6, 7, 3);
    addQuad(mesh, 0, 2, 3, 1);
    addQuad(mesh, 4, 5, 7, 6);
    return mesh;
}

TriangleMesh makeCube(const glm::vec3& center, float edge) {
    return makeBox(center - 0.5f * edge, center + 0.5f * edge);
}

TriangleMesh makeTetrahedron(const glm::vec3& a, const glm::vec3& b, const glm::vec3& c,
                             const glm::vec3& d) {
    TriangleMesh mesh;
    mesh.positions = {a, b, c, d};
    mesh.triangles = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}};
    const glm::dvec3 origin(a);
    const double volume = glm::dot(glm::dvec3(b) - origin,
                                   glm::cross(glm::dvec3(c) - origin, glm::dvec3(d) - origin));
    return volume < 0.0 ? flipped(mesh) : mesh;
}

TriangleMesh makeUvSphere(const glm::vec3& center, float radius, unsigned segments,
                          unsigned rings) {
    assert(segments >= 3 && rings >= 2);
    TriangleMesh mesh;
    const glm::dvec3 middle(center);
    for (unsigned ring = 1; ring < rings; ++ring)
        for (unsigned segment = 0; segment < segments; ++segment) {
            const double latitude = std::numbers::pi * ring / rings;
            const double longitude = kTau * segment / segments;
            addVertex(mesh, middle + static_cast<double>(radius) *
                                         glm::dvec3(std::sin(latitude) * std::cos(longitude),
                                                    std::sin(latitude) * std::sin(longitude),
                                                    -std::cos(latitude)));
        }
    const std::uint32_t south = addVertex(mesh, middle - glm::dvec3(0, 0, radius));
    const std::uint32_t north = addVertex(mesh, middle + glm::dvec3(0, 0, radius));
    const unsigned last = (rings - 2) * segments;
    for (unsigned i = 0; i < segments; ++i) {
        const unsigned next = (i + 1) % segments;
        mesh.triangles.emplace_back(south, next, i);
        mesh.triangles.emplace_back(north, last + i, last + next);
        for (unsigned row = 0; row < last; row += segments)
            addQuad(mesh, row + i, row + next, row + segments + next, row + segments + i);
    }
    return mesh;
}

TriangleMesh makeIcosphere(const glm::vec3& center, float radius, unsigned subdivisions) {
    const double g = std::numbers::phi;
    std::vector<glm::dvec3> points = {{-1, g, 0}, {1, g, 0}, {-1, -g, 0}, {1, -g, 0},
                                      {0, -1, g}, {0, 1, g}, {0, -1, -g}, {0, 1, -g},
                                      {g, 0, -1}, {g, 0, 1}, {-g, 0, -1}, {-g, 0, 1}};
    std::vector<glm::uvec3> triangles = {
        {0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
        {11, 10, 2}, {10, 7, 6}, {7, 1, 8},  {3, 9, 4},  {3, 4, 2},   {3, 2, 6}, {3, 6, 8},
        {3, 8, 9},   {4, 9, 5},  {2, 4, 11}, {6, 2, 10}, {8, 6, 7},   {9, 8, 1}};
    for (glm::dvec3& point : points)
        point = glm::normalize(point);
    for (unsigned level = 0; level < subdivisions; ++level) {
        std::map<std::pair<unsigned, unsigned>, unsigned> middles;
        const auto middleOf = [&](unsigned a, unsigned b) {
            const auto [entry, isNew] = middles.try_emplace(std::minmax(a, b), 0u);
            if (isNew) {
                entry->second = static_cast<unsigned>(points.size());
                points.push_back(glm::normalize(points[a] + points[b]));
            }
            return entry->second;
        };
        std::vector<glm::uvec3> finer;
        for (const glm::uvec3& t : triangles) {
            const unsigned ab = middleOf(t.x, t.y);
            const unsigned bc = middleOf(t.y, t.z);
            const unsigned ca = middleOf(t.z, t.x);
            finer.insert(finer.end(), {{t.x, ab, ca}, {t.y, bc, ab}, {t.z, ca, bc}, {ab, bc, ca}});
        }
        triangles = std::move(finer);
    }
    TriangleMesh mesh;
    for (const glm::dvec3& point : points)
        addVertex(mesh, glm::dvec3(center) + static_cast<double>(radius) * point);
    mesh.triangles = std::move(triangles);
    return mesh;
}

TriangleMesh makeTorus(const glm::vec3& center, float majorRadius, float minorRadius,
                       unsigned majorSegments, unsigned minorSegments) {
    TriangleMesh mesh;
    for (unsigned i = 0; i < majorSegments; ++i)
        for (unsigned j = 0; j < minorSegments; ++j) {
            const double major = kTau * i / majorSegments;
            const double minor = kTau * j / minorSegments;
            const double reach = majorRadius + minorRadius * std::cos(minor);
            addVertex(mesh, glm::dvec3(center) + glm::dvec3(reach * std::cos(major),
                                                            reach * std::sin(major),
                                                            minorRadius * std::sin(minor)));
        }
    addClosedGrid(mesh, majorSegments, minorSegments);
    return mesh;
}

TriangleMesh makeTorusKnot(const glm::vec3& center, float radius, float tubeRadius, unsigned p,
                           unsigned q, unsigned segments, unsigned tubeSegments) {
    const auto knotAt = [&](double t) {
        const double reach = radius * (1.0 + 0.5 * std::cos(q * t));
        return glm::dvec3(reach * std::cos(p * t), reach * std::sin(p * t),
                          0.5 * radius * std::sin(q * t));
    };
    TriangleMesh mesh;
    for (unsigned i = 0; i < segments; ++i) {
        const double t = kTau * i / segments;
        const double step = 1e-4;
        const glm::dvec3 tangent = glm::normalize(knotAt(t + step) - knotAt(t - step));
        // The torus's own normal turns with the knot and is the same after a full turn.
        const glm::dvec3 ring(radius * std::cos(p * t), radius * std::sin(p * t), 0.0);
        const glm::dvec3 side = glm::normalize(glm::cross(tangent, knotAt(t) - ring));
        const glm::dvec3 out = glm::cross(side, tangent);
        for (unsigned j = 0; j < tubeSegments; ++j) {
            const double angle = kTau * j / tubeSegments;
            addVertex(mesh, glm::dvec3(center) + knotAt(t) +
                                static_cast<double>(tubeRadius) *
                                    (std::cos(angle) * out - std::sin(angle) * side));
        }
    }
    addClosedGrid(mesh, segments, tubeSegments);
    return mesh;
}

TriangleMesh makeMengerSponge(const glm::vec3& center, float edge, unsigned levels) {
    assert(levels <= 4);
    int count = 1;
    for (unsigned level = 0; level < levels; ++level)
        count *= 3;
    return makeLatticeSurface(
        glm::dvec3(center) - 0.5 * edge, static_cast<double>(edge) / count, count,
        [&](const glm::ivec3& cell) { return isInMengerSponge(cell, levels); });
}

TriangleMesh makeLBlock(const glm::vec3& center, float edge) {
    return makeLatticeSurface(glm::dvec3(center) - 0.5 * edge, 0.5 * edge, 2,
                              [](const glm::ivec3& cell) { return cell.x == 0 || cell.y == 0; });
}

TriangleMesh makeNestedShells(const glm::vec3& center, std::span<const float> radii,
                              unsigned subdivisions) {
    TriangleMesh mesh;
    for (std::size_t i = 0; i < radii.size(); ++i) {
        const TriangleMesh shell = makeIcosphere(center, radii[i], subdivisions);
        mesh = merged(mesh, i % 2 == 0 ? shell : flipped(shell));
    }
    return mesh;
}

TriangleMesh makePlane(const glm::vec3& center, const glm::vec3& normal, float edge,
                       unsigned divisions) {
    const glm::dvec3 n = glm::normalize(glm::dvec3(normal));
    const glm::dvec3 u = anyNormal(n);
    const glm::dvec3 v = glm::cross(n, u);
    TriangleMesh mesh;
    for (unsigned i = 0; i <= divisions; ++i)
        for (unsigned j = 0; j <= divisions; ++j)
            addVertex(mesh,
                      glm::dvec3(center) + static_cast<double>(edge) *
                                               ((static_cast<double>(j) / divisions - 0.5) * u +
                                                (static_cast<double>(i) / divisions - 0.5) * v));
    const unsigned row = divisions + 1;
    for (unsigned i = 0; i < divisions; ++i)
        for (unsigned j = 0; j < divisions; ++j)
            addQuad(mesh, i * row + j, i * row + j + 1, (i + 1) * row + j + 1, (i + 1) * row + j);
    return mesh;
}

TriangleMesh makeParallelQuads(const glm::vec3& center, float edge, unsigned count, float spacing) {
    TriangleMesh mesh;
    for (unsigned i = 0; i < count; ++i)
        mesh = merged(mesh, makePlane(center + glm::vec3(0, 0, static_cast<float>(i) * spacing),
                                      {0, 0, 1}, edge));
    return mesh;
}

TriangleMesh makeFan(const glm::vec3& center, float radius, unsigned count, std::uint32_t seed) {
    Random random(seed);
    TriangleMesh mesh;
    addVertex(mesh, center);
    for (unsigned i = 0; i < count; ++i) {
        const double angle = kTau * (i + 0.9 * random.number()) / count;
        addVertex(mesh, glm::dvec3(center) + static_cast<double>(radius) *
                                                 glm::dvec3(std::cos(angle), std::sin(angle), 0.0));
    }
    for (unsigned i = 0; i < count; ++i) {
        const unsigned a = 1 + i;
        const unsigned b = 1 + (i + 1) % count;
        mesh.triangles.push_back(i % 2 == 0 ? glm::uvec3(0, a, b) : glm::uvec3(b, a, 0));
    }
    return mesh;
}

TriangleMesh makeSlivers(const Box3& bounds, unsigned count, float length, float width,
                         std::uint32_t seed) {
    Random random(seed);
    TriangleMesh mesh;
    const double half = 0.5 * length;
    const Box3 inner{bounds.min + half, bounds.max - half};
    for (unsigned i = 0; i < count; ++i) {
        const glm::dvec3 middle = random.inside(inner);
        const glm::dvec3 direction = random.direction();
        const glm::dvec3 side = anyNormal(direction) * (0.5 * width);
        addTriangle(mesh, middle - half * direction - side, middle - half * direction + side,
                    middle + half * direction);
    }
    return mesh;
}

TriangleMesh makeTriangleSoup(const Box3& bounds, unsigned count, float edge, std::uint32_t seed) {
    Random random(seed);
    TriangleMesh mesh;
    const double half = 0.5 * edge;
    const Box3 inner{bounds.min + half, bounds.max - half};
    const Box3 reach{glm::dvec3(-half), glm::dvec3(half)};
    for (unsigned i = 0; i < count; ++i) {
        const glm::dvec3 middle = random.inside(inner);
        const glm::dvec3 a = random.inside(reach);
        const glm::dvec3 b = random.inside(reach);
        const glm::dvec3 c = random.inside(reach);
        addTriangle(mesh, middle + a, middle + b, middle + c);
    }
    return mesh;
}

TriangleMesh merged(const TriangleMesh& first, const TriangleMesh& second) {
    TriangleMesh mesh;
    mesh.positions = first.positions;
    mesh.positions.insert(mesh.positions.end(), second.positions.begin(), second.positions.end());
    mesh.triangles = first.triangles;
    const auto offset = static_cast<std::uint32_t>(first.positions.size());
    for (const glm::uvec3& triangle : second.triangles)
        mesh.triangles.push_back(triangle + offset);
    return mesh;
}

TriangleMesh flipped(const TriangleMesh& mesh) {
    TriangleMesh result = mesh;
    for (glm::uvec3& triangle : result.triangles)
        std::swap(triangle.y, triangle.z);
    return result;
}

TriangleMesh transformed(const TriangleMesh& mesh, const glm::dmat4& matrix) {
    TriangleMesh result = mesh;
    for (glm::vec3& position : result.positions)
        position = glm::vec3(matrix * glm::dvec4(position, 1.0));
    return result;
}

GridTransform makeDyadicGrid(const Box3& bounds, const glm::uvec3& voxels, Axis axis) {
    const glm::dvec3 needed = bounds.size() / glm::dvec3(voxels);
    assert(needed.x > 0.0 || needed.y > 0.0 || needed.z > 0.0);
    double edge = std::exp2(std::floor(std::log2(std::max({needed.x, needed.y, needed.z}))));
    for (;; edge *= 2.0) {
        const glm::dvec3 half = 0.5 * edge * glm::dvec3(voxels);
        const glm::dvec3 corner =
            glm::round((bounds.center() - half) / edge * 16.0) * (edge / 16.0);
        const Box3 box{corner, corner + edge * glm::dvec3(voxels)};
        if (glm::all(glm::lessThanEqual(box.min, bounds.min)) &&
            glm::all(glm::greaterThanEqual(box.max, bounds.max)))
            return *GridTransform::box(box, voxels, axis);
    }
}

TriangleMesh snapped(const TriangleMesh& mesh, const GridTransform& transform, unsigned steps) {
    TriangleMesh result = mesh;
    for (glm::vec3& position : result.positions) {
        const glm::dvec3 grid = transform.worldToGrid(position);
        position = glm::vec3(transform.gridToWorld(glm::round(grid * static_cast<double>(steps)) /
                                                   static_cast<double>(steps)));
    }
    return result;
}

} // namespace lamina::reference
