#pragma once

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <cstdint>
#include <numbers>
#include <span>
#include <variant>

namespace lamina {

/// Shines alike in all directions.
struct PointLight {
    glm::dvec3 position{0.0};  ///< World space.
    glm::vec3 intensity{1.0f}; ///< Radiant intensity, RGB.
};

/// A point light within a cone.
struct SpotLight {
    glm::dvec3 position{0.0};
    glm::dvec3 direction{0.0, 0.0, -1.0};      ///< Where the light goes; any length.
    double coneAngle = std::numbers::pi / 4.0; ///< From the axis to the rim, radians in (0, pi).
    glm::vec3 intensity{1.0f};
};

/// The sun: as strong everywhere.
struct DirectionalLight {
    glm::dvec3 direction{0.0, -1.0, 0.0}; ///< Where the light goes; any length.
    glm::vec3 irradiance{1.0f};           ///< On a surface at right angles to it, RGB.
};

/// What an emitting surface shows: a constant, or a texture of the host.
struct Emission {
    glm::vec3 radiance{1.0f}; ///< RGB; times the texture.
    /// GL name of a 2D texture (a video frame, say) of a float or normalized colour format (RGBA8,
    /// SRGB8, RGBA16F and the like), linear radiance in RGB; 0: none. Read on the GPU in each
    /// prepare(), filtered over the part that a virtual light stands for: give it mipmaps.
    std::uint32_t texture = 0;
    /// Luminances in rows from v = 0, to place virtual lights where the light is bright; empty:
    /// evenly. A coarse likeness of the texture is enough: each virtual light's strength makes up
    /// for its density. Without a texture they are what the surface shows, times `radiance`.
    std::span<const float> luminances{};
    glm::uvec2 luminanceSize{0}; ///< Columns and rows.
};

/// A Lambertian rectangle, a large television; shines to the side where corner, corner + u, corner
/// + v turn counterclockwise.
struct RectangleLight {
    glm::dvec3 corner{0.0};          ///< Texture coordinates (0,0).
    glm::dvec3 edgeU{1.0, 0.0, 0.0}; ///< To texture coordinates (1,0).
    glm::dvec3 edgeV{0.0, 1.0, 0.0}; ///< To texture coordinates (0,1).
    Emission emission;
};

/// A Lambertian disk; shines along its normal.
struct DiskLight {
    glm::dvec3 center{0.0};
    glm::dvec3 normal{0.0, 0.0, 1.0}; ///< Any length.
    double radius = 1.0;
    glm::vec3 radiance{1.0f};
};

/// A Lambertian sphere; shines outwards.
struct SphereLight {
    glm::dvec3 center{0.0};
    double radius = 1.0;
    glm::vec3 radiance{1.0f};
};

/// Light from all around, from infinitely far: an equirectangular picture, rows from world -y (v =
/// 0) to +y, columns from +x towards +z. Virtual lights are placed by luminance.
struct EnvironmentLight {
    Emission emission; ///< `luminances` must be given; the texture is optional.
};

using LightSource = std::variant<PointLight, SpotLight, DirectionalLight, RectangleLight, DiskLight,
                                 SphereLight, EnvironmentLight>;

/// A homogeneous participating medium: fog.
struct Medium {
    float extinction = 0.05f; ///< Share of light lost per world unit, of all colours alike.
    glm::vec3 albedo{1.0f};   ///< Share of it that is scattered, RGB in [0,1].
    /// Henyey-Greenstein's g in (-1,1): 0 scatters alike in all directions, above 0 forward.
    float anisotropy = 0.0f;
};

} // namespace lamina
