#pragma once

#include <lamina/core/box.hpp>
#include <lamina/core/triangle_mesh.hpp>
#include <lamina/grid/grid_transform.hpp>
#include <lamina/voxelize/voxelizer.hpp>

#include <glm/vec3.hpp>

#include <cstdint>
#include <optional>

namespace lamina::tool {

/// The grid as asked for: by resolution, by voxel size, or as a box with counts (`bounds` and
/// `counts` together). Exactly one of the three.
struct GridRequest {
    std::optional<std::uint32_t> resolution; ///< Voxels along the longest side, >= 1.
    std::optional<double> voxelSize;         ///< Edge, world units, > 0.
    std::optional<Box3> bounds;              ///< World units, min < max.
    std::optional<glm::uvec3> counts;        ///< Along world x, y, z, >= 1.
    std::optional<Axis> axis;                ///< Of projection; nothing: chosen from the mesh.
};

/// Where the voxels will be.
struct GridPlan {
    Box3 bounds;               ///< World units.
    glm::uvec3 counts{1};      ///< Along world x, y, z.
    glm::dvec3 voxelSize{1.0}; ///< Edges, world units.
    Axis axis = Axis::Z;
    bool isAxisChosen = false; ///< Not given by the user.
    /// Columns that all triangles cover together, seen along x, y, z: what the choice compares.
    glm::dvec3 coveredColumns{0.0};

    /// Bits of the grid as Lamina stores it, in bytes.
    [[nodiscard]] double bytes() const;
};

/// Do the edges agree, but for the rounding of boxes made as low corner + count * edge?
[[nodiscard]] bool isCubic(const glm::dvec3& voxelSize);

/// The grid for `mesh`, which has triangles.
///
/// Resolution and voxel size give cubes from the low corner of the mesh's box, counts rounded up. A
/// side that is a whole number of voxels but for the rounding of float coordinates gets no extra
/// one: there the voxels grow by that rounding, so that the whole mesh stays inside. A flat side is
/// one voxel thick. Throws Failure: BadMesh (all vertices in one point), Unsupported (too many
/// voxels to count).
[[nodiscard]] GridPlan planGrid(const GridRequest& request, const TriangleMesh& mesh);

/// About how many voxels a coverage will set, if the mesh lies inside the grid: as many as planes
/// of the triangles' areas touch; for a solid, those inside too. More where surfaces lie close
/// together, fewer where triangles are thin slivers or a mesh without inside is made solid.
[[nodiscard]] double expectedVoxels(const GridPlan& plan, const TriangleMesh& mesh,
                                    Coverage coverage);

/// Memory for the attributes of so many set voxels: while they are made, read back and written.
[[nodiscard]] double attributeBytes(const GridPlan& plan, double voxels);

/// Throws Failure (Unsupported) if the grid, once on the device and once on the host, and the
/// attributes of `attributeVoxels` voxels (0: none are made) take more than `limitBytes`.
void checkMemory(const GridPlan& plan, double attributeVoxels, double limitBytes);

/// Bytes of memory of this machine.
[[nodiscard]] double physicalMemory();

} // namespace lamina::tool
