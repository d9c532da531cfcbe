#include "area_light/volume_plan.hpp"

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>

namespace lamina {
namespace {

constexpr double kPi = std::numbers::pi;

Error invalid(const std::string& text) {
    return {ErrorCode::InvalidArgument, "area light: " + text};
}

/// Directions of a perspective view's pixels: middle + x stepX + y stepY at clip (x, y).
struct Rays {
    glm::dvec3 eye{0.0};
    glm::dvec3 middle{0.0}, stepX{0.0}, stepY{0.0};
};

Rays makeRays(const glm::dmat4& worldToClip, const glm::dmat4& clipToWorld, const glm::dvec3& eye) {
    const auto direction = [&](int column) {
        return glm::dvec3(clipToWorld[column]) - eye * clipToWorld[column].w;
    };
    Rays rays{eye, direction(3), direction(0), direction(1)};
    // Clip w grows away from the eye, in front of it.
    if ((worldToClip * glm::dvec4(rays.middle, 0.0)).w < 0.0) {
        rays.middle = -rays.middle;
        rays.stepX = -rays.stepX;
        rays.stepY = -rays.stepY;
    }
    return rays;
}

/// Least and greatest eye depth of the corners of the plane of clip depth z.
glm::dvec2 planeDepths(const glm::dmat4& clipToWorld, const glm::dvec3& eye,
                       const glm::dvec3& forward, double z) {
    glm::dvec2 range(std::numeric_limits<double>::infinity(), 0.0);
    for (const double x : {-1.0, 1.0})
        for (const double y : {-1.0, 1.0}) {
            const glm::dvec4 point = clipToWorld * glm::dvec4(x, y, z, 1.0);
            const double depth = glm::dot(glm::dvec3(point) - eye * point.w, forward) / point.w;
            const bool isFinite = std::isfinite(depth) && depth > 0.0 && depth < 1e12;
            range.x = std::min(range.x, isFinite ? depth : range.x);
            range.y = isFinite ? std::max(range.y, depth) : std::numeric_limits<double>::infinity();
        }
    return range;
}

/// A number in [0,1) for each (light, axis), as different as possible from light to light.
double shift(std::size_t light, int axis) {
    constexpr double kSteps[3] = {0.8191725133961645, 0.6710436067037893, 0.5497004779019703};
    const double value = 0.5 + static_cast<double>(light) * kSteps[axis];
    return value - std::floor(value);
}

/// A range of one voxel more, moved down by a part of it, within limits.
glm::dvec2 shifted(const glm::dvec2& range, std::uint32_t voxels, double part, double low,
                   double high) {
    if (voxels < 2)
        return range;
    const double step = (range.y - range.x) / (voxels - 1);
    const double from = range.x - part * step;
    return {std::max(from, low), std::min(from + voxels * step, high)};
}

Result<EpipolarTransform> jittered(const EpipolarTransform& transform, const glm::dvec3& part) {
    EpipolarRanges ranges = transform.ranges();
    const glm::uvec3 size = transform.size();
    const double limit = transform.isDirectional() ? std::numeric_limits<double>::max() : kPi;
    ranges.alpha = shifted(ranges.alpha, size.x, part.x, 0.0, kPi);
    ranges.phi = shifted(ranges.phi, size.z, part.z, 0.0, limit);
    ranges.thetaZero = transform.u();
    if (transform.isFullCircle()) {
        const double angle = part.y * 2.0 * kPi / size.y;
        ranges.thetaZero = std::cos(angle) * transform.u() + std::sin(angle) * transform.v();
    } else {
        ranges.theta = shifted(ranges.theta, size.y, part.y, -kPi, kPi);
    }
    return EpipolarTransform::create(transform.eye(), transform.light(), ranges, size);
}

/// So far that squares of distances overflow single precision.
bool isTooFar(const EpipolarLight& light, const glm::dvec3& eye) {
    constexpr double kFarthest = 1e15;
    if (light.kind == LightKind::Directional)
        return false;
    const glm::dvec3 offset = glm::abs(light.position - eye);
    // NaN is no distance: the transform says so.
    return std::max({offset.x, offset.y, offset.z}) > kFarthest;
}

} // namespace

Result<GridCamera> makeEyeCamera(const View& view, double farDistance) {
    const auto eye = viewpoint(view);
    if (!eye)
        return eye.error();
    if (eye->w == 0.0)
        return invalid("expected a perspective view, found an orthographic one, which has no eye "
                       "that the shadow volumes could be made for");
    const glm::dmat4 clipToWorld = glm::inverse(view.worldToClip);
    const glm::dvec3 place(*eye);
    const Rays rays = makeRays(view.worldToClip, clipToWorld, place);
    glm::dvec3 forward = glm::normalize(glm::cross(rays.stepX, rays.stepY));
    if (glm::dot(forward, rays.middle) < 0.0)
        forward = -forward;
    const glm::dvec3 right = glm::normalize(rays.stepX);
    const glm::dvec3 up = glm::cross(right, forward);

    const double clipNear = view.clipDepth == ClipDepth::ZeroToOne ? 0.0 : -1.0;
    glm::dvec2 first = planeDepths(clipToWorld, place, forward, clipNear);
    glm::dvec2 second = planeDepths(clipToWorld, place, forward, 1.0);
    if (second.x < first.x)
        std::swap(first, second);
    const double far = farDistance > 0.0 ? farDistance : second.y;
    if (!std::isfinite(far))
        return invalid("expected a farDistance for a view without a far plane, found 0");
    constexpr double kLeastNear = 1e-4;
    const double near = std::clamp(first.x, kLeastNear * far, 0.5 * far);

    GridCamera camera = GridCamera::perspective(glm::dmat4(1.0), 1.0, 1.0, near, far);
    const glm::dvec3 rows[] = {right, up, -forward};
    for (int row = 0; row < 3; ++row) {
        for (int column = 0; column < 3; ++column)
            camera.worldToEye[column][row] = rows[row][column];
        camera.worldToEye[3][row] = -glm::dot(rows[row], place);
    }
    glm::dvec2 low(std::numeric_limits<double>::infinity());
    glm::dvec2 high(-std::numeric_limits<double>::infinity());
    for (const double x : {-1.0, 1.0})
        for (const double y : {-1.0, 1.0}) {
            const glm::dvec3 ray = rays.middle + x * rays.stepX + y * rays.stepY;
            const glm::dvec2 at =
                near / glm::dot(ray, forward) * glm::dvec2(glm::dot(ray, right), glm::dot(ray, up));
            low = glm::min(low, at);
            high = glm::max(high, at);
        }
    camera.left = low.x;
    camera.right = high.x;
    camera.bottom = low.y;
    camera.top = high.y;
    return camera;
}

Result<std::vector<EpipolarTransform>> planVolumes(const GridCamera& eye,
                                                   std::span<const VirtualLight> lights,
                                                   const AreaLightDesc& desc) {
    const glm::dvec3 place(glm::inverse(eye.worldToEye)[3]);
    std::vector<EpipolarTransform> transforms;
    transforms.reserve(lights.size());
    for (std::size_t i = 0; i < lights.size(); ++i) {
        if (isTooFar(lights[i].light, place))
            return invalid("virtual light " + std::to_string(i) +
                           ": expected a light within 1e15 of the eye, found one too far away; "
                           "light the scene with a DirectionalLight");
        auto fitted = EpipolarTransform::fit(eye, lights[i].light, desc.voxels);
        if (fitted && desc.jitter && lights.size() > 1)
            fitted = jittered(*fitted, {shift(i, 0), shift(i, 1), shift(i, 2)});
        if (!fitted)
            return Error{fitted.error().code, "area light: virtual light " + std::to_string(i) +
                                                  ": " + fitted.error().text};
        transforms.push_back(*fitted);
    }
    return transforms;
}

} // namespace lamina
