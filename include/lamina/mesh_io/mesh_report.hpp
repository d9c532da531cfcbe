#pragma once

#include <lamina/core/box.hpp>
#include <lamina/core/export.hpp>
#include <lamina/core/result.hpp>
#include <lamina/core/triangle_mesh.hpp>

#include <cstdint>

namespace lamina {

/// What a mesh is like. Edges, loops and components are those of the mesh whose vertices at
/// identical positions are one vertex; triangles with two corners in one such vertex have no part
/// in them.
struct MeshReport {
    std::uint64_t triangles = 0;
    std::uint64_t vertices = 0;            ///< As stored, used or not.
    std::uint64_t distinctPositions = 0;   ///< Vertices after welding identical positions.
    std::uint64_t degenerateTriangles = 0; ///< Of zero area: corners coincide or lie on a line.
    std::uint64_t nonFiniteVertices = 0;   ///< With a NaN or infinite coordinate.
    std::uint64_t openEdges = 0;           ///< Of one triangle: the rims of holes.
    std::uint64_t openLoops = 0; ///< Chains of open edges; in a manifold mesh the number of holes.
    std::uint64_t nonManifoldEdges = 0; ///< Of three or more triangles.
    std::uint64_t flippedEdges = 0;     ///< Of two triangles that face opposite sides.
    std::uint64_t components = 0;       ///< Parts that share no vertex.
    double signedVolume = 0.0;          ///< World units cubed; positive if watertight and outward.
    Box3 bounds;                        ///< Of the finite vertices that triangles use, world units.

    /// Every pair of neighbours agrees on which side is outside.
    [[nodiscard]] bool consistentOrientation() const {
        return nonManifoldEdges == 0 && flippedEdges == 0;
    }
    /// Every edge has exactly two triangles, in opposite directions: inside and outside are
    /// defined.
    [[nodiscard]] bool watertight() const {
        return openEdges == 0 && consistentOrientation() && components > 0;
    }
};

/// Counts what a mesh is made of. Any topology is accepted, an empty mesh and non-finite vertices
/// too. Errors: InvalidMesh (index out of range), OutOfMemory. Cost: O(n log n) in the triangles;
/// about 60 bytes a triangle while it runs. Threads: any.
[[nodiscard]] LAMINA_API Result<MeshReport> inspect(const TriangleMesh& mesh);

} // namespace lamina
