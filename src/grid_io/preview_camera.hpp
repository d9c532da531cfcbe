#pragma once

#include <lamina/core/box.hpp>
#include <lamina/grid_io/preview.hpp>

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

namespace lamina::detail {

/// A pinhole camera that sees a box just inside the picture's margin, as large as fits.
struct PreviewCamera {
    glm::dvec3 eye{0.0};
    glm::dvec3 right{1.0, 0.0, 0.0}, up{0.0, 1.0, 0.0},
        forward{0.0, 0.0, -1.0}; ///< Unit, orthogonal.
    glm::dvec2 halfWindow{1.0};  ///< Half the window's width and height at the distance 1.
    glm::dvec2 pixels{1.0};      ///< Picture size.

    PreviewCamera(const Box3& box, const PreviewDesc& desc);

    /// Unit direction through a point of the picture, in pixels from its upper left corner.
    [[nodiscard]] glm::dvec3 direction(const glm::dvec2& pixel) const;
    /// World width of a pixel at a distance along the viewing direction.
    [[nodiscard]] double pixelWidth(double depth) const {
        return 2.0 * halfWindow.y * depth / pixels.y;
    }
};

} // namespace lamina::detail
