#pragma once

#include <lamina/grid/grid_transform.hpp>

#include <vector>

namespace lamina::test {

/// 48 x 40 columns of [-1,1]^3.
[[nodiscard]] GridTransform testGrid(std::uint32_t slices = 64);

/// A box about the shapes of makeShapes() whose faces lie on no power-of-two fraction.
[[nodiscard]] GridTransform shapesGrid(const glm::uvec3& size, Axis axis = Axis::Z);

/// The shapes of makeShapes() seen aslant.
[[nodiscard]] GridTransform
cameraGrid(Projection projection, const glm::uvec3& size,
           const SliceDistribution& distribution = SliceDistribution::linear());

/// The same with both projections and every kind of distribution.
[[nodiscard]] std::vector<GridTransform> makeCameraGrids(const glm::uvec3& size);

/// The view from among the shapes: triangles cross the near plane and the eye's plane.
[[nodiscard]] GridTransform eyeGrid(const glm::uvec3& size);

} // namespace lamina::test
