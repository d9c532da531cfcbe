#pragma once

#include <lamina/core/triangle_mesh.hpp>
#include <lamina/grid/bit_grid.hpp>

#include <reference/options.hpp>

#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include <cstdint>
#include <vector>

namespace lamina::reference {

/// What surfaces leave in one voxel.
struct VoxelSurface {
    double area = 0.0;        ///< Of all triangles' parts in the voxel, world units squared.
    glm::dvec4 color{0.0};    ///< Sum over parts of area times the colour at the part's centroid.
    glm::dvec3 normal{0.0};   ///< The same of the interpolated normal, made unit length.
    std::uint32_t hits = 0;   ///< Triangles that touch the voxel.
    double largestPart = 0.0; ///< Area.
};

/// For each set voxel of `bits`, in the order of BitGrid::forEachSet(): clips every triangle to the
/// voxel's box (Sutherland and Hodgman) and integrates over what is left.
/// mesh: valid; without normals the faces' own, without colours white. Orthographic grids with
/// linear slices. options: model; grow enlarges the boxes.
[[nodiscard]] std::vector<VoxelSurface> surfaces(const TriangleMesh& mesh, const BitGrid& bits,
                                                 const Options& options = {});

} // namespace lamina::reference
