#include "area_light/luminance_table.hpp"
#include "core/finite.hpp"

#include <lamina/area_light/virtual_lights.hpp>

#include <glm/geometric.hpp>

#include <array>
#include <cmath>
#include <numbers>
#include <string>

namespace lamina {
namespace {

using detail::isFinite;

constexpr double kPi = std::numbers::pi;

Error invalid(const std::string& text) {
    return {ErrorCode::InvalidArgument, "virtual lights: " + text};
}

/// The radical inverse of `index`: Halton's sequence in one base.
double halton(std::uint32_t index, std::uint32_t base) {
    double value = 0.0;
    double digit = 1.0;
    for (; index != 0; index /= base) {
        digit /= base;
        value += digit * (index % base);
    }
    return value;
}

/// The strength of a source.
glm::vec3 strengthOf(const LightSource& source) {
    return std::visit(
        [](const auto& light) {
            if constexpr (requires { light.intensity; })
                return light.intensity;
            else if constexpr (requires { light.irradiance; })
                return light.irradiance;
            else if constexpr (requires { light.radiance; })
                return light.radiance;
            else
                return light.emission.radiance;
        },
        source);
}

/// Two unit vectors that complete `axis` to a right-handed frame.
std::array<glm::dvec3, 2> orthogonal(const glm::dvec3& axis) {
    const glm::dvec3 other = std::abs(axis.x) < 0.5 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0);
    const glm::dvec3 first = glm::normalize(glm::cross(other, axis));
    return {first, glm::cross(axis, first)};
}

class Sampler {
public:
    Sampler(std::uint32_t count, std::uint32_t offset)
        : mCount(count)
        , mOffset(offset) {}

    [[nodiscard]] Result<std::vector<VirtualLight>> operator()(const PointLight& source) const {
        VirtualLight light;
        light.light.position = source.position;
        light.intensity = source.intensity;
        return std::vector{light};
    }
    [[nodiscard]] Result<std::vector<VirtualLight>> operator()(const SpotLight& source) const {
        VirtualLight light;
        light.light = {LightKind::Spot, source.position, source.direction, source.coneAngle};
        light.intensity = source.intensity;
        return std::vector{light};
    }
    [[nodiscard]] Result<std::vector<VirtualLight>>
    operator()(const DirectionalLight& source) const {
        VirtualLight light;
        light.light.kind = LightKind::Directional;
        light.light.direction = source.direction;
        light.intensity = source.irradiance;
        return std::vector{light};
    }
    [[nodiscard]] Result<std::vector<VirtualLight>> operator()(const RectangleLight& source) const;
    [[nodiscard]] Result<std::vector<VirtualLight>> operator()(const DiskLight& source) const;
    [[nodiscard]] Result<std::vector<VirtualLight>> operator()(const SphereLight& source) const;
    [[nodiscard]] Result<std::vector<VirtualLight>>
    operator()(const EnvironmentLight& source) const;

private:
    [[nodiscard]] glm::dvec2 point(std::uint32_t index) const {
        // The sequence begins at 1: its point 0 is a corner.
        return {halton(mOffset + index + 1, 2), halton(mOffset + index + 1, 3)};
    }
    /// A part of a Lambertian surface of this area.
    [[nodiscard]] VirtualLight emitter(const glm::dvec3& position, const glm::dvec3& normal,
                                       const glm::vec3& radiance, double area) const {
        VirtualLight light;
        light.light.position = position;
        light.normal = normal;
        light.intensity = radiance * static_cast<float>(area);
        light.radius = std::sqrt(area / kPi);
        return light;
    }

