#include <reference/column_triangle.hpp>

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace lamina::reference {
namespace {

/// Vertices as worldToColumn() gives them: x and y times w, depth, w.
using Polygon = std::vector<glm::dvec4>;

double cross(const glm::dvec2& a, const glm::dvec2& b) {
    return a.x * b.y - a.y * b.x;
}

/// Always from the cut-off end to the kept one, so that two triangles sharing the edge get the
/// same point.
glm::dvec4 cutPoint(const glm::dvec4& outside, const glm::dvec4& kept, double depth) {
    return outside + (kept - outside) * ((depth - outside.z) / (kept.z - outside.z));
}

Polygon cutAtDepth(const Polygon& polygon, double depth) {
    Polygon kept;
    for (std::size_t i = 0; i < polygon.size(); ++i) {
        const glm::dvec4& from = polygon[i];
        const glm::dvec4& to = polygon[(i + 1) % polygon.size()];
        if (from.z >= depth)
            kept.push_back(from);
        if ((from.z >= depth) != (to.z >= depth))
            kept.push_back(from.z >= depth ? cutPoint(to, from, depth) : cutPoint(from, to, depth));
    }
    return kept;
}

/// The quantity that is affine in column coordinates.
double depthToAffine(const ColumnTriangle& triangle, double depth) {
    return triangle.projection == Projection::Perspective ? 1.0 / depth : depth;
}

/// Back to depth, between two depths that are known to enclose it.
double affineToDepth(const ColumnTriangle& triangle, double value, DepthSpan bounds) {
    if (triangle.projection == Projection::Orthographic)
        return std::clamp(value, bounds.min, bounds.max);
    const double positive = std::clamp(value, 1.0 / bounds.max, 1.0 / bounds.min);
    return std::clamp(1.0 / positive, bounds.min, bounds.max);
}

DepthSpan ordered(double a, double b) {
    return {std::min(a, b), std::max(a, b)};
}

/// Twice the signed area of the fan triangle of corners 0, i - 1 and i.
double fanArea(const ColumnTriangle& triangle, int i) {
    return cross(triangle.corners[i - 1] - triangle.corners[0],
                 triangle.corners[i] - triangle.corners[0]);
}

/// Is the point inside the triangle or on its outline? No area: nothing is.
bool closedContains(const ColumnTriangle& triangle, const glm::dvec2& point) {
    const double area = doubleArea(triangle);
    if (area == 0.0)
        return false;
    for (int i = 0; i < triangle.cornerCount; ++i) {
        const glm::dvec2& from = triangle.corners[i];
        const glm::dvec2& to = triangle.corners[triangle.nextCorner(i)];
        const double side = cross(to - from, point - from);
        if (area > 0.0 ? side < 0.0 : side > 0.0)
            return false;
    }
    return true;
}

class SpanBuilder {
public:
    void add(double depth) {
        mSpan = mFound ? DepthSpan{std::min(mSpan.min, depth), std::max(mSpan.max, depth)}
                       : DepthSpan{depth, depth};
        mFound = true;
    }
    [[nodiscard]] std::optional<DepthSpan> span() const {
        return mFound ? std::optional(mSpan) : std::nullopt;
    }

private:
    DepthSpan mSpan;
    bool mFound = false;
};

bool isBetween(const glm::dvec2& low, const glm::dvec2& point, const glm::dvec2& high) {
    return low.x <= point.x && point.x <= high.x && low.y <= point.y && point.y <= high.y;
}

/// Adds the depth where edge number `edge` crosses the side `coordinate[axis] == side` of the
/// rectangle, if it does so between the rectangle's other two sides.
void addSideCrossing(const ColumnTriangle& triangle, int edge, int axis, double side, double low,
                     double high, SpanBuilder& builder) {
    const int next = triangle.nextCorner(edge);
    const glm::dvec2& from = triangle.corners[edge];
    const glm::dvec2& to = triangle.corners[next];
    if ((from[axis] < side) == (to[axis] < side) || from[axis] == side || to[axis] == side)
        return;
    const double along = side - from[axis];
    const double length = to[axis] - from[axis];
    const int other = 1 - axis;
    const double crossing = from[other] + along * (to[other] - from[other]) / length;
    if (crossing < low || crossing > high)
        return;
    const double a = depthToAffine(triangle, triangle.depths[edge]);
    const double b = depthToAffine(triangle, triangle.depths[next]);
    builder.add(affineToDepth(triangle, a + along * (b - a) / length,
                              ordered(triangle.depths[edge], triangle.depths[next])));
}

double segmentDistance(const glm::dvec2& a, const glm::dvec2& b, const glm::dvec2& point) {
    const glm::dvec2 direction = b - a;
    const double squared = glm::dot(direction, direction);
    const double t =
        squared > 0.0 ? std::clamp(glm::dot(point - a, direction) / squared, 0.0, 1.0) : 0.0;
    return glm::length(point - (a + t * direction));
}

} // namespace

std::vector<ColumnTriangle>
columnTriangles(const TriangleMesh& mesh, const GridTransform& transform, const glm::dmat4& model) {
    const glm::dmat4 modelToColumn = transform.worldToColumn() * model;
    const bool perspective = transform.projection() == Projection::Perspective;
    std::vector<ColumnTriangle> result;
    result.reserve(mesh.triangles.size());
    for (std::uint32_t source = 0; source < mesh.triangles.size(); ++source) {
        Polygon polygon;
        for (int i = 0; i < 3; ++i)
            polygon.push_back(modelToColumn *
                              glm::dvec4(mesh.positions[mesh.triangles[source][i]], 1.0));
        if (perspective)
            polygon = cutAtDepth(polygon, transform.nearDepth() * kEyeCut);
        if (polygon.empty())
            continue;
        ColumnTriangle triangle;
        triangle.cornerCount = static_cast<int>(polygon.size());
        triangle.projection = transform.projection();
        triangle.source = source;
        for (std::size_t corner = 0; corner < polygon.size(); ++corner) {
            triangle.corners[corner] = glm::dvec2(polygon[corner]) / polygon[corner].w;
            triangle.depths[corner] = polygon[corner].z;
        }
        result.push_back(triangle);
    }
    return result;
}

glm::dvec2 ColumnTriangle::min() const {
    return std::accumulate(corners.begin() + 1, corners.begin() + cornerCount, corners[0],
                           [](const auto& a, const auto& b) { return glm::min(a, b); });
}

glm::dvec2 ColumnTriangle::max() const {
    return std::accumulate(corners.begin() + 1, corners.begin() + cornerCount, corners[0],
                           [](const auto& a, const auto& b) { return glm::max(a, b); });
}

double doubleArea(const ColumnTriangle& triangle) {
    double area = 0.0;
    for (int i = 2; i < triangle.cornerCount; ++i)
        area += fanArea(triangle, i);
    return area;
}

bool owns(const ColumnTriangle& triangle, const glm::dvec2& point) {
    // A ray from an inner point towards +x leaves the triangle once more than it enters it. Each
    // edge is judged from its lower to its upper end, so its other triangle judges by equal sums.
    bool inside = false;
    for (int i = 0; i < triangle.cornerCount; ++i) {
        const glm::dvec2& a = triangle.corners[i];
        const glm::dvec2& b = triangle.corners[triangle.nextCorner(i)];
        if ((a.y < point.y) == (b.y < point.y))
            continue;
        const glm::dvec2& low = a.y < b.y ? a : b;
        const glm::dvec2& high = a.y < b.y ? b : a;
        inside ^= cross(high - low, point - low) > 0.0;
    }
    return inside;
}

double outlineDistance(const ColumnTriangle& triangle, const glm::dvec2& point) {
    double distance = std::numeric_limits<double>::infinity();
    for (int i = 0; i < triangle.cornerCount; ++i)
        distance =
            std::min(distance, segmentDistance(triangle.corners[i],
                                               triangle.corners[triangle.nextCorner(i)], point));
    return distance;
}

double depthAt(const ColumnTriangle& triangle, const glm::dvec2& point) {
    const auto end = triangle.depths.begin() + triangle.cornerCount;
    const auto [min, max] = std::minmax_element(triangle.depths.begin(), end);
    // Of a cut triangle's two halves, the larger one gives the steadier plane.
    int third = 2;
    if (triangle.cornerCount == 4 &&
        std::abs(fanArea(triangle, 3)) > std::abs(fanArea(triangle, 2)))
        third = 3;
    const double area = fanArea(triangle, third);
    if (area == 0.0)
        return 0.5 * (*min + *max);
    const glm::dvec2 first = triangle.corners[third - 1] - triangle.corners[0];
    const glm::dvec2 second = triangle.corners[third] - triangle.corners[0];
    const glm::dvec2 offset = point - triangle.corners[0];
    const double base = depthToAffine(triangle, triangle.depths[0]);
    const double firstRise = depthToAffine(triangle, triangle.depths[third - 1]) - base;
    const double secondRise = depthToAffine(triangle, triangle.depths[third]) - base;
    const double rise =
        (cross(offset, second) * firstRise + cross(first, offset) * secondRise) / area;
    return affineToDepth(triangle, base + rise, {*min, *max});
}

std::optional<DepthSpan> depthSpan(const ColumnTriangle& triangle, const glm::dvec2& low,
                                   const glm::dvec2& high) {
    if (!(low.x <= high.x && low.y <= high.y))
        return std::nullopt;
    // The corners of the clipped polygon are of three kinds, each found from the original numbers.
    SpanBuilder builder;
    for (int i = 0; i < triangle.cornerCount; ++i)
        if (isBetween(low, triangle.corners[i], high))
            builder.add(triangle.depths[i]);
    for (int edge = 0; edge < triangle.cornerCount; ++edge)
        for (int axis = 0; axis < 2; ++axis)
            for (const double side : {low[axis], high[axis]})
                addSideCrossing(triangle, edge, axis, side, low[1 - axis], high[1 - axis], builder);
    for (const double x : {low.x, high.x})
        for (const double y : {low.y, high.y})
            if (closedContains(triangle, {x, y}))
                builder.add(depthAt(triangle, {x, y}));
    return builder.span();
}

} // namespace lamina::reference
