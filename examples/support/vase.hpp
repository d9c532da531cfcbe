#pragma once

#include "glass_reference.hpp"

#include <lamina/core/triangle_mesh.hpp>

#include <span>
#include <vector>

namespace example {

/// Profile of a glass vase about the y axis, one unit tall from -1 to 1, with walls and a thick
/// foot: outside up, over the rim, inside down.
[[nodiscard]] std::vector<glm::vec2> vaseProfile();

/// What the profile sweeps, with the normals of makeRevolvedGlass().
[[nodiscard]] lamina::TriangleMesh makeRevolvedMesh(std::span<const glm::vec2> profile,
                                                    unsigned segments);

/// Refraction through two surfaces as a depth and a normal map of the farthest surfaces tell it
/// (Wyman 2005), for comparison. eye: where these maps are seen from; first: at `point`.
[[nodiscard]] GlassPath traceByImages(std::span<const std::unique_ptr<GlassBody>> bodies,
                                      const glm::dvec3& eye, const glm::dvec3& point,
                                      const GlassHit& first, const glm::dvec3& direction);

} // namespace example
