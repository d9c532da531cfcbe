#pragma once

#include <lamina/core/triangle_mesh.hpp>

#include <glm/vec3.hpp>

namespace example {

/// A knotted tube about `center`; `size`: from there to the middle of its windings. Closed.
[[nodiscard]] lamina::TriangleMesh makeKnot(const glm::vec3& center, float size, float tubeRadius);

/// A ball of about that radius with waves all over it. Closed, does not cut itself.
[[nodiscard]] lamina::TriangleMesh makeWavyBall(const glm::vec3& center, float radius);

} // namespace example
