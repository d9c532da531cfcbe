#include "shadow_volumes/silhouette_edges.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <tuple>

namespace lamina {
namespace {

bool isFinite(const glm::vec3& p) {
    return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z);
}

/// For each vertex the first of those at its place.
std::vector<std::uint32_t> firstAtPlace(std::span<const glm::vec3> positions) {
    std::vector<std::uint32_t> order;
    for (std::uint32_t i = 0; i < positions.size(); ++i)
        if (isFinite(positions[i]))
            order.push_back(i);
    const auto key = [&](std::uint32_t i) {
        const glm::vec3& p = positions[i];
        return std::tuple(p.x, p.y, p.z);
    };
    std::ranges::sort(order, [&](std::uint32_t a, std::uint32_t b) {
        return std::tuple(key(a), a) < std::tuple(key(b), b);
    });
    std::vector<std::uint32_t> first(positions.size());
    std::iota(first.begin(), first.end(), 0u);
    for (std::size_t i = 1; i < order.size(); ++i)
        if (key(order[i]) == key(order[i - 1]))
            first[order[i]] = first[order[i - 1]];
    return first;
}

/// One side of a triangle.
struct Side {
    std::uint32_t low, high; ///< Vertices.
    bool isForward;          ///< From low to high.
    std::uint32_t opposite;  ///< The triangle's third vertex.

    [[nodiscard]] std::uint32_t from() const { return isForward ? low : high; }
    [[nodiscard]] std::uint32_t to() const { return isForward ? high : low; }
};

/// Appends the edges of the sides between two vertices: triangles of opposite directions in pairs,
/// what remains in pairs of one direction, and the last alone.
void appendEdges(std::span<const Side> sides, SilhouetteMesh& mesh) {
    const auto backward = std::ranges::partition_point(sides, &Side::isForward);
    const auto forwardCount = static_cast<std::size_t>(backward - sides.begin());
    const std::size_t pairs = std::min(forwardCount, sides.size() - forwardCount);
    const auto append = [&mesh](const Side& side, std::uint32_t other) {
        mesh.edges.emplace_back(side.opposite, side.from(), side.to(), other);
    };
    for (std::size_t i = 0; i < pairs; ++i)
        append(sides[i], sides[forwardCount + i].opposite);
    if (2 * pairs == sides.size())
        return;
    const bool moreForward = forwardCount > pairs;
    std::size_t i = moreForward ? pairs : forwardCount + pairs;
    const std::size_t end = moreForward ? forwardCount : sides.size();
    mesh.openEdgeCount += static_cast<std::uint32_t>((end - i + 1) / 2);
    for (; i + 1 < end; i += 2)
        append(sides[i], sides[i + 1].opposite);
    if (i < end)
        append(sides[i], sides[i].from());
}

} // namespace

SilhouetteMesh findSilhouetteMesh(std::span<const glm::vec3> positions,
                                  std::span<const std::uint32_t> indices) {
    const std::vector<std::uint32_t> first = firstAtPlace(positions);
    SilhouetteMesh mesh;
    std::vector<Side> sides;
    for (std::size_t i = 0; i + 2 < indices.size(); i += 3) {
        const glm::uvec3 t(first[indices[i]], first[indices[i + 1]], first[indices[i + 2]]);
        if (t.x == t.y || t.y == t.z || t.z == t.x || !isFinite(positions[t.x]) ||
            !isFinite(positions[t.y]) || !isFinite(positions[t.z]))
            continue;
        mesh.triangles.push_back(t);
        for (glm::length_t k = 0; k < 3; ++k) {
            const std::uint32_t from = t[k];
            const std::uint32_t to = t[(k + 1) % 3];
            sides.push_back({std::min(from, to), std::max(from, to), from < to, t[(k + 2) % 3]});
        }
    }
    std::ranges::sort(sides, [](const Side& a, const Side& b) {
        return std::tuple(a.low, a.high, !a.isForward, a.opposite) <
               std::tuple(b.low, b.high, !b.isForward, b.opposite);
    });
    mesh.edges.reserve(sides.size() / 2);
    for (auto begin = sides.begin(); begin != sides.end();) {
        const auto end = std::find_if(begin, sides.end(), [&](const Side& side) {
            return side.low != begin->low || side.high != begin->high;
        });
        appendEdges({begin, end}, mesh);
        begin = end;
    }
    return mesh;
}

} // namespace lamina
