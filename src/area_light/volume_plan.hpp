#pragma once

#include <lamina/area_light/area_light.hpp>

#include <span>
#include <vector>

namespace lamina {

/// The camera of a perspective view. farDistance: 0: the view's own far plane.
/// Errors: InvalidArgument (those of viewpoint(), an orthographic view, a far plane at infinity and
/// no farDistance).
[[nodiscard]] Result<GridCamera> makeEyeCamera(const View& view, double farDistance);

/// Where the shadow volume of each light is: fitted to what the camera sees and, if the desc asks
/// for it, shifted against each other by parts of a voxel, so that their steps do not add up to
/// bands ([WD13] 3.2).
/// Errors: those of EpipolarTransform::fit().
[[nodiscard]] Result<std::vector<EpipolarTransform>>
planVolumes(const GridCamera& eye, std::span<const VirtualLight> lights, const AreaLightDesc& desc);

} // namespace lamina
