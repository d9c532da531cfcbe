#include <lamina/voxelize/epipolar_transform.hpp>

#include "core/finite.hpp"

#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace lamina {
namespace {

using detail::isFinite;

constexpr double kPi = std::numbers::pi;
/// No range is narrower than this (radians, or a share of the far distance): scales stay finite.
constexpr double kLeastRange = 1e-6;

Error invalid(const std::string& text) {
    return Error{ErrorCode::InvalidArgument, "epipolar transform: " + text};
}

/// Angle between two vectors, exact near 0 and pi.
double angleBetween(const glm::dvec3& a, const glm::dvec3& b) {
    return std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b));
}

glm::dvec2 widened(glm::dvec2 range, double least, double low, double high) {
    if (range.y - range.x < least) {
        const double middle = 0.5 * (range.x + range.y);
        range = {middle - 0.5 * least, middle + 0.5 * least};
    }
    if (range.x < low)
        range = {low, std::max(range.y, low + least)};
    if (range.y > high)
        range = {std::min(range.x, high - least), high};
    return range;
}

/// What a perspective camera sees: the four edges of its pyramid, in order around it.
struct ViewPyramid {
    glm::dvec3 eye{0.0};
    std::array<glm::dvec3, 4> edges{};
    glm::dvec3 center{0.0};
    double nearDistance = 0.0; ///< Least distance of a visible point.
    double farDistance = 0.0;  ///< Greatest.
};

ViewPyramid makePyramid(const GridCamera& camera) {
    const glm::dmat4 eyeToWorld = glm::inverse(camera.worldToEye);
    ViewPyramid pyramid;
    pyramid.eye = glm::dvec3(eyeToWorld[3]);
    const std::array<glm::dvec2, 4> corners = {{{camera.left, camera.bottom},
                                                {camera.right, camera.bottom},
                                                {camera.right, camera.top},
                                                {camera.left, camera.top}}};
    double longest = 0.0;
    for (std::size_t i = 0; i < corners.size(); ++i) {
        const glm::dvec4 direction =
            eyeToWorld * glm::dvec4(corners[i].x, corners[i].y, -camera.near, 0.0);
        pyramid.edges[i] = glm::normalize(glm::dvec3(direction));
        pyramid.center += pyramid.edges[i];
        longest = std::max(longest, glm::length(glm::dvec3(direction)) / camera.near);
    }
    pyramid.nearDistance = camera.near;
    pyramid.farDistance = camera.far * longest;
    return pyramid;
}

/// Normals of the pyramid's sides, pointing inward.
glm::dvec3 sideNormal(const ViewPyramid& pyramid, std::size_t side) {
    const glm::dvec3 normal =
        glm::normalize(glm::cross(pyramid.edges[side], pyramid.edges[(side + 1) % 4]));
    return glm::dot(normal, pyramid.center) < 0.0 ? -normal : normal;
}

bool contains(const ViewPyramid& pyramid, const glm::dvec3& direction) {
    for (std::size_t side = 0; side < 4; ++side)
        if (glm::dot(sideNormal(pyramid, side), direction) < 0.0)
            return false;
    return true;
}

/// Least angle between `axis` and the directions in the pyramid.
double leastAngle(const ViewPyramid& pyramid, const glm::dvec3& axis) {
    if (contains(pyramid, axis))
        return 0.0;
    double least = kPi;
    for (std::size_t side = 0; side < 4; ++side) {
        const glm::dvec3& first = pyramid.edges[side];
        const glm::dvec3& second = pyramid.edges[(side + 1) % 4];
        least = std::min(least, angleBetween(first, axis));
        // The side's nearest direction, if it lies between its edges.
        const glm::dvec3 normal = sideNormal(pyramid, side);
        const glm::dvec3 nearest = axis - glm::dot(axis, normal) * normal;
        const glm::dvec3 bisector = first + second;
        if (glm::length(nearest) > 0.0 &&
            angleBetween(nearest, bisector) <= angleBetween(first, bisector))
            least = std::min(least, angleBetween(nearest, axis));
    }
    return least;
}

