#pragma once

#include <reference/fog.hpp>

#include <functional>
#include <span>
#include <vector>

namespace lamina::reference {

/// Airlight of an image against ray casting.
struct FogErrors {
    double airlight = 0.0;   ///< Root mean square error over root mean square.
    double strength = 0.0;   ///< Of the shadow, relative: mean where it takes more than 2 %.
    double bias = 0.0;       ///< Mean of the same with its sign: above 0, too dark.
    std::size_t shadows = 0; ///< Pixels where it does.
};

/// All of the same pixels; unshadowed: without shadows.
[[nodiscard]] FogErrors fogErrors(std::span<const double> found, std::span<const double> expected,
                                  std::span<const double> unshadowed);

/// Root of the mean square of differences over that of the expected values.
[[nodiscard]] double relativeRmse(std::span<const double> found, std::span<const double> expected);

/// Does an eye ray pass a virtual light closer than its part of the source is large? There points
/// are no likeness of the source, and gathers bound them.
[[nodiscard]] bool passesLight(const glm::dvec3& eye, const glm::dvec3& point,
                               std::span<const VirtualLight> lights);

/// A number for each index below count, on all processors.
[[nodiscard]] std::vector<double> forEach(std::size_t count,
                                          const std::function<double(std::size_t)>& value);

} // namespace lamina::reference
