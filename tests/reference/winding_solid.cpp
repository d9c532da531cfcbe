#include <reference/winding_solid.hpp>

#include <reference/crossings.hpp>
#include <reference/shapes.hpp>
#include <reference/winding_number.hpp>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <array>
#include <cassert>
#include <map>
#include <numbers>
#include <numeric>
#include <vector>

namespace lamina::reference {
namespace {

using Position = std::array<float, 3>;

Position key(const glm::vec3& position) {
    return {position.x, position.y, position.z};
}

/// Groups of numbers that were joined.
class Groups {
public:
    explicit Groups(std::size_t count)
        : mParent(count) {
        std::iota(mParent.begin(), mParent.end(), std::size_t{0});
    }
    std::size_t of(std::size_t member) const {
        while (mParent[member] != member)
            member = mParent[member];
        return member;
    }
    void join(std::size_t a, std::size_t b) { mParent[of(a)] = of(b); }

private:
    std::vector<std::size_t> mParent;
};

/// Signed crossings beyond the voxel centres of one column: more exits than entries inside.
std::vector<int> windingsOfColumn(std::span<const Crossing> sorted,
                                  const GridTransform& transform) {
    std::vector<int> windings(transform.size().z, 0);
    std::size_t next = sorted.size();
    int beyond = 0;
    for (std::size_t slice = windings.size(); slice-- > 0;) {
        const double center = transform.depthAtSlice(static_cast<double>(slice) + 0.5);
        for (; next > 0 && sorted[next - 1].depth > center; --next)
            beyond += sorted[next - 1].frontFacing ? -1 : 1;
        windings[slice] = beyond;
    }
    return windings;
}

/// Subtracts the closure's share from whole winding numbers, block by block.
class WindingSolid {
public:
    WindingSolid(const TriangleMesh& caps, const GridTransform& transform,
                 std::vector<std::vector<int>> windings, BitGrid& out)
        : mCaps(caps)
        , mTransform(transform)
        , mWindings(std::move(windings))
        , mOut(out) {
        for (const glm::uvec3& t : caps.triangles) {
            const glm::dvec3 a(caps.positions[t.x]);
            const glm::dvec3 b(caps.positions[t.y]);
            const glm::dvec3 c(caps.positions[t.z]);
            const glm::dvec3 middle = (a + b + c) / 3.0;
            const double radius = std::max(
                {glm::distance(a, middle), glm::distance(b, middle), glm::distance(c, middle)});
            mShapes.push_back({middle, radius, 0.5 * glm::length(glm::cross(b - a, c - a))});
        }
    }

    void decide(const glm::uvec3& low, const glm::uvec3& high) {
        if (mostInBlock(low, high) < 0.5) {
            forEach(low, high, [&](const glm::uvec3& v) { mOut.set(v, windingAt(v) >= 1); });
            return;
        }
        if (low == high) {
            const double winding =
                windingAt(low) - windingNumber(mCaps, mTransform.voxelCenter(low));
            mOut.set(low, winding > 0.5);
            return;
        }
        const glm::uvec3 middle = (low + high) / 2u;
        for (unsigned octant = 0; octant < 8; ++octant) {
            glm::uvec3 first = low;
            glm::uvec3 last = middle;
            for (int axis = 0; axis < 3; ++axis)
                if ((octant >> static_cast<unsigned>(axis)) & 1u) {
                    first[axis] = middle[axis] + 1;
                    last[axis] = high[axis];
                }
            if (glm::all(glm::lessThanEqual(first, last)))
                decide(first, last);
        }
    }

private:
    struct Shape {
        glm::dvec3 middle;
        double radius;
        double area;
    };

    [[nodiscard]] int windingAt(const glm::uvec3& v) const {
        return mWindings[static_cast<std::size_t>(v.y) * mTransform.size().x + v.x][v.z];
    }

