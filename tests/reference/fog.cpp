#include <reference/fog.hpp>

#include <glm/geometric.hpp>

#include <cmath>
#include <numbers>

namespace lamina::reference {
namespace {

double henyeyGreenstein(double g, double cosine) {
    return (1.0 - g * g) / (4.0 * std::numbers::pi * std::pow(1.0 + g * g - 2.0 * g * cosine, 1.5));
}

/// Scattered towards the eye at a point, per unit of length, unshadowed.
double scattered(const VirtualLight& light, const Medium& medium, const glm::dvec3& eye,
                 const glm::dvec3& point) {
    const glm::dvec3 toEye = glm::normalize(eye - point);
    const double toEyeLength = glm::distance(eye, point);
    if (light.light.kind == LightKind::Directional) {
        const double cosine = glm::dot(glm::normalize(light.light.direction), toEye);
        return henyeyGreenstein(medium.anisotropy, cosine) *
               std::exp(-medium.extinction * toEyeLength);
    }
    const glm::dvec3 offset = point - light.light.position;
    const double distance = glm::length(offset);
    const glm::dvec3 travel = offset / distance;
    const double emitted =
        light.isLambertian() ? std::max(0.0, glm::dot(light.normal, travel)) : 1.0;
    return emitted * henyeyGreenstein(medium.anisotropy, glm::dot(travel, toEye)) *
           std::exp(-medium.extinction * (distance + toEyeLength)) / (distance * distance);
}

} // namespace

FogRay marchFog(const Visibility& visibility, const VirtualLight& light, const Medium& medium,
                const glm::dvec3& eye, const glm::dvec3& point, std::uint32_t steps) {
    const double length = glm::distance(eye, point);
    const glm::dvec3 along = (point - eye) / length;
    const bool isDirectional = light.light.kind == LightKind::Directional;
    const double closest = isDirectional ? 0.0 : glm::dot(light.light.position - eye, along);
    const double apart =
        isDirectional ? 1.0
                      : std::max(glm::distance(light.light.position, eye + closest * along), 1e-12);
    const double first = std::atan(-closest / apart);
    const double last = std::atan((length - closest) / apart);
    const double whole = 1.0 - std::exp(-medium.extinction * length);
    FogRay ray;
    double visible = 0.0;
    for (std::uint32_t i = 0; i < steps; ++i) {
        const double share = (i + 0.5) / steps;
        double t = 0.0;
        double width = 0.0; // Of the step along the ray.
        if (!isDirectional) {
            const double angle = first + (last - first) * share;
            t = closest + apart * std::tan(angle);
            width = apart / (std::cos(angle) * std::cos(angle)) * (last - first) / steps;
        } else if (whole > 1e-9) {
            t = -std::log(1.0 - share * whole) / medium.extinction;
            width = whole / (steps * medium.extinction) * std::exp(medium.extinction * t);
        } else {
            t = share * length;
            width = length / steps;
        }
        const glm::dvec3 at = eye + t * along;
        const double density = width * scattered(light, medium, eye, at);
        ray.unshadowed += density;
        const double lit = visibility ? visibility(at) : 1.0;
        ray.airlight += lit * density;
        visible += lit * (isDirectional ? width / length : 1.0 / steps);
    }
    ray.meanVisibility = visible;
    return ray;
}

FogRay marchFog(const ShadowRays* rays, const VirtualLight& light, const Medium& medium,
                const glm::dvec3& eye, const glm::dvec3& point, std::uint32_t steps) {
    Visibility visibility;
    if (rays)
        visibility = [&](const glm::dvec3& at) { return rays->lit(light.light, at) ? 1.0 : 0.0; };
    return marchFog(visibility, light, medium, eye, point, steps);
}

FogRay marchFog(const ShadowRays* rays, std::span<const VirtualLight> lights, const Medium& medium,
                const glm::dvec3& eye, const glm::dvec3& point, std::uint32_t steps) {
    FogRay sum;
    double factored = 0.0;
    for (const VirtualLight& light : lights) {
        const FogRay ray = marchFog(rays, light, medium, eye, point, steps);
        const double strength = static_cast<double>(light.intensity.x);
        sum.airlight += strength * ray.airlight;
        sum.unshadowed += strength * ray.unshadowed;
        factored += strength * ray.factored();
    }
    sum.meanVisibility = sum.unshadowed > 0.0 ? factored / sum.unshadowed : 0.0;
    return sum;
}

double castIrradiance(const ShadowRays& rays, const VirtualLight& light, const Medium& medium,
                      const glm::dvec3& point, const glm::dvec3& normal, double lift) {
    const glm::dvec3 start = point + lift * normal;
    return rays.lit(light.light, start) ? irradiance(light, medium, start, normal) : 0.0;
}

double irradiance(const VirtualLight& light, const Medium& medium, const glm::dvec3& point,
                  const glm::dvec3& normal) {
    const bool isDirectional = light.light.kind == LightKind::Directional;
    const glm::dvec3 offset = isDirectional ? -light.light.direction : light.light.position - point;
    const double cosine = glm::dot(normal, glm::normalize(offset));
    if (cosine <= 0.0)
        return 0.0;
    const double strength = static_cast<double>(light.intensity.x);
    if (isDirectional)
        return strength * cosine;
    const double distance = glm::length(offset);
    const double emitted =
        light.isLambertian() ? std::max(0.0, -glm::dot(light.normal, offset / distance)) : 1.0;
    return strength * cosine * emitted * std::exp(-medium.extinction * distance) /
           (distance * distance);
}

} // namespace lamina::reference
