#include "mesh_io/polygon_triangulator.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace lamina::detail {
namespace {

/// Twice the signed area of a triangle.
double area(const glm::dvec2& a, const glm::dvec2& b, const glm::dvec2& c) {
    return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

void appendFan(std::span<const std::uint32_t> corners, std::vector<glm::uvec3>& out) {
    for (std::size_t i = 2; i < corners.size(); ++i)
        out.emplace_back(corners[0], corners[i - 1], corners[i]);
}

} // namespace

void PolygonTriangulator::append(std::span<const glm::vec3> positions,
                                 std::span<const std::uint32_t> polygon,
                                 std::vector<glm::uvec3>& out) {
    if (polygon.size() == 3) [[likely]] {
        out.emplace_back(0, 1, 2);
        return;
    }
    // One polygon may be the whole file: no room for growing to twice its size.
    const std::size_t needed = out.size() + polygon.size() - 2;
    if (needed > out.capacity())
        out.reserve(std::max(needed, out.capacity() * 2));
    mCorners.resize(polygon.size());
    std::iota(mCorners.begin(), mCorners.end(), 0u);
    if (!project(positions, polygon) || isConvex())
        appendFan(mCorners, out);
    else
        clipEars(out);
}

bool PolygonTriangulator::project(std::span<const glm::vec3> positions,
                                  std::span<const std::uint32_t> polygon) {
    for (const std::uint32_t index : polygon)
        if (index >= positions.size())
            return false;

    // Newell's normal, relative to the first corner.
    const glm::dvec3 origin(positions[polygon[0]]);
    glm::dvec3 normal(0.0);
    glm::dvec3 previous = glm::dvec3(positions[polygon.back()]) - origin;
    for (const std::uint32_t index : polygon) {
        const glm::dvec3 p = glm::dvec3(positions[index]) - origin;
        normal.x += previous.y * p.z - previous.z * p.y;
        normal.y += previous.z * p.x - previous.x * p.z;
        normal.z += previous.x * p.y - previous.y * p.x;
        previous = p;
    }
    const glm::dvec3 size(std::abs(normal.x), std::abs(normal.y), std::abs(normal.z));
    const int drop = size.x > size.y && size.x > size.z ? 0 : (size.y > size.z ? 1 : 2);
    if (!(size[drop] > 0.0))
        return false;
    const int u = (drop + 1) % 3;
    const int v = (drop + 2) % 3;
    const double side = normal[drop] > 0.0 ? 1.0 : -1.0;
    mPoints.clear();
    mPoints.reserve(polygon.size());
    for (const std::uint32_t index : polygon) {
        const glm::dvec3 p = glm::dvec3(positions[index]) - origin;
        mPoints.emplace_back(p[u], side * p[v]);
    }
    return true;
}

bool PolygonTriangulator::isConvex() const {
    const std::size_t count = mPoints.size();
    for (std::size_t i = 0; i < count; ++i)
        if (!(area(mPoints[i], mPoints[(i + 1) % count], mPoints[(i + 2) % count]) >= 0.0))
            return false;
    return true;
}

void PolygonTriangulator::clipEars(std::vector<glm::uvec3>& out) {
    std::size_t place = 0;
    std::size_t failures = 0;
    while (mCorners.size() > 3 && failures < mCorners.size() && mTestsLeft > 0) {
        const std::size_t count = mCorners.size();
        place %= count;
        if (!isEar(place)) {
            ++place;
            ++failures;
            continue;
        }
        out.emplace_back(mCorners[(place + count - 1) % count], mCorners[place],
                         mCorners[(place + 1) % count]);
        mCorners.erase(mCorners.begin() + static_cast<std::ptrdiff_t>(place));
        failures = 0;
    }
    // No ear left (the polygon crosses itself or is flat), one triangle, or out of budget.
    appendFan(mCorners, out);
}

bool PolygonTriangulator::isEar(std::size_t place) {
    const std::size_t count = mCorners.size();
    const glm::dvec2 a = mPoints[mCorners[(place + count - 1) % count]];
    const glm::dvec2 b = mPoints[mCorners[place]];
    const glm::dvec2 c = mPoints[mCorners[(place + 1) % count]];
    mTestsLeft -= std::min<std::uint64_t>(mTestsLeft, count);
    if (!(area(a, b, c) > 0.0))
        return false;
    return std::none_of(mCorners.begin(), mCorners.end(), [&](std::uint32_t corner) {
        const glm::dvec2 p = mPoints[corner];
        return p != a && p != b && p != c && area(a, b, p) >= 0.0 && area(b, c, p) >= 0.0 &&
               area(c, a, p) >= 0.0;
    });
}

} // namespace lamina::detail
