#include <reference/crossings.hpp>

#include <reference/column_triangle.hpp>
#include <reference/index_range.hpp>

#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>

#include <algorithm>
#include <cassert>

namespace lamina::reference {
namespace {

void sortByDepth(std::vector<Crossing>& list) {
    std::sort(list.begin(), list.end(), [](const Crossing& a, const Crossing& b) {
        return a.depth != b.depth ? a.depth < b.depth : a.triangle < b.triangle;
    });
}

/// Do columns x, columns y and depth form a right-handed system in the world?
bool isRightHanded(const GridTransform& transform) {
    return glm::determinant(glm::dmat3(transform.worldToColumn())) > 0.0;
}

Crossing crossingAt(const ColumnTriangle& triangle, const glm::dvec2& center, bool rightHanded) {
    return {depthAt(triangle, center), triangle.source,
            (doubleArea(triangle) > 0.0) != rightHanded};
}

glm::dvec2 centerOf(std::int64_t x, std::int64_t y) {
    return {static_cast<double>(x) + 0.5, static_cast<double>(y) + 0.5};
}

} // namespace

std::vector<Crossing> crossings(const TriangleMesh& mesh, const GridTransform& transform,
                                const glm::uvec2& column, const Options& options) {
    assert(validate(mesh));
    const glm::dvec2 center = centerOf(column.x, column.y);
    std::vector<Crossing> list;
    for (const ColumnTriangle& triangle : columnTriangles(mesh, transform, options.model))
        if (owns(triangle, center))
            list.push_back(crossingAt(triangle, center, isRightHanded(transform)));
    sortByDepth(list);
    return list;
}

ColumnCrossings::ColumnCrossings(const TriangleMesh& mesh, const GridTransform& transform,
                                 const Options& options)
    : mWidth(transform.size().x)
    , mLists(mWidth * transform.size().y) {
    assert(validate(mesh));
    const bool rightHanded = isRightHanded(transform);
    for (const ColumnTriangle& triangle : columnTriangles(mesh, transform, options.model)) {
        const glm::dvec2 low = triangle.min() - 0.5;
        const glm::dvec2 high = triangle.max() - 0.5;
        const IndexRange columns = indicesBetween(low.x, high.x, transform.size().x);
        const IndexRange rows = indicesBetween(low.y, high.y, transform.size().y);
        for (std::int64_t y = rows.first; y <= rows.last; ++y)
            for (std::int64_t x = columns.first; x <= columns.last; ++x)
                if (owns(triangle, centerOf(x, y)))
                    mLists[static_cast<std::size_t>(y) * mWidth + static_cast<std::size_t>(x)]
                        .push_back(crossingAt(triangle, centerOf(x, y), rightHanded));
    }
    for (std::vector<Crossing>& list : mLists)
        sortByDepth(list);
}

std::size_t crossingsNearer(std::span<const Crossing> sorted, double depth) {
    const auto end = std::partition_point(sorted.begin(), sorted.end(),
                                          [&](const Crossing& c) { return c.depth < depth; });
    return static_cast<std::size_t>(end - sorted.begin());
}

double depthInside(std::span<const Crossing> sorted, double from, double to) {
    const auto part = [&](double front, double back) {
        return std::max(0.0, std::min(back, to) - std::max(front, from));
    };
    // Paired from the back: an odd one is the exit of a mesh that surrounds a perspective eye.
    std::size_t i = sorted.size() % 2;
    double inside = i == 1 ? part(from, sorted[0].depth) : 0.0;
    for (; i < sorted.size(); i += 2)
        inside += part(sorted[i].depth, sorted[i + 1].depth);
    return inside;
}

double rayLengthPerDepth(const GridTransform& transform, const glm::uvec2& column) {
    const glm::dvec2 center = centerOf(column.x, column.y);
    const glm::dvec3 front = transform.gridToWorld({center, 0.0});
    const glm::dvec3 back = transform.gridToWorld({center, transform.size().z});
    return glm::distance(front, back) / (transform.farDepth() - transform.nearDepth());
}

Result<BitGrid> inside(const TriangleMesh& mesh, const GridTransform& transform,
                       const Options& options) {
    if (auto valid = validate(mesh); !valid)
        return valid.error();
    auto grid = BitGrid::create(transform);
    if (!grid)
        return grid;
    const ColumnCrossings all(mesh, transform, options);
    const glm::uvec3 size = transform.size();
    for (std::uint32_t y = 0; y < size.y; ++y)
        for (std::uint32_t x = 0; x < size.x; ++x) {
            const auto list = all.at({x, y});
            // Counted from the back: in a perspective grid the part before the eye is cut off.
            std::size_t beyond = list.size();
            for (std::uint32_t z = 0; z < size.z && beyond > 0; ++z) {
                const double depth = transform.depthAtSlice(z + 0.5);
                while (beyond > 0 && list[list.size() - beyond].depth <= depth)
                    --beyond;
                if (beyond % 2 == 1)
                    grid->set({x, y, z});
            }
        }
    return grid;
}

} // namespace lamina::reference
