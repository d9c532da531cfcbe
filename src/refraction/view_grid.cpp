#include "refraction/view_grid.hpp"

#include "core/finite.hpp"

#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include <algorithm>
#include <cmath>
#include <string>

namespace lamina {
namespace {

using detail::isFinite;

/// Cosines and relative lengths below this are rounding of the host's matrices.
constexpr double kSkew = 1e-5;
/// The near depth of a perspective grid is at least this share of the far depth.
constexpr double kNearest = 1e-5;

/// One axis of a window: the unit vector along it, and where the window ends.
struct WindowAxis {
    glm::dvec3 direction{0.0};
    double low = 0.0, high = 0.0;
};

/// `row`: of the clip coordinate, divided so that w is the depth (perspective) or 1. Perspective
/// windows are at depth 1.
WindowAxis windowAxis(const glm::dvec4& row, const glm::dvec3& forward, bool isPerspective) {
    const glm::dvec3 gradient(row);
    const double along = glm::dot(gradient, forward);
    const glm::dvec3 across = gradient - along * forward;
    const double size = glm::length(across);
    const double center = isPerspective ? along : row.w;
    return {across / size, (-1.0 - center) / size, (1.0 - center) / size};
}

Error invalid(std::string_view operation, const std::string& text) {
    return Error{ErrorCode::InvalidArgument, std::string(operation) + ": " + text};
}

} // namespace

Result<GridTransform> makeViewGrid(const View& view, const Box3& bounds, std::uint32_t slices,
                                   std::string_view operation) {
    const auto eye = viewpoint(view);
    if (!eye)
        return invalid(operation, eye.error().text);
    if (bounds.isEmpty() || !isFinite(bounds))
        return invalid(operation, "expected finite bounds that hold the object, found none");
    const glm::dmat4 rows = glm::transpose(view.worldToClip);
    const bool isPerspective = eye->w != 0.0;
    const glm::dvec3 position = isPerspective ? glm::dvec3(*eye) : glm::dvec3(0.0);
    const glm::dvec3 forward =
        isPerspective ? glm::normalize(glm::dvec3(rows[3])) : -glm::normalize(glm::dvec3(*eye));
    const double scale = isPerspective ? glm::length(glm::dvec3(rows[3])) : rows[3].w;
    const WindowAxis x = windowAxis(rows[0] / scale, forward, isPerspective);
    const WindowAxis y = windowAxis(rows[1] / scale, forward, isPerspective);
    if (!isPerspective) {
        for (int axis = 0; axis < 2; ++axis)
            if (std::abs(glm::dot(glm::dvec3(rows[axis]), forward)) >
                kSkew * glm::length(glm::dvec3(rows[axis])))
                return invalid(operation, "expected an orthographic view at right angles to its "
                                          "window, found an oblique one");
    }
    if (std::abs(glm::dot(x.direction, y.direction)) > kSkew)
        return invalid(operation, "expected a view whose window has right angles, found skew");

    GridCamera camera;
    const glm::dvec3 axes[] = {x.direction, y.direction, -forward};
    for (int axis = 0; axis < 3; ++axis) {
        for (int column = 0; column < 3; ++column)
            camera.worldToEye[column][axis] = axes[axis][column];
        camera.worldToEye[3][axis] = -glm::dot(axes[axis], position);
    }
    double nearest = std::numeric_limits<double>::infinity();
    double farthest = -nearest;
    for (int corner = 0; corner < 8; ++corner) {
        const glm::dvec3 point(corner & 1 ? bounds.max.x : bounds.min.x,
                               corner & 2 ? bounds.max.y : bounds.min.y,
                               corner & 4 ? bounds.max.z : bounds.min.z);
        const double depth = glm::dot(forward, point - position);
        nearest = std::min(nearest, depth);
        farthest = std::max(farthest, depth);
    }
    const double margin = 1e-3 * std::max(glm::length(bounds.size()), 1e-30);
    camera.far = farthest + margin;
    camera.near = nearest - margin;
    double window = 1.0;
    if (isPerspective) {
        // An object behind the viewer leaves every column empty, wherever the grid is.
        camera.far = camera.far > 0.0 ? camera.far : 1.0;
        camera.near = std::max(camera.near, kNearest * camera.far);
        window = camera.near;
        camera.projection = Projection::Perspective;
    }
    camera.left = window * x.low;
    camera.right = window * x.high;
    camera.bottom = window * y.low;
    camera.top = window * y.high;
    auto grid = GridTransform::camera(camera, {view.size.x, view.size.y, slices});
    if (!grid)
        return invalid(operation, grid.error().text);
    return grid;
}

} // namespace lamina