    /// A bound of the closure's winding number for all voxel centres of the block: a triangle is
    /// seen under at most area / distance^2, and never under more than half of everything.
    [[nodiscard]] double mostInBlock(const glm::uvec3& low, const glm::uvec3& high) const {
        const glm::dvec3 a = mTransform.voxelCenter(low);
        const glm::dvec3 b = mTransform.voxelCenter(high);
        const glm::dvec3 middle = (a + b) * 0.5;
        const double radius = glm::distance(a, b) * 0.5;
        double most = 0.0;
        for (const Shape& shape : mShapes) {
            const double distance =
                std::max(glm::distance(middle, shape.middle) - radius - shape.radius, 0.0);
            most += distance > 0.0
                        ? std::min(0.5, shape.area / (4.0 * std::numbers::pi * distance * distance))
                        : 0.5;
        }
        return most;
    }

    template<class Visitor>
    static void forEach(const glm::uvec3& low, const glm::uvec3& high, Visitor&& visit) {
        for (std::uint32_t z = low.z; z <= high.z; ++z)
            for (std::uint32_t y = low.y; y <= high.y; ++y)
                for (std::uint32_t x = low.x; x <= high.x; ++x)
                    visit(glm::uvec3(x, y, z));
    }

    const TriangleMesh& mCaps;
    const GridTransform& mTransform;
    std::vector<std::vector<int>> mWindings;
    BitGrid& mOut;
    std::vector<Shape> mShapes;
};

} // namespace

TriangleMesh closure(const TriangleMesh& mesh) {
    assert(validate(mesh));
    std::map<Position, std::uint32_t> numbers;
    TriangleMesh caps;
    const auto number = [&](const glm::vec3& position) {
        const auto [entry, isNew] =
            numbers.emplace(key(position), static_cast<std::uint32_t>(caps.positions.size()));
        if (isNew)
            caps.positions.push_back(position);
        return entry->second;
    };
    // How often an edge is walked from its lower to its higher vertex, less how often back.
    std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;
    for (const glm::uvec3& triangle : mesh.triangles)
        for (int i = 0; i < 3; ++i) {
            const std::uint32_t a = number(mesh.positions[triangle[i]]);
            const std::uint32_t b = number(mesh.positions[triangle[(i + 1) % 3]]);
            if (a != b)
                edges[{std::min(a, b), std::max(a, b)}] += a < b ? 1 : -1;
        }
    std::erase_if(edges, [](const auto& edge) { return edge.second == 0; });

    Groups groups(caps.positions.size());
    for (const auto& [edge, count] : edges)
        groups.join(edge.first, edge.second);
    std::map<std::size_t, std::pair<glm::dvec3, double>> sums;
    for (const auto& [edge, count] : edges) {
        auto& [sum, weight] = sums[groups.of(edge.first)];
        sum += glm::dvec3(caps.positions[edge.first]) + glm::dvec3(caps.positions[edge.second]);
        weight += 2.0;
    }
    std::map<std::size_t, std::uint32_t> apexes;
    for (const auto& [group, sum] : sums) {
        apexes[group] = static_cast<std::uint32_t>(caps.positions.size());
        caps.positions.push_back(glm::vec3(sum.first / sum.second));
    }
    for (const auto& [edge, count] : edges) {
        const std::uint32_t apex = apexes[groups.of(edge.first)];
        const bool isAscending = count > 0;
        for (int i = 0; i < std::abs(count); ++i)
            caps.triangles.push_back(isAscending ? glm::uvec3(edge.second, edge.first, apex)
                                                 : glm::uvec3(edge.first, edge.second, apex));
    }
    return caps;
}

Result<BitGrid> insideByWinding(const TriangleMesh& mesh, const GridTransform& transform) {
    if (auto valid = validate(mesh); !valid)
        return valid.error();
    auto out = BitGrid::create(transform);
    if (!out)
        return out;
    const TriangleMesh caps = closure(mesh);
    const ColumnCrossings crossings(merged(mesh, caps), transform);
    std::vector<std::vector<int>> windings;
    for (std::uint32_t y = 0; y < transform.size().y; ++y)
        for (std::uint32_t x = 0; x < transform.size().x; ++x)
            windings.push_back(windingsOfColumn(crossings.at({x, y}), transform));
    WindingSolid(caps, transform, std::move(windings), *out)
        .decide(glm::uvec3(0), transform.size() - 1u);
    return out;
}

} // namespace lamina::reference
