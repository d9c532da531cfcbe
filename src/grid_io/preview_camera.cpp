#include "grid_io/preview_camera.hpp"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

namespace lamina::detail {

PreviewCamera::PreviewCamera(const Box3& box, const PreviewDesc& desc)
    : pixels(desc.width, desc.height) {
    forward = glm::normalize(desc.viewDirection);
    glm::dvec3 hint = glm::normalize(desc.up);
    if (std::abs(glm::dot(hint, forward)) > 0.9999) {
        // Straight along up: the world axis most across the view, z in front of y for a y-up top
        // view.
        hint = std::abs(forward.z) < 0.9 ? glm::dvec3(0, 0, -1) : glm::dvec3(0, 1, 0);
    }
    right = glm::normalize(glm::cross(forward, hint));
    up = glm::cross(right, forward);
    halfWindow.y = std::tan(0.5 * desc.fieldOfView);
    halfWindow.x = halfWindow.y * pixels.x / pixels.y;

    // With the orientation fixed, a corner at (x, y, depth) fits if |x - eye x| <= slope * (depth -
    // eye depth), and alike for y. Each side of the window bounds one combination of the eye's
    // coordinates; the nearest eye that satisfies all four follows directly.
    const glm::dvec2 slope = halfWindow * (1.0 - desc.margin);
    const double most = std::numeric_limits<double>::infinity();
    glm::dvec2 low(most), high(-most); // min of x + slope * depth, max of x - slope * depth
    double nearest = most;
    for (int corner = 0; corner < 8; ++corner) {
        const glm::dvec3 point((corner & 1) ? box.max.x : box.min.x,
                               (corner & 2) ? box.max.y : box.min.y,
                               (corner & 4) ? box.max.z : box.min.z);
        const glm::dvec2 across(glm::dot(point, right), glm::dot(point, up));
        const double depth = glm::dot(point, forward);
        low = glm::min(low, across + slope * depth);
        high = glm::max(high, across - slope * depth);
        nearest = std::min(nearest, depth);
    }
    const glm::dvec2 depths = (low - high) / (2.0 * slope);
    const double depth = std::min({depths.x, depths.y, nearest - 1e-3 * glm::length(box.size())});
    const glm::dvec2 across = 0.5 * (low + high);
    eye = across.x * right + across.y * up + depth * forward;
}

glm::dvec3 PreviewCamera::direction(const glm::dvec2& pixel) const {
    const double x = (2.0 * pixel.x / pixels.x - 1.0) * halfWindow.x;
    const double y = (1.0 - 2.0 * pixel.y / pixels.y) * halfWindow.y;
    return glm::normalize(forward + x * right + y * up);
}

} // namespace lamina::detail
