#include "gl/view_constants.hpp"

#include "core/finite.hpp"

#include <glm/gtc/matrix_transform.hpp>
#include <glm/matrix.hpp>

#include <cmath>
#include <string>

namespace lamina {
namespace {

using detail::isFinite;

Error invalid(std::string_view operation, const std::string& found) {
    return Error{
        ErrorCode::InvalidArgument,
        std::string(operation) +
            ": expected a view with an invertible worldToClip, a size of at least 1 x 1 and "
            "a depth range of two different depths, found " +
            found + "; pass the frame's own camera matrices and viewport"};
}

struct Inverse {
    glm::dmat4 clipToWorld;
    glm::dvec4 viewpoint;
};

Result<Inverse> invert(const View& view, std::string_view operation) {
    if (!isFinite(view.worldToClip))
        return invalid(operation, "a matrix that is not finite");
    if (view.size.x == 0 || view.size.y == 0)
        return invalid(operation, "a size of " + std::to_string(view.size.x) + " x " +
                                      std::to_string(view.size.y));
    if (!std::isfinite(view.depthRange.x) || !std::isfinite(view.depthRange.y) ||
        view.depthRange.x == view.depthRange.y)
        return invalid(operation, "a depth range of " + std::to_string(view.depthRange.x) + " to " +
                                      std::to_string(view.depthRange.y));
    Inverse inverse{glm::inverse(view.worldToClip), {}};
    if (!isFinite(inverse.clipToWorld) || glm::determinant(view.worldToClip) == 0.0)
        return invalid(operation, "a matrix without an inverse");
    // All points of the line through the eye along clip space's depth axis share x/w and y/w: the
    // eye is the world point whose clip x, y and w vanish.
    const glm::dvec4 point = inverse.clipToWorld[2];
    const double size = glm::length(glm::dvec3(point));
    if (std::abs(point.w) > 1e-12 * size) {
        inverse.viewpoint = {glm::dvec3(point) / point.w, 1.0};
    } else {
        const bool nearIsLess =
            (view.depthRange.x < view.depthRange.y) == (view.backgroundDepth > 0.5f);
        inverse.viewpoint = {glm::dvec3(point) * ((nearIsLess ? -1.0 : 1.0) / size), 0.0};
    }
    return inverse;
}

} // namespace

Result<glm::dvec4> viewpoint(const View& view) {
    auto inverse = invert(view, "viewpoint");
    if (!inverse)
        return inverse.error();
    return inverse->viewpoint;
}

Result<shared::LaminaViewConstants> makeViewConstants(const View& view,
                                                      std::string_view operation) {
    auto inverse = invert(view, operation);
    if (!inverse)
        return inverse.error();
    const glm::dvec2 size(view.size);
    const double clipNear = view.clipDepth == ClipDepth::ZeroToOne ? 0.0 : -1.0;
    const double depthScale = (view.depthRange.y - view.depthRange.x) / (1.0 - clipNear);
    // Column by column: clip to window.
    glm::dmat4 clipToWindow(1.0);
    clipToWindow[0][0] = 0.5 * size.x;
    clipToWindow[1][1] = 0.5 * size.y;
    clipToWindow[2][2] = depthScale;
    clipToWindow[3] = {0.5 * size.x, 0.5 * size.y, view.depthRange.x - clipNear * depthScale, 1.0};

    glm::dvec3 origin(inverse->viewpoint);
    if (inverse->viewpoint.w == 0.0)
        origin = glm::dvec3(inverse->clipToWorld[3]) / inverse->clipToWorld[3].w;
    // As the shader sees it, so that the subtraction below leaves nothing over.
    origin = glm::dvec3(glm::vec3(origin));
    const glm::dmat4 worldToWindow =
        clipToWindow * view.worldToClip * glm::translate(glm::dmat4(1.0), origin);

    shared::LaminaViewConstants constants{};
    constants.windowToWorld = glm::mat4(glm::inverse(worldToWindow));
    constants.worldToWindow = glm::mat4(worldToWindow);
    constants.viewpoint = glm::vec4(inverse->viewpoint);
    constants.origin = glm::vec4(glm::vec3(origin), view.backgroundDepth);
    constants.size = {view.size, 0, 0};
    return constants;
}

} // namespace lamina
