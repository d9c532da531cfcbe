#include "voxelize/epipolar_constants.hpp"

#include <cmath>
#include <string>

namespace lamina {

namespace {

Error invalid(const std::string& text) {
    return {ErrorCode::InvalidArgument, "epipolar grid: " + text};
}

} // namespace

Result<void> checkEpipolarLayout(const EpipolarLayout& layout) {
    if (layout.bitsPerTexel != 127 && layout.bitsPerTexel != 128)
        return invalid("expected 127 or 128 bits per texel, found " +
                       std::to_string(layout.bitsPerTexel));
    if (!std::isfinite(layout.alphaBias) || !std::isfinite(layout.phiBias) ||
        !(std::isfinite(layout.epipoleVoxels) && layout.epipoleVoxels >= 0.0))
        return invalid("expected finite biases and an epipole rule of 0 or more voxels, found "
                       "alphaBias " +
                       std::to_string(layout.alphaBias) + ", phiBias " +
                       std::to_string(layout.phiBias) + ", epipoleVoxels " +
                       std::to_string(layout.epipoleVoxels));
    return {};
}

Result<void> checkEpipolarLayout(std::span<const EpipolarTransform> transforms,
                                 const EpipolarLayout& layout) {
    if (transforms.empty())
        return invalid("expected at least one shadow volume, found none");
    for (const EpipolarTransform& transform : transforms)
        if (transform.size() != transforms.front().size())
            return invalid("expected shadow volumes of one size, found " +
                           transforms.front().describe() + " and " + transform.describe() +
                           "; use a grid for each size");
    return checkEpipolarLayout(layout);
}

double epipoleRuleDistance(const EpipolarTransform& transform) {
    return transform.isDirectional() ? transform.ranges().skyDistance : transform.lightDistance();
}

shared::LaminaEpipolarSpace makeEpipolarSpace(const EpipolarTransform& transform,
                                              const EpipolarLayout& layout,
                                              const glm::uvec2& tile) {
    const glm::dvec3 scale = transform.scale();
    shared::LaminaEpipolarSpace space{};
    space.eye = glm::vec4(glm::dvec4(transform.eye(), transform.lightDistance()));
    space.axis = glm::vec4(glm::dvec4(transform.axis(), layout.epipoleVoxels / scale.x));
    space.u = glm::vec4(glm::dvec4(transform.u(), epipoleRuleDistance(transform)));
    space.v = glm::vec4(glm::dvec4(transform.v(), 0.0));
    space.origin = glm::vec4(glm::dvec4(transform.origin(), 0.0));
    space.scale = glm::vec4(glm::dvec4(scale, 0.0));
    space.bias = glm::vec4(glm::dvec4(layout.alphaBias, 0.0, layout.phiBias, 0.0));
    std::uint32_t flags = 0;
    if (transform.isDirectional())
        flags |= LAMINA_EPIPOLAR_DIRECTIONAL;
    if (transform.isFullCircle())
        flags |= LAMINA_EPIPOLAR_FULL_CIRCLE;
    space.size = glm::uvec4(transform.size(), flags);
    space.tile = glm::uvec4(tile, layout.bitsPerTexel, 0);
    return space;
}

} // namespace lamina
