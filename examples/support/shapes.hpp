#pragma once

#include <lamina/core/triangle_mesh.hpp>

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

namespace example {

/// Moves a point of a shape to where it belongs.
using Placement = std::function<glm::vec3(const glm::vec3&)>;

/// Adds the closed surface that `profile` sweeps around the y axis, placed by `place`.
/// profile: (radius, height) from the bottom up; the first and the last radius are 0, the others
/// positive. segments: at least 3 around.
void addRevolved(lamina::TriangleMesh& mesh, std::span<const glm::vec2> profile, unsigned segments,
                 const Placement& place);

/// Adds what the closed `loop` of (radius, height) sweeps around the y axis from angle `from` to
/// `to` (radians), placed by `place`. Of less than a full turn, both ends are closed by fans about
/// the loop's middle: the loop must then be convex.
void addRevolvedLoop(lamina::TriangleMesh& mesh, std::span<const glm::vec2> loop, unsigned segments,
                     float from, float to, const Placement& place);

/// Adds a round tube along `path`, `radii` wide at its points; its ends are closed by cones of no
/// height.
void addTube(lamina::TriangleMesh& mesh, std::span<const glm::vec3> path,
             std::span<const float> radii, unsigned sides);

/// Adds a round tube along `path`, whose last point leads back to the first.
void addClosedTube(lamina::TriangleMesh& mesh, std::span<const glm::vec3> path, float radius,
                   unsigned sides);

/// Adds a triangle of its own three vertices.
void addTriangle(lamina::TriangleMesh& mesh, const glm::vec3& a, const glm::vec3& b,
                 const glm::vec3& c);

/// The profile of a ball about the origin for addRevolved().
[[nodiscard]] std::vector<glm::vec2> ballProfile(float radius, unsigned rings);

/// Smooth noise in [-1,1] whose features are about one unit wide; the same on every machine.
[[nodiscard]] float noise(const glm::vec3& point);

/// Random numbers that are the same on every machine, which the standard's distributions are not.
class Random {
public:
    explicit Random(std::uint32_t seed)
        : mState(seed * 2654435769u + 1u) {}
    /// In [low, high).
    [[nodiscard]] float operator()(float low, float high);

private:
    std::uint32_t mState;
};

} // namespace example
