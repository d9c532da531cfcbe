#pragma once

#include <lamina/core/triangle_mesh.hpp>

#include <cstdint>
#include <numeric>
#include <span>
#include <utility>
#include <vector>

namespace lamina::detail {

/// Disjoint sets of 0 to count - 1.
class DisjointSets {
public:
    explicit DisjointSets(std::size_t count)
        : mParents(count) {
        std::iota(mParents.begin(), mParents.end(), 0u);
    }
    [[nodiscard]] std::uint32_t find(std::uint32_t item) {
        while (mParents[item] != item)
            item = mParents[item] = mParents[mParents[item]];
        return item;
    }
    void unite(std::uint32_t a, std::uint32_t b) {
        a = find(a);
        b = find(b);
        mParents[a < b ? b : a] = a < b ? a : b;
    }

private:
    std::vector<std::uint32_t> mParents;
};

/// The triangles of a mesh over its distinct positions, and which of them meet at each edge.
/// Triangles that have two corners at one position are left out.
///
/// Corner c of triangle t is 3 t + c; it also names the half-edge from there to the next corner.
class WeldedTopology {
public:
    /// Corners must fit 32 bits.
    static constexpr std::size_t kMaxTriangles = std::size_t{1} << 30u;

    /// `mesh`: indices in range, at most kMaxTriangles triangles.
    explicit WeldedTopology(const TriangleMesh& mesh);

    [[nodiscard]] const std::vector<glm::vec3>& positions() const { return mPositions; }
    [[nodiscard]] const std::vector<glm::uvec3>& triangles() const { return mTriangles; }

    [[nodiscard]] static std::uint32_t nextCorner(std::uint32_t corner) {
        return corner % 3 == 2 ? corner - 2 : corner + 1;
    }
    /// The distinct position at a corner.
    [[nodiscard]] std::uint32_t vertexAt(std::uint32_t corner) const {
        return mTriangles[corner / 3][static_cast<int>(corner % 3)];
    }
    /// Is this edge one of exactly two triangles in opposite directions?
    [[nodiscard]] bool isInterior(std::span<const std::uint32_t> halfEdges) const {
        return halfEdges.size() == 2 && vertexAt(halfEdges[0]) != vertexAt(halfEdges[1]);
    }
    /// Calls visit(span of half-edges) for each edge.
    template<class Visitor>
    void forEachEdge(Visitor&& visit) const {
        std::size_t begin = 0;
        for (std::size_t end = 1; end <= mHalfEdges.size(); ++end)
            if (end == mHalfEdges.size() || edgeOf(mHalfEdges[end]) != edgeOf(mHalfEdges[begin])) {
                visit(std::span(mHalfEdges).subspan(begin, end - begin));
                begin = end;
            }
    }
    /// Corners around a vertex that hang together over interior edges are one set.
    [[nodiscard]] DisjointSets fans() const;

private:
    /// The two ends, smaller first.
    [[nodiscard]] std::pair<std::uint32_t, std::uint32_t> edgeOf(std::uint32_t halfEdge) const {
        const std::uint32_t a = vertexAt(halfEdge);
        const std::uint32_t b = vertexAt(nextCorner(halfEdge));
        return a < b ? std::pair(a, b) : std::pair(b, a);
    }
    void sortHalfEdges();

    std::vector<glm::vec3> mPositions;
    std::vector<glm::uvec3> mTriangles;
    std::vector<std::uint32_t> mHalfEdges; ///< Those of an edge stand together.
};

} // namespace lamina::detail
