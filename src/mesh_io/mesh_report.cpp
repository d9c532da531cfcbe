#include <lamina/mesh_io/mesh_report.hpp>

#include "mesh_io/read_support.hpp"
#include "mesh_io/welded_topology.hpp"

#include <glm/geometric.hpp>

#include <algorithm>
#include <new>
#include <string>

namespace lamina {
namespace {

Result<void> checkIndices(const TriangleMesh& mesh) {
    if (mesh.triangles.size() > detail::WeldedTopology::kMaxTriangles)
        return Error{ErrorCode::InvalidMesh, "inspect: expected at most 2^30 triangles, found " +
                                                 std::to_string(mesh.triangles.size())};
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i)
        for (int corner = 0; corner < 3; ++corner)
            if (mesh.triangles[i][corner] >= mesh.positions.size())
                return Error{ErrorCode::InvalidMesh, "inspect: expected vertex indices below " +
                                                         std::to_string(mesh.positions.size()) +
                                                         ", found " +
                                                         std::to_string(mesh.triangles[i][corner]) +
                                                         " in triangle " + std::to_string(i)};
    return {};
}

void measureTriangles(const TriangleMesh& mesh, MeshReport& report) {
    for (const glm::uvec3& triangle : mesh.triangles)
        for (int corner = 0; corner < 3; ++corner)
            if (const glm::vec3& p = mesh.positions[triangle[corner]]; detail::isFinite(p))
                report.bounds.extend(glm::dvec3(p));
    // Volumes of tetrahedra over the box's centre, where they cancel best.
    const glm::dvec3 center = report.bounds.isEmpty() ? glm::dvec3(0.0) : report.bounds.center();
    for (const glm::uvec3& triangle : mesh.triangles) {
        const glm::vec3& a = mesh.positions[triangle.x];
        const glm::vec3& b = mesh.positions[triangle.y];
        const glm::vec3& c = mesh.positions[triangle.z];
        if (!detail::isFinite(a) || !detail::isFinite(b) || !detail::isFinite(c))
            continue;
        const glm::dvec3 normal =
            glm::cross(glm::dvec3(b) - glm::dvec3(a), glm::dvec3(c) - glm::dvec3(a));
        report.degenerateTriangles += normal == glm::dvec3(0.0);
        report.signedVolume += glm::dot(glm::dvec3(a) - center, normal) / 6.0;
    }
}

void countEdges(const detail::WeldedTopology& topology, MeshReport& report) {
    detail::DisjointSets chains = topology.fans();
    std::vector<std::uint32_t> open;
    topology.forEachEdge([&](std::span<const std::uint32_t> halfEdges) {
        if (halfEdges.size() == 1)
            open.push_back(halfEdges[0]);
        else if (halfEdges.size() > 2)
            ++report.nonManifoldEdges;
        else if (!topology.isInterior(halfEdges))
            ++report.flippedEdges;
    });
    report.openEdges = open.size();
    for (const std::uint32_t halfEdge : open)
        chains.unite(halfEdge, detail::WeldedTopology::nextCorner(halfEdge));
    for (std::uint32_t& halfEdge : open)
        halfEdge = chains.find(halfEdge);
    std::sort(open.begin(), open.end());
    report.openLoops =
        static_cast<std::uint64_t>(std::unique(open.begin(), open.end()) - open.begin());
}

void countComponents(const detail::WeldedTopology& topology, MeshReport& report) {
    detail::DisjointSets parts(topology.positions().size());
    std::vector<bool> used(topology.positions().size(), false);
    for (const glm::uvec3& triangle : topology.triangles()) {
        parts.unite(triangle.x, triangle.y);
        parts.unite(triangle.x, triangle.z);
        for (int corner = 0; corner < 3; ++corner)
            used[triangle[corner]] = true;
    }
    for (std::uint32_t vertex = 0; vertex < used.size(); ++vertex)
        report.components += used[vertex] && parts.find(vertex) == vertex;
}

} // namespace

Result<MeshReport> inspect(const TriangleMesh& mesh) {
    try {
        if (const Result<void> checked = checkIndices(mesh); !checked)
            return checked.error();
        MeshReport report;
        report.triangles = mesh.triangles.size();
        report.vertices = mesh.positions.size();
        report.nonFiniteVertices = static_cast<std::uint64_t>(
            std::count_if(mesh.positions.begin(), mesh.positions.end(),
                          [](const glm::vec3& p) { return !detail::isFinite(p); }));
        measureTriangles(mesh, report);
        const detail::WeldedTopology topology(mesh);
        report.distinctPositions = topology.positions().size();
        countEdges(topology, report);
        countComponents(topology, report);
        return report;
    } catch (const std::bad_alloc&) {
        return Error{ErrorCode::OutOfMemory,
                     "inspect: expected enough memory for the edges, found too little"};
    }
}

} // namespace lamina
