#pragma once

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <cstdint>
#include <span>
#include <vector>

namespace lamina::detail {

/// Turns places in a polygon into the indices that stand there.
inline void lookUp(std::span<glm::uvec3> triangles, std::span<const std::uint32_t> polygon) {
    for (glm::uvec3& t : triangles)
        t = {polygon[t.x], polygon[t.y], polygon[t.z]};
}

/// Cuts polygons into triangles of their own corners: a fan from the first corner where the polygon
/// is convex, ear clipping where it is not.
class PolygonTriangulator {
public:
    /// Appends size - 2 triangles to `out`: places in `polygon`, from 0 to size - 1.
    /// polygon: at least three indices; where one is past the end of `positions` (the file defines
    /// the vertex later) the polygon is taken to be convex.
    void append(std::span<const glm::vec3> positions, std::span<const std::uint32_t> polygon,
                std::vector<glm::uvec3>& out);

private:
    bool project(std::span<const glm::vec3> positions, std::span<const std::uint32_t> polygon);
    [[nodiscard]] bool isConvex() const;
    void clipEars(std::vector<glm::uvec3>& out);
    [[nodiscard]] bool isEar(std::size_t place);

    /// Point tests left for a whole file: ear clipping is quadratic in a polygon's corners, and a
    /// hostile file must not buy minutes. Past it polygons become fans.
    std::uint64_t mTestsLeft = 200'000'000;
    std::vector<glm::dvec2> mPoints;     ///< The corners in the polygon's plane, counter-clockwise.
    std::vector<std::uint32_t> mCorners; ///< Places of the corners that are not clipped yet.
};

} // namespace lamina::detail
