#include <lamina/mesh_io/mesh_normals.hpp>
#include <lamina/mesh_io/subdivision.hpp>

#include "mesh_io/welded_topology.hpp"

// OpenMesh's headers do not pass our warnings.
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wall"
#pragma GCC diagnostic ignored "-Wextra"
#pragma GCC diagnostic ignored "-Wpedantic"
#include <OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh>
#include <OpenMesh/Tools/Subdivider/Uniform/LoopT.hh>
#pragma GCC diagnostic pop

#include <new>
#include <string>

namespace lamina {
namespace {

struct HalfEdgeTraits : OpenMesh::DefaultTraits {
    using Point = OpenMesh::Vec3d;
};
using HalfEdgeMesh = OpenMesh::TriMesh_ArrayKernelT<HalfEdgeTraits>;

/// Why OpenMesh would refuse (and print about) a face: it must never see such a mesh.
Result<void> checkManifold(const detail::WeldedTopology& topology) {
    std::uint64_t bad = 0;
    topology.forEachEdge([&](std::span<const std::uint32_t> halfEdges) {
        bad += halfEdges.size() > 1 && !topology.isInterior(halfEdges);
    });
    if (bad == 0)
        return {};
    return Error{
        ErrorCode::InvalidMesh,
        "subdivide: expected edges of one triangle, or of two in opposite directions, found " +
            std::to_string(bad) + " others; see inspect()"};
}

/// Vertices where several fans of triangles touch become one vertex a fan.
HalfEdgeMesh buildHalfEdges(const detail::WeldedTopology& topology) {
    HalfEdgeMesh mesh;
    detail::DisjointSets fans = topology.fans();
    std::vector<HalfEdgeMesh::VertexHandle> handles(topology.triangles().size() * 3);
    const auto vertexOf = [&](std::uint32_t corner) {
        HalfEdgeMesh::VertexHandle& handle = handles[fans.find(corner)];
        if (!handle.is_valid()) {
            const glm::vec3& p = topology.positions()[topology.vertexAt(corner)];
            handle = mesh.add_vertex({p.x, p.y, p.z});
        }
        return handle;
    };
    for (std::uint32_t corner = 0; corner < handles.size(); corner += 3) {
        const auto a = vertexOf(corner);
        const auto b = vertexOf(corner + 1);
        const auto c = vertexOf(corner + 2);
        mesh.add_face(a, b, c);
    }
    return mesh;
}

TriangleMesh toTriangles(const HalfEdgeMesh& source) {
    TriangleMesh mesh;
    mesh.positions.reserve(source.n_vertices());
    mesh.triangles.reserve(source.n_faces());
    for (const auto vertex : source.vertices()) {
        const OpenMesh::Vec3d& p = source.point(vertex);
        mesh.positions.emplace_back(p[0], p[1], p[2]);
    }
    for (const auto face : source.faces()) {
        glm::uvec3 triangle;
        int corner = 0;
        for (const auto vertex : source.fv_range(face))
            triangle[corner++] = static_cast<std::uint32_t>(vertex.idx());
        mesh.triangles.push_back(triangle);
    }
    return mesh;
}

Result<TriangleMesh> subdivideUnguarded(const TriangleMesh& mesh, unsigned levels) {
    if (const Result<void> checked = validate(mesh); !checked)
        return Error{checked.error().code, "subdivide: " + checked.error().text};
    constexpr std::size_t kMax = detail::WeldedTopology::kMaxTriangles;
    if (levels > 15 || mesh.triangles.size() > (kMax >> (2 * levels)))
        return Error{ErrorCode::InvalidArgument,
                     "subdivide: expected a result of at most 2^30 triangles, found " +
                         std::to_string(mesh.triangles.size()) + " x 4^" + std::to_string(levels)};
    const detail::WeldedTopology topology(mesh);
    if (const Result<void> checked = checkManifold(topology); !checked)
        return checked.error();
    HalfEdgeMesh halfEdges = buildHalfEdges(topology);
    if (levels > 0) {
        OpenMesh::Subdivider::Uniform::LoopT<HalfEdgeMesh> loop;
        loop(halfEdges, levels);
    }
    TriangleMesh result = toTriangles(halfEdges);
    if (result.triangles.empty())
        return Error{ErrorCode::InvalidMesh,
                     "subdivide: expected a triangle with three distinct corners, found none"};
    computeNormals(result);
    return result;
}

} // namespace

Result<TriangleMesh> subdivide(const TriangleMesh& mesh, unsigned levels) {
    try {
        return subdivideUnguarded(mesh, levels);
    } catch (const std::bad_alloc&) {
        return Error{ErrorCode::OutOfMemory,
                     "subdivide: expected enough memory for the result, found too little"};
    }
}

} // namespace lamina
