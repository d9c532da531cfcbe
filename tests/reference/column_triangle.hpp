#pragma once

#include <lamina/core/triangle_mesh.hpp>
#include <lamina/grid/grid_transform.hpp>

#include <glm/mat4x4.hpp>
#include <glm/vec2.hpp>

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

namespace lamina::reference {

/// Perspective triangles are cut off at this fraction of the grid's near depth, so that what is
/// left can be divided by its depth. Nothing nearer than near is ever voxelized.
inline constexpr double kEyeCut = 1.0 / 64.0;

/// A triangle seen by the grid's camera: three corners, or four if kEyeCut cut one off.
struct ColumnTriangle {
    int cornerCount = 3;
    std::array<glm::dvec2, 4> corners{};              ///< Columns (pixels), continuous.
    std::array<double, 4> depths{};                   ///< World units; > 0 if perspective.
    Projection projection = Projection::Orthographic; ///< Which of depth and 1/depth is affine.
    std::uint32_t source = 0;                         ///< Index of the mesh triangle.

    [[nodiscard]] int nextCorner(int corner) const { return (corner + 1) % cornerCount; }
    [[nodiscard]] glm::dvec2 min() const; ///< Low corner of the bounding rectangle, columns.
    [[nodiscard]] glm::dvec2 max() const; ///< High corner of the bounding rectangle, columns.
};

/// A range of depths, world units.
struct DepthSpan {
    double min = 0.0, max = 0.0;
};

/// The triangles of a valid mesh in column space, without those that kEyeCut cuts away wholly.
[[nodiscard]] std::vector<ColumnTriangle>
columnTriangles(const TriangleMesh& mesh, const GridTransform& transform, const glm::dmat4& model);

/// Twice the signed area of the projection, in square columns; positive if x turns towards y.
[[nodiscard]] double doubleArea(const ColumnTriangle& triangle);

/// Does the projected triangle own the point? Points inside, and points on a left edge or on a
/// horizontal top edge (OpenGL's top-left rule, y up). Of two triangles on opposite sides of a
/// shared edge exactly one owns a point on it, whatever their winding and however the sums round.
/// Zero-area triangles own nothing unless rounding blurs their edges.
[[nodiscard]] bool owns(const ColumnTriangle& triangle, const glm::dvec2& point);

/// Distance from the point to the outline of the projected triangle, in columns.
[[nodiscard]] double outlineDistance(const ColumnTriangle& triangle, const glm::dvec2& point);

/// Depth of the triangle's plane at a point of its projection, never outside the triangle's own
/// depths. Exact where all products of the coordinates are. Edge-on triangles: middle depth.
[[nodiscard]] double depthAt(const ColumnTriangle& triangle, const glm::dvec2& point);

/// Depths of the part of the triangle inside the closed rectangle [low, high] of the column plane;
/// nothing if it has no part there. Edge-on triangles count.
[[nodiscard]] std::optional<DepthSpan> depthSpan(const ColumnTriangle& triangle,
                                                 const glm::dvec2& low, const glm::dvec2& high);

} // namespace lamina::reference
