#include "gl/support/closed_holes.hpp"

#include <lamina/mesh_io/subdivision.hpp>

// OpenMesh's headers do not pass our warnings.
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wall"
#pragma GCC diagnostic ignored "-Wextra"
#pragma GCC diagnostic ignored "-Wpedantic"
#include <OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh>
#pragma GCC diagnostic pop

#include <gtest/gtest.h>

#include <vector>

namespace lamina::test {

TriangleMesh withHolesClosed(const TriangleMesh& mesh) {
    const auto welded = subdivide(mesh, 0);
    EXPECT_TRUE(welded) << welded.error().text;
    if (!welded)
        return mesh;
    TriangleMesh closed;
    closed.positions = welded->positions;
    closed.triangles = welded->triangles;
    using HalfEdges = OpenMesh::TriMesh_ArrayKernelT<>;
    HalfEdges edges;
    for (const glm::vec3& p : closed.positions)
        edges.add_vertex({p.x, p.y, p.z});
    const auto vertex = [&](unsigned i) { return edges.vertex_handle(i); };
    for (const glm::uvec3& t : closed.triangles)
        EXPECT_TRUE(edges.add_face(vertex(t.x), vertex(t.y), vertex(t.z)).is_valid());
    std::vector<bool> isDone(edges.n_halfedges(), false);
    const auto index = [](auto handle) { return static_cast<std::size_t>(handle.idx()); };
    for (const auto first : edges.halfedges()) {
        if (!edges.is_boundary(first) || isDone[index(first)])
            continue;
        // Along the rim, with the hole to the left.
        std::vector<unsigned> rim;
        glm::dvec3 sum(0.0);
        for (HalfEdges::HalfedgeHandle edge = first; !isDone[index(edge)];
             edge = edges.next_halfedge_handle(edge)) {
            isDone[index(edge)] = true;
            rim.push_back(static_cast<unsigned>(edges.from_vertex_handle(edge).idx()));
            sum += glm::dvec3(closed.positions[rim.back()]);
        }
        const auto middle = static_cast<unsigned>(closed.positions.size());
        closed.positions.emplace_back(sum / static_cast<double>(rim.size()));
        for (std::size_t i = 0; i < rim.size(); ++i)
            closed.triangles.push_back({rim[i], rim[(i + 1) % rim.size()], middle});
    }
    return closed;
}

} // namespace lamina::test