Result<void> checkCamera(const GridCamera& camera) {
    if (camera.projection != Projection::Perspective)
        return invalid("expected a perspective camera (an eye point), found an orthographic one");
    // GridTransform states what a sound camera is.
    if (auto sound = GridTransform::camera(camera, {1, 1, 1}); !sound)
        return invalid(sound.error().text);
    return {};
}

} // namespace

Result<EpipolarTransform> EpipolarTransform::around(const glm::dvec3& eye,
                                                    const EpipolarLight& light,
                                                    const glm::uvec3& size) {
    if (size.x == 0 || size.y == 0 || size.z == 0)
        return invalid("expected at least one voxel along alpha, theta and phi, found " +
                       std::to_string(size.x) + " x " + std::to_string(size.y) + " x " +
                       std::to_string(size.z));
    if (!isFinite(eye))
        return invalid("expected a finite eye position");
    if (light.kind > LightKind::Directional)
        return invalid("expected a point, spot or directional light, found LightKind value " +
                       std::to_string(static_cast<int>(light.kind)));
    if (light.kind != LightKind::Point &&
        !(isFinite(light.direction) && glm::length(light.direction) > 0.0))
        return invalid("expected a finite light direction of some length, found none");
    if (light.kind == LightKind::Spot && !(light.coneAngle > 0.0 && light.coneAngle < kPi))
        return invalid("expected a cone angle in (0, pi), found " +
                       std::to_string(light.coneAngle));

    EpipolarTransform transform;
    transform.mSize = size;
    transform.mLight = light;
    transform.mEye = eye;
    glm::dvec3 toLight = -light.direction;
    if (light.kind != LightKind::Directional) {
        if (!isFinite(light.position))
            return invalid("expected a finite light position");
        toLight = light.position - eye;
        transform.mLightDistance = glm::length(toLight);
        const double magnitude = std::max(glm::length(eye), glm::length(light.position));
        if (!(transform.mLightDistance > magnitude * 1e-12))
            return invalid("expected the light away from the eye, found both in one place; move "
                           "one of them, or shade without shadows there");
    }
    transform.mAxis = glm::normalize(toLight);
    return transform;
}

void EpipolarTransform::setThetaZero(const glm::dvec3& direction) {
    glm::dvec3 u = direction - glm::dot(direction, mAxis) * mAxis;
    if (!(glm::length(u) > 1e-9 * glm::length(direction))) {
        const glm::dvec3 other =
            std::abs(mAxis.x) < 0.5 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0);
        u = other - glm::dot(other, mAxis) * mAxis;
    }
    mU = glm::normalize(u);
    mV = glm::cross(mAxis, mU);
}

double EpipolarTransform::phiAt(double alpha, double distance) const {
    const double across = distance * std::sin(alpha);
    return isDirectional() ? across
                           : std::atan2(across, mLightDistance - distance * std::cos(alpha));
}

Result<EpipolarTransform> EpipolarTransform::fit(const GridCamera& camera,
                                                 const EpipolarLight& light,
                                                 const glm::uvec3& size) {
    if (auto sound = checkCamera(camera); !sound)
        return sound.error();
    const ViewPyramid pyramid = makePyramid(camera);
    auto created = around(pyramid.eye, light, size);
    if (!created)
        return created;
    EpipolarTransform& transform = *created;
    transform.setThetaZero(pyramid.center);
    EpipolarRanges& ranges = transform.mRanges;
    ranges.thetaZero = pyramid.center;
    ranges.farDistance = pyramid.farDistance;
    // What lies on the far plane near the axis may be no farther than the plane itself.
    constexpr double kSlack = 1.0 - 1e-5;
    ranges.skyDistance = camera.far * kSlack;

    const glm::dvec3& axis = transform.mAxis;
    ranges.alpha = widened({leastAngle(pyramid, axis), kPi - leastAngle(pyramid, -axis)},
                           kLeastRange, 0.0, kPi);
    // Seen along the axis the pyramid is a wedge, and its edges bound it, unless it holds the axis.
    if (!contains(pyramid, axis) && !contains(pyramid, -axis)) {
        glm::dvec2 theta{kPi, -kPi};
        for (const glm::dvec3& edge : pyramid.edges) {
            const double angle =
                std::atan2(glm::dot(edge, transform.mV), glm::dot(edge, transform.mU));
            theta = {std::min(theta.x, angle), std::max(theta.y, angle)};
        }
        ranges.theta = widened(theta, kLeastRange, -kPi, kPi);
    }

    // At a fixed distance phi has one maximum over alpha, so its minimum is at an end of the range.
    const double far = pyramid.farDistance;
    double peak = transform.isDirectional() ? 0.5 * kPi : 0.0;
    if (!transform.isDirectional() && far < transform.mLightDistance)
        peak = std::acos(far / transform.mLightDistance);
    const double near = pyramid.nearDistance;
    const double least =
        std::min(transform.phiAt(ranges.alpha.x, near), transform.phiAt(ranges.alpha.y, near));
    const double most = transform.phiAt(std::clamp(peak, ranges.alpha.x, ranges.alpha.y), far);
    const double limit = transform.isDirectional() ? std::numeric_limits<double>::max() : kPi;
    const double narrowest = transform.isDirectional() ? kLeastRange * far : kLeastRange;
    ranges.phi = widened({least, most}, narrowest, 0.0, limit);
    return created;
}

