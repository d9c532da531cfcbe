#pragma once

#include <glm/vec3.hpp>

#include <cstdint>
#include <vector>

namespace example {

/// Light from a direction of any length, linear colours: a clear sky with a sun above a chequered
/// plain.
[[nodiscard]] glm::vec3 sky(const glm::dvec3& direction);

/// sky() in the equirectangular projection that lamina::Environment loads, `height` rows of twice
/// as many texels; each is the mean of some points.
[[nodiscard]] std::vector<glm::vec3> makeSkyTexels(std::uint32_t height);

} // namespace example