    std::uint32_t mCount;
    std::uint32_t mOffset;
};

Result<std::vector<VirtualLight>> Sampler::operator()(const RectangleLight& source) const {
    const glm::dvec3 across = glm::cross(source.edgeU, source.edgeV);
    const double area = glm::length(across);
    if (!isFinite(source.corner) || !(area > 0.0) || !std::isfinite(area))
        return invalid("expected a finite rectangle of some area, found one of area " +
                       std::to_string(area));
    const Emission& emission = source.emission;
    auto table = LuminanceTable::create(emission.luminances, emission.luminanceSize,
                                        [](double) { return 1.0; });
    if (!table)
        return table.error();
    std::vector<VirtualLight> lights;
    for (std::uint32_t i = 0; i < mCount; ++i) {
        const LuminanceTable::Sample sample = table->sample(point(i));
        const glm::dvec3 position =
            source.corner + sample.place.x * source.edgeU + sample.place.y * source.edgeV;
        lights.push_back(
            emitter(position, across / area, emission.radiance, area / (mCount * sample.density)));
        if (emission.texture == 0)
            lights.back().intensity *= sample.luminance;
        lights.back().textureCoordinates = glm::vec2(sample.place);
        lights.back().textureShare = static_cast<float>(1.0 / (mCount * sample.density));
    }
    return lights;
}

Result<std::vector<VirtualLight>> Sampler::operator()(const DiskLight& source) const {
    const double length = glm::length(source.normal);
    if (!isFinite(source.center) || !std::isfinite(length) || !(length > 0.0) ||
        !(source.radius > 0.0) || !std::isfinite(source.radius))
        return invalid("expected a finite disk with a normal and a radius above 0, found radius " +
                       std::to_string(source.radius));
    const glm::dvec3 normal = source.normal / length;
    const auto [u, v] = orthogonal(normal);
    std::vector<VirtualLight> lights;
    for (std::uint32_t i = 0; i < mCount; ++i) {
        const glm::dvec2 place = point(i);
        const double radius = source.radius * std::sqrt(place.x);
        const double angle = 2.0 * kPi * place.y;
        lights.push_back(
            emitter(source.center + radius * (std::cos(angle) * u + std::sin(angle) * v), normal,
                    source.radiance, kPi * source.radius * source.radius / mCount));
    }
    return lights;
}

Result<std::vector<VirtualLight>> Sampler::operator()(const SphereLight& source) const {
    if (!isFinite(source.center) || !(source.radius > 0.0) || !std::isfinite(source.radius))
        return invalid("expected a finite sphere with a radius above 0, found radius " +
                       std::to_string(source.radius));
    std::vector<VirtualLight> lights;
    for (std::uint32_t i = 0; i < mCount; ++i) {
        const glm::dvec2 place = point(i);
        const double height = 1.0 - 2.0 * place.x;
        const double ring = std::sqrt(std::max(0.0, 1.0 - height * height));
        const double angle = 2.0 * kPi * place.y;
        const glm::dvec3 normal(ring * std::cos(angle), height, ring * std::sin(angle));
        lights.push_back(emitter(source.center + source.radius * normal, normal, source.radiance,
                                 4.0 * kPi * source.radius * source.radius / mCount));
    }
    return lights;
}

Result<std::vector<VirtualLight>> Sampler::operator()(const EnvironmentLight& source) const {
    const Emission& emission = source.emission;
    if (emission.luminances.empty())
        return invalid("expected luminances of the environment, found none");
    auto table = LuminanceTable::create(emission.luminances, emission.luminanceSize,
                                        [](double v) { return std::sin(kPi * v); });
    if (!table)
        return table.error();
    std::vector<VirtualLight> lights;
    for (std::uint32_t i = 0; i < mCount; ++i) {
        const LuminanceTable::Sample sample = table->sample(point(i));
        const double azimuth = 2.0 * kPi * sample.place.x;
        const double polar = kPi * sample.place.y;
        const double ring = std::sin(polar);
        VirtualLight light;
        light.light.kind = LightKind::Directional;
        light.light.direction = {-ring * std::cos(azimuth), std::cos(polar),
                                 -ring * std::sin(azimuth)};
        // Solid angle of a unit of the picture, over the density of lights in it.
        const double solidAngle = 2.0 * kPi * kPi * ring / (mCount * sample.density);
        light.intensity = emission.radiance * static_cast<float>(solidAngle);
        if (emission.texture == 0)
            light.intensity *= sample.luminance;
        light.textureCoordinates = glm::vec2(sample.place);
        light.textureShare = static_cast<float>(1.0 / (mCount * sample.density));
        lights.push_back(light);
    }
    return lights;
}

} // namespace

Result<std::vector<VirtualLight>> sampleVirtualLights(const LightSource& source,
                                                      std::uint32_t count, std::uint32_t offset) {
    if (count == 0)
        return invalid("expected at least one, found a count of 0");
    const glm::vec3 strength = strengthOf(source);
    for (int channel = 0; channel < 3; ++channel)
        if (!(strength[channel] >= 0.0f) || !std::isfinite(strength[channel]))
            return invalid("expected a finite radiance or intensity of at least 0, found " +
                           std::to_string(strength[channel]));
    return std::visit(Sampler(count, offset), source);
}

} // namespace lamina
