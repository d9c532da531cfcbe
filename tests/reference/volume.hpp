#pragma once

#include <lamina/core/triangle_mesh.hpp>
#include <lamina/grid/grid_transform.hpp>

#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>

#include <cstddef>
#include <cstdint>
#include <vector>

namespace lamina::reference {

struct VolumeOptions {
    glm::dmat4 model{1.0}; ///< Mesh to world; affine.
    double slabOverlap = 0.0;
};

/// Hits of triangles in voxels, and sums over them. x fastest, then y, then slice.
struct Volume {
    GridTransform transform;
    std::vector<std::uint32_t> counts;
    std::vector<glm::dvec3> normalSums; ///< Of unit normals in world space.
    std::vector<glm::dvec3> colorSums;

    [[nodiscard]] std::size_t index(const glm::uvec3& voxel) const {
        const glm::uvec3& size = transform.size();
        return (std::size_t{voxel.z} * size.y + voxel.y) * size.x + voxel.x;
    }
};

/// Clips triangles to slabs and samples what is left at the columns' centres. A triangle hits voxel
/// (i,j,k) if
///   - its projection owns the centre of column (i,j) (see owns()), and
///   - its depth there lies in the grid's depths and, in slice coordinates, in
///     [k - overlap, k + 1 + overlap), to which far belongs for the last slice (see kDepthSnap).
/// Then the part of the triangle inside slab k owns the centre. Without overlap that is one voxel
/// for each centre that a triangle owns within the grid. Both windings count; zero-area projections
/// hit nothing. The normal of a hit is the vertex normals' (the face's without them), taken to the
/// world, at the world point of the hit; its colour the vertices' there (white without them).
/// mesh: valid.
[[nodiscard]] Volume volume(const TriangleMesh& mesh, const GridTransform& transform,
                            const VolumeOptions& options = {});

} // namespace lamina::reference
