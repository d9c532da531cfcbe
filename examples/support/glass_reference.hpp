#pragma once

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <memory>
#include <optional>
#include <span>
#include <vector>

namespace example {

/// Where a ray meets a glass surface.
struct GlassHit {
    double distance = 0.0;
    glm::dvec3 normal{0.0}; ///< Unit length, out of the glass.
    double index = 1.0;     ///< Of the glass.
};

/// A closed body of glass with an exact surface.
class GlassBody {
public:
    virtual ~GlassBody() = default;
    /// The nearest point of the surface farther than `least`. direction: unit length.
    [[nodiscard]] virtual std::optional<GlassHit>
    hit(const glm::dvec3& origin, const glm::dvec3& direction, double least) const = 0;
};

/// A ball; `isHole`: the glass is outside, a ball of air in another body.
[[nodiscard]] std::unique_ptr<GlassBody> makeGlassBall(const glm::dvec3& center, double radius,
                                                       double index, bool isHole = false);
[[nodiscard]] std::unique_ptr<GlassBody> makeGlassBox(const glm::dvec3& min, const glm::dvec3& max,
                                                      double index);
/// What `profile`, (radius, height) with the glass to its left, sweeps around the y axis; normals
/// are interpolated between those of the points.
[[nodiscard]] std::unique_ptr<GlassBody> makeRevolvedGlass(std::span<const glm::vec2> profile,
                                                           double index);
/// The normals of the profile's points, (radial, up), as makeRevolvedGlass() has them.
[[nodiscard]] std::vector<glm::dvec2> profileNormals(std::span<const glm::vec2> profile);

/// The nearest surface of all bodies.
[[nodiscard]] std::optional<GlassHit> hitGlass(std::span<const std::unique_ptr<GlassBody>> bodies,
                                               const glm::dvec3& origin,
                                               const glm::dvec3& direction, double least = 0.0);

/// A ray on its way through glass, traced exactly: refracted at every surface, or totally
/// reflected.
struct GlassPath {
    glm::dvec3 exit{0.0};
    glm::dvec3 direction{0.0}; ///< Unit length.
    double inside = 0.0;       ///< Length in glass.
    int events = 0;            ///< Surfaces met after the first one.
    int reflections = 0;       ///< Of them, total internal reflections.
};

/// Follows a ray that enters glass at `surface`.
[[nodiscard]] GlassPath traceGlass(std::span<const std::unique_ptr<GlassBody>> bodies,
                                   const glm::dvec3& surface, const GlassHit& first,
                                   const glm::dvec3& direction, int maxEvents);

} // namespace example
