#include <reference/filled.hpp>

#include <reference/column_triangle.hpp>
#include <reference/slices.hpp>

#include <algorithm>

namespace lamina::reference {
namespace {

enum class CenterRule { MustBeCovered, Ignored };

bool isCenterCovered(const ColumnTriangle& triangle, const glm::dvec2& center, double grow) {
    const bool owned = doubleArea(triangle) != 0.0 && owns(triangle, center);
    if (grow > 0.0)
        return owned || outlineDistance(triangle, center) <= grow;
    return owned && (grow == 0.0 || outlineDistance(triangle, center) >= -grow);
}

void addColumn(const ColumnTriangle& triangle, std::int64_t x, std::int64_t y, CenterRule rule,
               double grow, BitGrid& grid) {
    const glm::dvec2 corner(static_cast<double>(x), static_cast<double>(y));
    const glm::dvec2 center = corner + 0.5;
    if (rule == CenterRule::MustBeCovered && !isCenterCovered(triangle, center, grow))
        return;
    auto span = depthSpan(triangle, corner - grow, corner + 1.0 + grow);
    if (!span)
        return;
    if (isCenterCovered(triangle, center, 0.0)) {
        // Slivers: the depth at the centre must not round out of the span.
        const double depth = depthAt(triangle, center);
        span = DepthSpan{std::min(span->min, depth), std::max(span->max, depth)};
    }
    const IndexRange slices = slicesTouched(grid.transform(), *span, grow);
    for (std::int64_t z = slices.first; z <= slices.last; ++z)
        grid.set({x, y, z});
}

Result<BitGrid> fillColumns(const TriangleMesh& mesh, const GridTransform& transform,
                            const Options& options, CenterRule rule) {
    if (auto valid = validate(mesh); !valid)
        return valid.error();
    auto grid = BitGrid::create(transform);
    if (!grid)
        return grid;
    for (const ColumnTriangle& triangle : columnTriangles(mesh, transform, options.model)) {
        const glm::dvec2 low = triangle.min() - 1.0 - options.grow;
        const glm::dvec2 high = triangle.max() + options.grow;
        const IndexRange columns = indicesBetween(low.x, high.x, grid->size().x);
        const IndexRange rows = indicesBetween(low.y, high.y, grid->size().y);
        for (std::int64_t y = rows.first; y <= rows.last; ++y)
            for (std::int64_t x = columns.first; x <= columns.last; ++x)
                addColumn(triangle, x, y, rule, options.grow, *grid);
    }
    return grid;
}

} // namespace

Result<BitGrid> filled(const TriangleMesh& mesh, const GridTransform& transform,
                       const Options& options) {
    return fillColumns(mesh, transform, options, CenterRule::MustBeCovered);
}

Result<BitGrid> touched(const TriangleMesh& mesh, const GridTransform& transform,
                        const Options& options) {
    return fillColumns(mesh, transform, options, CenterRule::Ignored);
}

} // namespace lamina::reference
