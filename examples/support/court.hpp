#pragma once

#include <lamina/core/triangle_mesh.hpp>

#include <glm/vec3.hpp>

#include <vector>

namespace example {

struct CourtThing {
    lamina::TriangleMesh mesh; ///< Closed.
    glm::vec3 albedo{1.0f};
    bool casts = true;
};

/// A paved court, 18 x 14 units about the origin, with 72 vases and balls and a wall on its -x
/// side: under a sun behind the wall (kCourtSun), what stands in the wall's shadow casts nothing
/// new.
[[nodiscard]] std::vector<CourtThing> makeCourt();

/// Direction towards the sun; any length.
inline constexpr glm::dvec3 kCourtSun{-1.0, 0.62, 0.18};

} // namespace example
