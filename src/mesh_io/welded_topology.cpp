#include "mesh_io/welded_topology.hpp"

#include "mesh_io/vertex_welder.hpp"

#include <algorithm>

namespace lamina::detail {

WeldedTopology::WeldedTopology(const TriangleMesh& mesh) {
    VertexWelder welder;
    std::vector<std::uint32_t> welded;
    welded.reserve(mesh.positions.size());
    for (const glm::vec3& position : mesh.positions)
        welded.push_back(welder.add(position));
    mPositions = welder.takePositions();

    mTriangles.reserve(mesh.triangles.size());
    for (const glm::uvec3& t : mesh.triangles) {
        const glm::uvec3 triangle(welded[t.x], welded[t.y], welded[t.z]);
        if (triangle.x != triangle.y && triangle.y != triangle.z && triangle.z != triangle.x)
            mTriangles.push_back(triangle);
    }
    sortHalfEdges();
}

void WeldedTopology::sortHalfEdges() {
    // Buckets by the smaller end, then a sort in each: most hold about three half-edges.
    const auto cornerCount = static_cast<std::uint32_t>(mTriangles.size() * 3);
    std::vector<std::uint32_t> begins(mPositions.size() + 1, 0);
    for (std::uint32_t corner = 0; corner < cornerCount; ++corner)
        ++begins[edgeOf(corner).first + 1];
    std::partial_sum(begins.begin(), begins.end(), begins.begin());
    std::vector<std::uint32_t> ends(begins.begin(), begins.end() - 1);
    mHalfEdges.resize(cornerCount);
    for (std::uint32_t corner = 0; corner < cornerCount; ++corner)
        mHalfEdges[ends[edgeOf(corner).first]++] = corner;
    for (std::size_t vertex = 0; vertex < ends.size(); ++vertex)
        std::sort(mHalfEdges.begin() + begins[vertex], mHalfEdges.begin() + ends[vertex],
                  [this](std::uint32_t a, std::uint32_t b) {
                      const std::uint32_t farA = edgeOf(a).second;
                      const std::uint32_t farB = edgeOf(b).second;
                      return farA != farB ? farA < farB : a < b;
                  });
}

DisjointSets WeldedTopology::fans() const {
    DisjointSets sets(mTriangles.size() * 3);
    forEachEdge([&](std::span<const std::uint32_t> halfEdges) {
        if (!isInterior(halfEdges))
            return;
        sets.unite(halfEdges[0], nextCorner(halfEdges[1]));
        sets.unite(nextCorner(halfEdges[0]), halfEdges[1]);
    });
    return sets;
}

} // namespace lamina::detail
