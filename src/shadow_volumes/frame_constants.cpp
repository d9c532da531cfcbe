#include "shadow_volumes/frame_constants.hpp"

#include "gl/view_constants.hpp"

#include <glm/geometric.hpp>
#include <glm/gtc/matrix_transform.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

namespace lamina {
namespace {

/// Layers at right angles to the light's direction as the middle of the picture shows it.
glm::vec4 layerAxis(const View& view, const glm::dvec4& light, std::uint32_t layers) {
    const glm::dvec2 size(view.size);
    // Along a ray of the light, positions in clip space change by multiples of the light's own; in
    // the middle of the picture, where x and y are 0, the change of x and y alone moves the pixel.
    glm::dvec2 direction = glm::dvec2(view.worldToClip * light) * size;
    const double length = glm::length(direction);
    // A light ahead or behind shows no direction; any one serves.
    direction = length > 1e-12 ? direction / length : glm::dvec2(0.0, 1.0);
    const std::array corners = {0.0, direction.x * size.x, direction.y * size.y,
                                glm::dot(direction, size)};
    const auto [least, greatest] = std::ranges::minmax(corners);
    const double scale = layers / (greatest - least);
    return {direction * scale, -least * scale, 0.0};
}

Result<glm::dvec4> checkedLight(const glm::dvec4& light) {
    const double length = glm::length(glm::dvec3(light));
    if (light.w == 1.0 && std::isfinite(length))
        return light;
    if (light.w != 0.0 || !std::isfinite(length) || length == 0.0)
        return Error{ErrorCode::InvalidArgument,
                     "shadow volumes: expected a light at a finite position (w 1) or in a "
                     "direction other than zero (w 0), found (" +
                         std::to_string(light.x) + ", " + std::to_string(light.y) + ", " +
                         std::to_string(light.z) + ", " + std::to_string(light.w) + ")"};
    return glm::dvec4(glm::dvec3(light) / length, 0.0);
}

} // namespace

Result<ShadowFrame> makeShadowFrame(const ShadowScene& scene, const ShadowVolumesDesc& desc,
                                    double depthStep) {
    const auto view = makeViewConstants(scene.view, "shadow volumes");
    if (!view)
        return view.error();
    const auto light = checkedLight(scene.light);
    if (!light)
        return light.error();

    ShadowFrame frame;
    frame.origin = glm::dvec3(view->origin);
    shared::LaminaShadowFrame& constants = frame.constants;
    constants.originToClip =
        glm::mat4(scene.view.worldToClip * glm::translate(glm::dmat4(1.0), frame.origin));
    constants.windowToOrigin = view->windowToWorld;
    const bool isPoint = light->w != 0.0;
    constants.light =
        glm::vec4(isPoint ? glm::dvec4(glm::dvec3(*light) - frame.origin, 1.0) : *light);
    if (!isPoint) {
        const glm::dvec3 to(*light);
        const glm::dvec3 other = std::abs(to.y) < 0.9 ? glm::dvec3(0, 1, 0) : glm::dvec3(1, 0, 0);
        const glm::dvec3 u = glm::normalize(glm::cross(other, to));
        constants.lightU = glm::vec4(glm::vec3(u), 0.0f);
        constants.lightV = glm::vec4(glm::vec3(glm::cross(to, u)), 0.0f);
    }
    constants.layerAxis = layerAxis(scene.view, *light, desc.layers);
    const bool growsWithDistance = scene.view.backgroundDepth > 0.5f;
    const glm::dvec2 range = scene.view.depthRange;
    constants.depth = {scene.view.backgroundDepth, growsWithDistance ? 1.0f : -1.0f,
                       std::min(range.x, range.y), std::max(range.x, range.y)};
    // Depths that fall with distance keep their relative precision in float formats; others never
    // do better than the steps of the greatest.
    constexpr double kFloatStep = 0x1p-24;
    const bool isRelative = !growsWithDistance && depthStep == 0.0;
    const double units = desc.depthBiasUnits * std::max(depthStep, kFloatStep);
    constants.bias = {desc.depthBiasSlope, isRelative ? 0.0 : units, isRelative ? units : 0.0, 0.0};
    constants.size = {scene.view.size, desc.lightMapTexels, isPoint ? 6 : 1};
    const std::uint32_t flags = (desc.cullCasters ? LAMINA_SHADOW_CULL_CASTERS : 0u) |
                                (desc.clampLayers ? LAMINA_SHADOW_CLAMP : 0u) |
                                (desc.casterDepthTest ? LAMINA_SHADOW_DEPTH_TEST : 0u) |
                                (desc.search == LayerSearch::Queries ? LAMINA_SHADOW_QUERIES : 0u);
    constants.counts = {desc.layers, layerWords(desc.layers), scene.casters.size(), flags};
    return frame;
}

} // namespace lamina
