#include <reference/local.hpp>

#include <reference/index_range.hpp>

#include <algorithm>
#include <cmath>

namespace lamina::reference {
namespace {

bool isCenterCovered(const ColumnTriangle& triangle, const glm::dvec2& center, double grow) {
    const bool owned = doubleArea(triangle) != 0.0 && owns(triangle, center);
    if (grow > 0.0)
        return owned || outlineDistance(triangle, center) <= grow;
    return owned && (grow == 0.0 || outlineDistance(triangle, center) >= -grow);
}

std::optional<DepthSpan> spanInColumn(const ColumnTriangle& triangle, const glm::dvec2& center,
                                      ColumnRule rule, double grow) {
    if (rule == ColumnRule::Touch)
        return depthSpan(triangle, center - 0.5 - grow, center + 0.5 + grow);
    if (!isCenterCovered(triangle, center, grow))
        return std::nullopt;
    const double depth = depthAt(triangle, center);
    if (rule == ColumnRule::Centre)
        return DepthSpan{depth, depth};
    auto span = depthSpan(triangle, center - 0.5 - grow, center + 0.5 + grow);
    if (span && isCenterCovered(triangle, center, 0.0))
        span = DepthSpan{std::min(span->min, depth), std::max(span->max, depth)};
    return span;
}

/// Calls visit(column index, span) for each triangle and column that it gives depths.
template<class Visit>
void forEachSpan(const TriangleMesh& mesh, const GridTransform& transform, ColumnRule rule,
                 const Options& options, Visit&& visit) {
    const glm::uvec3 size = transform.size();
    for (const ColumnTriangle& triangle : columnTriangles(mesh, transform, options.model)) {
        const glm::dvec2 low = triangle.min() - 1.0 - std::abs(options.grow);
        const glm::dvec2 high = triangle.max() + std::abs(options.grow);
        const IndexRange columns = indicesBetween(low.x, high.x, size.x);
        const IndexRange rows = indicesBetween(low.y, high.y, size.y);
        for (std::int64_t y = rows.first; y <= rows.last; ++y)
            for (std::int64_t x = columns.first; x <= columns.last; ++x) {
                const glm::dvec2 center(static_cast<double>(x) + 0.5, static_cast<double>(y) + 0.5);
                if (const auto span = spanInColumn(triangle, center, rule, options.grow))
                    visit(static_cast<std::size_t>(y) * size.x + static_cast<std::size_t>(x),
                          *span);
            }
    }
}

/// The slice whose fractions hold `fraction`, in [0, 1].
std::uint32_t sliceOfFraction(const GridTransform& transform, double fraction) {
    const std::uint32_t slices = transform.size().z;
    const auto boundaries = transform.sliceBoundaries();
    std::uint32_t slice = 0;
    while (slice + 1 < slices && (boundaries.empty() ? (slice + 1.0) / slices
                                                     : double{boundaries[slice + 1]}) <= fraction)
        ++slice;
    return slice;
}

} // namespace

std::vector<std::optional<DepthSpan>> columnSpans(const TriangleMesh& mesh,
                                                  const GridTransform& transform, ColumnRule rule,
                                                  const Options& options) {
    const double near = transform.nearDepth();
    const double far = transform.farDepth();
    std::vector<std::optional<DepthSpan>> spans(std::size_t{transform.size().x} *
                                                transform.size().y);
    forEachSpan(mesh, transform, rule, options, [&](std::size_t column, const DepthSpan& span) {
        if (span.max < near || span.min > far)
            return;
        const DepthSpan cut{std::clamp(span.min, near, far), std::clamp(span.max, near, far)};
        auto& sum = spans[column];
        sum = sum ? DepthSpan{std::min(sum->min, cut.min), std::max(sum->max, cut.max)} : cut;
    });
    return spans;
}

Result<BitGrid> local(const TriangleMesh& mesh, const GridTransform& transform,
                      const std::vector<ColumnRange>& ranges, ColumnRule rule,
                      const Options& options, double depthTolerance) {
    if (auto valid = validate(mesh); !valid)
        return valid.error();
    auto grid = BitGrid::create(transform, ranges);
    if (!grid)
        return grid;
    const double tolerance = std::copysign(
        depthTolerance * (transform.farDepth() - transform.nearDepth()), options.grow);
    const std::uint32_t width = transform.size().x;
    forEachSpan(mesh, transform, rule, options, [&](std::size_t column, const DepthSpan& span) {
        const ColumnRange& range = ranges[column];
        const double near = range.near;
        const double extent = range.far - near;
        const double min = span.min - tolerance;
        const double max = span.max + tolerance;
        if (range.isEmpty() || std::max(min, max) < near || std::min(min, max) > range.far)
            return;
        const auto slice = [&](double depth) {
            return extent > 0.0
                       ? sliceOfFraction(transform, std::clamp((depth - near) / extent, 0.0, 1.0))
                       : 0u;
        };
        for (std::uint32_t k = slice(min); k <= slice(max); ++k)
            grid->set({column % width, column / width, k});
    });
    return grid;
}

} // namespace lamina::reference
