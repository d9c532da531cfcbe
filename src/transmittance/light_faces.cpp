#include "transmittance/light_faces.hpp"

#include "core/finite.hpp"

#include <glm/geometric.hpp>
#include <glm/gtc/matrix_transform.hpp>
#include <glm/vector_relational.hpp>

#include <algorithm>
#include <cmath>
#include <string>

namespace lamina {
namespace {

using detail::isFinite;

/// A point light whose casters lie within this angle of one direction needs one grid.
constexpr double kWidestAngle = 50.0 * std::numbers::pi / 180.0;
constexpr double kWidestCone = 1.4;
/// Of the bounds: what shaders can still square.
constexpr double kFarthest = 1e18;

Error invalid(const std::string& text) {
    return Error{ErrorCode::InvalidArgument, "transmittance: " + text};
}

std::array<glm::dvec3, 8> cornersOf(const Box3& box, const glm::dmat4& worldToEye) {
    std::array<glm::dvec3, 8> corners;
    for (unsigned i = 0; i < 8; ++i)
        corners[i] = worldToEye * glm::dvec4((i & 1u) != 0 ? box.max.x : box.min.x,
                                             (i & 2u) != 0 ? box.max.y : box.min.y,
                                             (i & 4u) != 0 ? box.max.z : box.min.z, 1.0);
    return corners;
}

glm::dmat4 lookAlong(const glm::dvec3& from, const glm::dvec3& direction) {
    const glm::dvec3 size = glm::abs(direction);
    const glm::dvec3 up = size.y <= size.x && size.y <= size.z ? glm::dvec3(0, 1, 0)
                          : size.z <= size.x                   ? glm::dvec3(0, 0, 1)
                                                               : glm::dvec3(1, 0, 0);
    return glm::lookAt(from, from + direction, up);
}

/// A range that is not empty, slightly larger than [low, high], so that rounding loses nothing.
glm::dvec2 widened(double low, double high) {
    const double middle = 0.5 * (low + high);
    const double half =
        0.5 * (high - low) * (1.0 + 1e-6) + 1e-9 * (1.0 + std::abs(low) + std::abs(high));
    return {middle - half, middle + half};
}

GridCamera directionalCamera(const glm::dvec3& direction, const Box3& bounds) {
    GridCamera camera;
    camera.worldToEye = lookAlong(bounds.center(), direction);
    Box3 inEye;
    for (const glm::dvec3& corner : cornersOf(bounds, camera.worldToEye))
        inEye.extend(corner);
    const glm::dvec2 x = widened(inEye.min.x, inEye.max.x);
    const glm::dvec2 y = widened(inEye.min.y, inEye.max.y);
    const glm::dvec2 depth = widened(-inEye.max.z, -inEye.min.z);
    camera.left = x.x;
    camera.right = x.y;
    camera.bottom = y.x;
    camera.top = y.y;
    camera.near = depth.x;
    camera.far = depth.y;
    return camera;
}

/// A perspective camera at the light, no wider than `tangent` each way, fitted to the bounds.
GridCamera perspectiveCamera(const TransmittanceLight& light, const glm::dvec3& direction,
                             double tangent, const Box3& bounds) {
    GridCamera camera;
    camera.worldToEye = lookAlong(light.position, direction);
    camera.projection = Projection::Perspective;
    glm::dvec2 low(-tangent);
    glm::dvec2 high(tangent);
    const auto corners = cornersOf(bounds, camera.worldToEye);
    const auto depthOf = [](const glm::dvec3& corner) { return -corner.z; };
    const double nearest = depthOf(std::ranges::max(corners, {}, &glm::dvec3::z));
    const double farthest = depthOf(std::ranges::min(corners, {}, &glm::dvec3::z));
    if (nearest > light.near) {
        glm::dvec2 seenLow(tangent);
        glm::dvec2 seenHigh(-tangent);
        for (const glm::dvec3& corner : corners) {
            seenLow = glm::min(seenLow, glm::dvec2(corner) / depthOf(corner));
            seenHigh = glm::max(seenHigh, glm::dvec2(corner) / depthOf(corner));
        }
        const glm::dvec2 x = widened(std::max(low.x, seenLow.x), std::min(high.x, seenHigh.x));
        const glm::dvec2 y = widened(std::max(low.y, seenLow.y), std::min(high.y, seenHigh.y));
        // Bounds outside the cone: any window will do.
        if (x.x < x.y && y.x < y.y) {
            low = {x.x, y.x};
            high = {x.y, y.y};
        }
    }
    camera.near = std::max(light.near, nearest * (1.0 - 1e-6));
    camera.far = std::max(farthest, 1.001 * camera.near) * (1.0 + 1e-6);
    camera.left = low.x * camera.near;
    camera.right = high.x * camera.near;
    camera.bottom = low.y * camera.near;
    camera.top = high.y * camera.near;
    return camera;
}

/// Does a face that sees a pyramid of this tangent around `direction` see any of the box? May say
/// yes where it just misses.
bool seesBox(const glm::dvec3& position, const glm::dvec3& direction, double tangent,
             const Box3& box) {
    const auto corners = cornersOf(box, lookAlong(position, direction));
    const auto allOutside = [&](auto&& isOutside) {
        return std::ranges::all_of(corners, isOutside);
    };
    return !allOutside([](const glm::dvec3& c) { return c.z >= 0.0; }) &&
           !allOutside([&](const glm::dvec3& c) { return c.x > tangent * -c.z; }) &&
           !allOutside([&](const glm::dvec3& c) { return -c.x > tangent * -c.z; }) &&
           !allOutside([&](const glm::dvec3& c) { return c.y > tangent * -c.z; }) &&
           !allOutside([&](const glm::dvec3& c) { return -c.y > tangent * -c.z; });
}

Result<LightFaces> cubeFaces(const TransmittanceLight& light, const Box3& bounds,
                             const glm::uvec3& size, std::uint32_t maxFaces, double margin) {
    const double tangent = 1.0 + 2.0 * margin / std::min(size.x, size.y);
    LightFaces faces;
    for (int axis = 0; axis < 6; ++axis) {
        glm::dvec3 direction(0.0);
        direction[axis / 2] = axis % 2 == 0 ? 1.0 : -1.0;
        faces.ofAxis[static_cast<std::size_t>(axis)] = -1;
        if (!seesBox(light.position, direction, tangent, bounds))
            continue;
        auto grid =
            GridTransform::camera(perspectiveCamera(light, direction, tangent, bounds), size);
        if (!grid)
            return grid.error();
        faces.ofAxis[static_cast<std::size_t>(axis)] = static_cast<int>(faces.grids.size());
        faces.grids.push_back(*grid);
    }
    if (faces.grids.size() > maxFaces)
        return Error{ErrorCode::DeviceLimit,
                     "transmittance: expected a point light that needs at most " +
                         std::to_string(maxFaces) + " faces, found one that needs " +
                         std::to_string(faces.grids.size()) +
                         "; create it with maxFaces 6, or move the light away from the casters"};
    return faces;
}

Result<void> check(const TransmittanceLight& light, const Box3& bounds) {
    if (bounds.isEmpty() || !isFinite(bounds.min) || !isFinite(bounds.max))
        return invalid("expected finite bounds that hold all casters, found an empty or infinite "
                       "box; pass the casters' world box");
    if (glm::any(glm::greaterThan(glm::max(-bounds.min, bounds.max), glm::dvec3(kFarthest))))
        return invalid("expected bounds with coordinates of at most 1e18, found larger ones; pass "
                       "the casters' world box");
    if (light.kind > LightKind::Directional)
        return invalid("expected a value of LightKind, found " +
                       std::to_string(static_cast<int>(light.kind)));
    if (light.kind != LightKind::Point &&
        !(glm::length(light.direction) > 0.0 && std::isfinite(glm::length(light.direction))))
        return invalid("expected a finite light direction of some length, found another");
    if (light.kind == LightKind::Directional)
        return {};
    if (!isFinite(light.position) || !(light.near > 0.0) || !std::isfinite(light.near))
        return invalid("expected a finite light position and near distance above 0, found near " +
                       std::to_string(light.near));
    if (light.kind == LightKind::Spot && !(light.coneAngle > 0.0 && light.coneAngle <= kWidestCone))
        return invalid("expected a spot's cone angle in (0, 1.4] radians, found " +
                       std::to_string(light.coneAngle) + "; use a point light for wider ones");
    return {};
}

} // namespace

Result<LightFaces> fitLightFaces(const TransmittanceLight& light, const Box3& bounds,
                                 const glm::uvec3& size, std::uint32_t maxFaces, double margin) {
    if (auto valid = check(light, bounds); !valid)
        return valid.error();
    GridCamera camera;
    if (light.kind == LightKind::Directional) {
        camera = directionalCamera(glm::normalize(light.direction), bounds);
    } else if (light.kind == LightKind::Spot) {
        camera = perspectiveCamera(light, glm::normalize(light.direction),
                                   std::tan(light.coneAngle), bounds);
    } else {
        const glm::dvec3 middle = bounds.center() - light.position;
        const double radius = 0.5 * glm::length(bounds.size());
        if (radius >= std::sin(kWidestAngle) * glm::length(middle))
            return cubeFaces(light, bounds, size, maxFaces, margin);
        camera = perspectiveCamera(light, glm::normalize(middle), std::tan(kWidestAngle), bounds);
    }
    auto grid = GridTransform::camera(camera, size);
    if (!grid)
        return grid.error();
    LightFaces faces;
    faces.grids.push_back(*grid);
    return faces;
}

} // namespace lamina
