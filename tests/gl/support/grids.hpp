#pragma once

#include <lamina/grid/grid_transform.hpp>

#include <vector>

namespace lamina::test {

/// The shapes of makeShapes() seen aslant.
[[nodiscard]] GridTransform
cameraGrid(Projection projection, const glm::uvec3& size,
           const SliceDistribution& distribution = SliceDistribution::linear());

/// The same with both projections and every kind of distribution.
[[nodiscard]] std::vector<GridTransform> makeCameraGrids(const glm::uvec3& size);

/// The view from among the shapes: triangles cross the near plane and the eye's plane.
[[nodiscard]] GridTransform eyeGrid(const glm::uvec3& size);

} // namespace lamina::test