Result<EpipolarTransform> EpipolarTransform::create(const glm::dvec3& eye,
                                                    const EpipolarLight& light,
                                                    const EpipolarRanges& ranges,
                                                    const glm::uvec3& size) {
    auto created = around(eye, light, size);
    if (!created)
        return created;
    constexpr double kSlack = 1e-9;
    const auto isWithin = [](const glm::dvec2& range, double low, double high) {
        return range.x >= low - kSlack && range.y <= high + kSlack && range.x < range.y;
    };
    const double phiLimit = created->isDirectional() ? std::numeric_limits<double>::max() : kPi;
    if (!isWithin(ranges.alpha, 0.0, kPi) || !isWithin(ranges.theta, -kPi, kPi) ||
        !isWithin(ranges.phi, 0.0, phiLimit))
        return invalid("expected increasing ranges of alpha in [0, pi], theta in [-pi, pi] and phi "
                       "in [0, pi] (from 0 for a directional light), found another");
    if (!(std::isfinite(ranges.farDistance) && ranges.farDistance > 0.0))
        return invalid("expected a finite far distance above 0, found " +
                       std::to_string(ranges.farDistance));
    if (!isFinite(ranges.thetaZero))
        return invalid("expected a finite thetaZero");
    created->mRanges = ranges;
    created->setThetaZero(ranges.thetaZero);
    return created;
}

bool EpipolarTransform::isFullCircle() const {
    return mRanges.theta.y - mRanges.theta.x > 2.0 * kPi - 1e-9;
}

glm::dvec3 EpipolarTransform::scale() const {
    return glm::dvec3(mSize) / glm::dvec3(mRanges.alpha.y - mRanges.alpha.x,
                                          mRanges.theta.y - mRanges.theta.x,
                                          mRanges.phi.y - mRanges.phi.x);
}

glm::dvec3 EpipolarTransform::worldToVoxel(const glm::dvec3& world) const {
    const glm::dvec3 point = world - mEye;
    const double along = glm::dot(point, mAxis);
    const glm::dvec2 across(glm::dot(point, mU), glm::dot(point, mV));
    const double distance = glm::length(across);
    const double phi = isDirectional() ? distance : std::atan2(distance, mLightDistance - along);
    const glm::dvec3 angles(std::atan2(distance, along),
                            distance > 0.0 ? std::atan2(across.y, across.x) : 0.0, phi);
    return (angles - origin()) * scale();
}

glm::dvec3 EpipolarTransform::voxelToWorld(const glm::dvec3& voxel) const {
    const glm::dvec3 angles = origin() + voxel / scale();
    // The law of sines in the triangle of eye, light and point.
    const double distance =
        isDirectional() ? angles.z / std::sin(angles.x)
                        : mLightDistance * std::sin(angles.z) / std::sin(angles.x + angles.z);
    const glm::dvec3 around = std::cos(angles.y) * mU + std::sin(angles.y) * mV;
    return mEye + distance * (std::cos(angles.x) * mAxis + std::sin(angles.x) * around);
}

std::string EpipolarTransform::describe() const {
    return std::to_string(mSize.x) + " x " + std::to_string(mSize.y) + " x " +
           std::to_string(mSize.z) + " epipolar";
}

} // namespace lamina
