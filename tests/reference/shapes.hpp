#pragma once

#include <lamina/core/triangle_mesh.hpp>
#include <lamina/grid/grid_transform.hpp>

#include <glm/mat4x4.hpp>

#include <cstdint>
#include <span>

/// Meshes with known answers, for tests and benchmarks. World units; positions only, no normals or
/// colours. Solids are closed and counter-clockwise seen from outside.
namespace lamina::reference {

/// 12 triangles. Needs min < max.
[[nodiscard]] TriangleMesh makeBox(const glm::vec3& min, const glm::vec3& max);
/// A box around `center`.
[[nodiscard]] TriangleMesh makeCube(const glm::vec3& center, float edge);
/// Four points in any order, not in one plane; oriented outward.
[[nodiscard]] TriangleMesh makeTetrahedron(const glm::vec3& a, const glm::vec3& b,
                                           const glm::vec3& c, const glm::vec3& d);
/// Around z. segments >= 3 around, rings >= 2 from pole to pole; 2 segments (rings - 1) triangles.
[[nodiscard]] TriangleMesh makeUvSphere(const glm::vec3& center, float radius, unsigned segments,
                                        unsigned rings);
/// 20 * 4^subdivisions triangles, nearly equal.
[[nodiscard]] TriangleMesh makeIcosphere(const glm::vec3& center, float radius,
                                         unsigned subdivisions);
/// Around z. majorRadius to the tube's centre line; 2 majorSegments minorSegments triangles.
[[nodiscard]] TriangleMesh makeTorus(const glm::vec3& center, float majorRadius, float minorRadius,
                                     unsigned majorSegments, unsigned minorSegments);
/// A tube along the (p,q) torus knot around z: p turns around z, q around the torus's ring. The
/// knot's radius swings between 0.5 and 1.5 times `radius`. p and q without common factor.
[[nodiscard]] TriangleMesh makeTorusKnot(const glm::vec3& center, float radius, float tubeRadius,
                                         unsigned p, unsigned q, unsigned segments,
                                         unsigned tubeSegments);
/// Menger sponge in the cube around `center`: 20^levels small cubes, 0 to 4 levels; vertices on
/// multiples of edge / 3^levels. Volume edge^3 (20/27)^levels.
[[nodiscard]] TriangleMesh makeMengerSponge(const glm::vec3& center, float edge, unsigned levels);
/// The cube around `center` without its octant of high x and high y (all z): an L seen along z.
/// Volume 3/4 edge^3.
[[nodiscard]] TriangleMesh makeLBlock(const glm::vec3& center, float edge);
/// Spheres about `center`, facing outward and inward in turn, the first outward: layers of solid
/// and hollow. radii: decreasing.
[[nodiscard]] TriangleMesh makeNestedShells(const glm::vec3& center, std::span<const float> radii,
                                            unsigned subdivisions);

/// A square about `center` at right angles to `normal` (any length), facing it; `edge` long;
/// 2 divisions^2 triangles.
[[nodiscard]] TriangleMesh makePlane(const glm::vec3& center, const glm::vec3& normal, float edge,
                                     unsigned divisions = 1);
/// `count` squares facing +z about (center.x, center.y), at z = center.z + i * spacing.
[[nodiscard]] TriangleMesh makeParallelQuads(const glm::vec3& center, float edge, unsigned count,
                                             float spacing);
/// A fan of `count` triangles around `center` to random points at `radius` in the plane z =
/// center.z; together they tile a polygon exactly. Neighbours share edges, windings alternate.
[[nodiscard]] TriangleMesh makeFan(const glm::vec3& center, float radius, unsigned count,
                                   std::uint32_t seed);
/// Separate needles in random directions inside `bounds`: `length` long, `width` wide at one end.
[[nodiscard]] TriangleMesh makeSlivers(const Box3& bounds, unsigned count, float length,
                                       float width, std::uint32_t seed);
/// Separate random triangles inside `bounds`; corners at most edge / 2 from a random centre along
/// each axis.
[[nodiscard]] TriangleMesh makeTriangleSoup(const Box3& bounds, unsigned count, float edge,
                                            std::uint32_t seed);

/// Both meshes as one.
[[nodiscard]] TriangleMesh merged(const TriangleMesh& first, const TriangleMesh& second);
/// Every triangle wound the other way.
[[nodiscard]] TriangleMesh flipped(const TriangleMesh& mesh);
/// Positions times an affine matrix; windings are kept as they are, also by a mirror.
[[nodiscard]] TriangleMesh transformed(const TriangleMesh& mesh, const glm::dmat4& matrix);

/// A box grid around `bounds` whose voxels are cubes with a power-of-two edge and whose corner is a
/// multiple of edge / 16: grid coordinates of multiples of edge / 16 are exact in float.
/// bounds: not a point; voxels: along world x, y, z; the smallest edge that holds `bounds`.
[[nodiscard]] GridTransform makeDyadicGrid(const Box3& bounds, const glm::uvec3& voxels,
                                           Axis axis = Axis::Z);
/// The mesh with its vertices moved so that their grid coordinates are multiples of 1/steps column
/// and slice: occupancy then compares exactly in single precision. Exact for grids of
/// makeDyadicGrid() and power-of-two steps, else as near as float positions allow. Vertices must
/// lie within the grid's depths. Triangles may collapse.
[[nodiscard]] TriangleMesh snapped(const TriangleMesh& mesh, const GridTransform& transform,
                                   unsigned steps = 16);

} // namespace lamina::reference
