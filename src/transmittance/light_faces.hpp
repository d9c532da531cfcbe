#pragma once

#include <lamina/grid/grid_transform.hpp>
#include <lamina/transmittance/transmittance.hpp>

#include <array>
#include <vector>

namespace lamina {

/// The grids of a light's slicemaps or volumes.
struct LightFaces {
    std::vector<GridTransform> grids;
    /// The grid that sees each axis of a cube around the light, +x, -x, +y, -y, +z, -z; -1: none,
    /// no caster is there. All zero if one grid serves all directions.
    std::array<int, 6> ofAxis{};
};

/// One grid fitted to the bounds as the light sees them, or up to six around a point light in the
/// midst of them. margin: columns by which the faces of a cube overlap, for filters.
/// Errors: InvalidArgument (light, bounds, size), DeviceLimit (more than maxFaces).
[[nodiscard]] LAMINA_API Result<LightFaces> fitLightFaces(const TransmittanceLight& light,
                                                          const Box3& bounds,
                                                          const glm::uvec3& size,
                                                          std::uint32_t maxFaces, double margin);

} // namespace lamina
