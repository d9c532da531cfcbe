#pragma once

#include <reference/epipolar_rays.hpp>

#include <lamina/area_light/virtual_lights.hpp>

#include <cstdint>
#include <functional>
#include <span>

/// Single scattering in homogeneous media by ray marching and shadow rays, in double precision.
namespace lamina::reference {

/// One eye ray under one virtual light, per unit of scattering and intensity.
struct FogRay {
    double airlight = 0.0;   ///< The true integral.
    double unshadowed = 0.0; ///< The integral without shadows.
    /// Mean over equal steps of the angle at the light ([WD13]'s factor); directional: of length.
    double meanVisibility = 0.0;

    [[nodiscard]] double factored() const { return meanVisibility * unshadowed; }
};

/// The lit share of a point; empty: nothing casts shadows.
using Visibility = std::function<double(const glm::dvec3& point)>;

/// Marches from `eye` to `point` by `steps` midpoints, in equal angles around the light's closest
/// approach (directional: by equal shares of the extinction).
[[nodiscard]] FogRay marchFog(const Visibility& visibility, const VirtualLight& light,
                              const Medium& medium, const glm::dvec3& eye, const glm::dvec3& point,
                              std::uint32_t steps);

/// The same with the visibility of ray casting. rays: null: nothing casts shadows.
[[nodiscard]] FogRay marchFog(const ShadowRays* rays, const VirtualLight& light,
                              const Medium& medium, const glm::dvec3& eye, const glm::dvec3& point,
                              std::uint32_t steps);

/// Sums of rays over all lights of one colour (their intensities' red).
[[nodiscard]] FogRay marchFog(const ShadowRays* rays, std::span<const VirtualLight> lights,
                              const Medium& medium, const glm::dvec3& eye, const glm::dvec3& point,
                              std::uint32_t steps);

/// Irradiance of a light at a point of a surface, attenuated and shadowed; the ray begins `lift`
/// along the normal. Cosine included.
[[nodiscard]] double castIrradiance(const ShadowRays& rays, const VirtualLight& light,
                                    const Medium& medium, const glm::dvec3& point,
                                    const glm::dvec3& normal, double lift);

/// The same without shadows.
[[nodiscard]] double irradiance(const VirtualLight& light, const Medium& medium,
                                const glm::dvec3& point, const glm::dvec3& normal);

} // namespace lamina::reference
