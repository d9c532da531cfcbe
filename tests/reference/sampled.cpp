#include <reference/sampled.hpp>

#include <reference/column_triangle.hpp>
#include <reference/slices.hpp>

namespace lamina::reference {
namespace {

void addSampled(const ColumnTriangle& triangle, BitGrid& grid) {
    if (doubleArea(triangle) == 0.0)
        return;
    const glm::dvec2 low = triangle.min() - 0.5;
    const glm::dvec2 high = triangle.max() - 0.5;
    const IndexRange columns = indicesBetween(low.x, high.x, grid.size().x);
    const IndexRange rows = indicesBetween(low.y, high.y, grid.size().y);
    for (std::int64_t y = rows.first; y <= rows.last; ++y)
        for (std::int64_t x = columns.first; x <= columns.last; ++x) {
            const glm::dvec2 center(static_cast<double>(x) + 0.5, static_cast<double>(y) + 0.5);
            if (!owns(triangle, center))
                continue;
            const double depth = depthAt(triangle, center);
            const IndexRange slice = slicesTouched(grid.transform(), {depth, depth});
            if (slice.first <= slice.last)
                grid.set({x, y, slice.first});
        }
}

} // namespace

Result<BitGrid> sampled(const TriangleMesh& mesh, const GridTransform& transform,
                        const Options& options) {
    if (auto valid = validate(mesh); !valid)
        return valid.error();
    auto grid = BitGrid::create(transform);
    if (!grid)
        return grid;
    for (const ColumnTriangle& triangle : columnTriangles(mesh, transform, options.model))
        addSampled(triangle, *grid);
    return grid;
}

} // namespace lamina::reference
