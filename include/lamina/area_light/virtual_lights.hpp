#pragma once

#include <lamina/area_light/light_source.hpp>
#include <lamina/core/export.hpp>
#include <lamina/core/result.hpp>
#include <lamina/voxelize/epipolar_transform.hpp>

#include <cstdint>
#include <vector>

namespace lamina {

/// A virtual point light (VPL): a part of a light source, drawn together into a point ([WD13]
/// 3.1.1).
struct VirtualLight {
    EpipolarLight light;    ///< Position or direction, and the cone of a spot.
    glm::dvec3 normal{0.0}; ///< Unit normal of a Lambertian emitter; else 0.
    /// Radiant intensity along the normal (Lambertian) or in all directions, or irradiance
    /// (directional); RGB, without the source's texture.
    glm::vec3 intensity{1.0f};
    glm::vec2 textureCoordinates{0.0f};
    float textureShare = 1.0f; ///< Of the texture's area that this light stands for.
    /// Radius of a disk of the size of the part that this light stands for, world units; 0 for
    /// points.
    double radius = 0.0;

    [[nodiscard]] bool isLambertian() const { return normal != glm::dvec3(0.0); }
};

/// Virtual lights of a source, by Halton's sequence in bases 2 and 3; one for point, spot and
/// directional lights, whatever `count`. Runs of the result are well spread, too.
/// count: at least 1. offset: of the first point in the sequence; other offsets give other lights.
/// Errors: InvalidArgument (a count of 0, non-finite or empty shapes, a strength that is negative
/// or not finite, luminances of another size, negative or all 0, an environment without
/// luminances).
[[nodiscard]] LAMINA_API Result<std::vector<VirtualLight>>
sampleVirtualLights(const LightSource& source, std::uint32_t count, std::uint32_t offset = 0);

} // namespace lamina
