#include "voxelize/epipolar_depth_maps.hpp"

#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include <algorithm>
#include <cmath>

namespace lamina {
namespace {

constexpr double kPi = std::numbers::pi;

/// A window in the plane through the light's frame axes u and v.
struct Window {
    glm::dvec2 low{-1.0};
    glm::dvec2 high{1.0};
};

/// The box around the part of the disc of this radius that lies within a range of theta.
Window boundSector(const glm::dvec2& theta, const glm::dvec2& radius) {
    Window window{glm::dvec2(radius.y), glm::dvec2(-radius.y)};
    const auto extend = [&](double angle) {
        for (const double r : {radius.x, radius.y}) {
            const glm::dvec2 point = r * glm::dvec2(std::cos(angle), std::sin(angle));
            window.low = glm::min(window.low, point);
            window.high = glm::max(window.high, point);
        }
    };
    extend(theta.x);
    extend(theta.y);
    for (int quarter = -2; quarter <= 2; ++quarter) {
        const double angle = quarter * 0.5 * kPi;
        if (angle > theta.x && angle < theta.y)
            extend(angle);
    }
    // A sliver of a window would make every texel one.
    const glm::dvec2 least(1e-6 * radius.y);
    const glm::dvec2 middle = 0.5 * (window.low + window.high);
    const glm::dvec2 half = glm::max(0.5 * (window.high - window.low), least);
    return {middle - half, middle + half};
}

/// World to the light's frame: u, v and the axis (directional) or the way to the eye (others).
glm::dmat4 worldToFrame(const EpipolarTransform& transform) {
    const bool isDirectional = transform.isDirectional();
    const glm::dvec3 third = isDirectional ? transform.axis() : -transform.axis();
    const glm::dvec3 origin = isDirectional
                                  ? transform.eye()
                                  : transform.eye() + transform.lightDistance() * transform.axis();
    glm::dmat4 frame(1.0);
    const glm::dvec3 rows[] = {transform.u(), transform.v(), third};
    for (int row = 0; row < 3; ++row) {
        for (int column = 0; column < 3; ++column)
            frame[column][row] = rows[row][column];
        frame[3][row] = -glm::dot(rows[row], origin);
    }
    return frame;
}

/// Frame to (s, t, depth) of a cube face; the shader's toFace().
glm::dmat4 frameToFace(int face) {
    constexpr int kAxes[6][3] = {{0, 1, 2}, {1, 2, 0}, {1, 2, 0}, {0, 2, 1}, {0, 2, 1}, {0, 1, 2}};
    const bool isNegative = face == LAMINA_EPIPOLAR_FACE_MINUS_U ||
                            face == LAMINA_EPIPOLAR_FACE_MINUS_V ||
                            face == LAMINA_EPIPOLAR_FACE_BACK;
    glm::dmat4 matrix(0.0);
    for (int row = 0; row < 3; ++row)
        matrix[kAxes[face][row]][row] = row == 2 && isNegative ? -1.0 : 1.0;
    matrix[3][3] = 1.0;
    return matrix;
}

/// (s, t, depth) to clip space with depth near / distance: reversed, without a far plane.
glm::dmat4 perspective(const Window& window, double near) {
    const glm::dvec2 size = window.high - window.low;
    const glm::dvec2 sum = window.high + window.low;
    glm::dmat4 matrix(0.0);
    matrix[0][0] = 2.0 / size.x;
    matrix[1][1] = 2.0 / size.y;
    matrix[2] = {-sum.x / size.x, -sum.y / size.y, 0.0, 1.0};
    matrix[3][2] = near;
    return matrix;
}

/// (u, v, along the axis) to clip space; `low` to depth 0, `low + range` to 1.
glm::dmat4 orthographic(const Window& window, double low, double range) {
    const glm::dvec2 size = window.high - window.low;
    const glm::dvec2 sum = window.high + window.low;
    glm::dmat4 matrix(0.0);
    matrix[0][0] = 2.0 / size.x;
    matrix[1][1] = 2.0 / size.y;
    matrix[2][2] = 1.0 / range;
    matrix[3] = {-sum.x / size.x, -sum.y / size.y, -low / range, 1.0};
    return matrix;
}

glm::vec4 windowConstants(const Window& window, double texels) {
    const glm::dvec2 perUnit = texels / (window.high - window.low);
    return glm::vec4(glm::dvec4(window.low, perUnit));
}

void planDirectional(const EpipolarTransform& transform, double texels, DepthMapPlan& plan) {
    const EpipolarRanges& ranges = transform.ranges();
    const Window window = boundSector(ranges.theta, ranges.phi);
    // What lies beyond all visible points casts no visible shadow; what lies before is clamped.
    const double far = ranges.farDistance;
    const double low = std::min(0.0, far * std::cos(ranges.alpha.y)) - 1e-3 * far;
    const double high = std::max(0.0, far * std::cos(ranges.alpha.x)) + 1e-3 * far;
    plan.faces.push_back({orthographic(window, low, high - low) * worldToFrame(transform), true});
    plan.map.window = windowConstants(window, texels);
    plan.map.depth = glm::vec4(low, high - low, texels, 0.0);
    plan.map.layers = {0, -1, -1, -1};
    plan.map.layersAndSpace = {-1, -1, plan.map.layersAndSpace.z, 0};
}

/// Does the volume's range of theta meet the side face whose middle has this theta?
bool meetsSide(const glm::dvec2& theta, double middle) {
    constexpr double kHalf = 0.25 * kPi + 1e-6;
    for (const double turn : {-2.0 * kPi, 0.0, 2.0 * kPi})
        if (theta.x <= middle + turn + kHalf && theta.y >= middle + turn - kHalf)
            return true;
    return false;
}

void planPerspective(const EpipolarTransform& transform, const EpipolarVoxelizerDesc& desc,
                     DepthMapPlan& plan) {
    const EpipolarRanges& ranges = transform.ranges();
    const double texels = desc.depthMapTexels;
    const double near = desc.nearShare * transform.lightDistance();
    // Side faces begin 45 degrees from the middle of the front face; its corners reach this far.
    constexpr double kSlack = 1e-6;
    constexpr double kSideAngle = 0.25 * kPi - kSlack;
    const double cornerAngle = std::atan(std::numbers::sqrt2) + kSlack;
    Window front;
    if (ranges.phi.y < kSideAngle)
        front = boundSector(ranges.theta, {std::tan(ranges.phi.x), std::tan(ranges.phi.y)});
    const bool meetsSides = ranges.phi.y > kSideAngle && ranges.phi.x < kPi - kSideAngle;
    const bool isNeeded[6] = {ranges.phi.x < cornerAngle,
                              meetsSides && meetsSide(ranges.theta, 0.0),
                              meetsSides && meetsSide(ranges.theta, kPi),
                              meetsSides && meetsSide(ranges.theta, 0.5 * kPi),
                              meetsSides && meetsSide(ranges.theta, -0.5 * kPi),
                              ranges.phi.y > kPi - cornerAngle};
    int layers[6];
    const glm::dmat4 frame = worldToFrame(transform);
    for (int face = 0; face < 6; ++face) {
        layers[face] = isNeeded[face] ? static_cast<int>(plan.faces.size()) : -1;
        if (!isNeeded[face])
            continue;
        const Window window = face == LAMINA_EPIPOLAR_FACE_FRONT ? front : Window{};
        plan.faces.push_back({perspective(window, near) * frameToFace(face) * frame, false});
    }
    plan.map.window = windowConstants(front, texels);
    plan.map.depth = glm::vec4(near, 0.0, texels, 0.0);
    plan.map.layers = {layers[0], layers[1], layers[2], layers[3]};
    plan.map.layersAndSpace = {layers[4], layers[5], plan.map.layersAndSpace.z, 0};
}

} // namespace

void setLight(shared::LaminaEpipolarMap& map, const EpipolarTransform& transform,
              std::uint32_t vsv) {
    constexpr float kNoCone = -2.0f;
    map.spot = {0.0f, 0.0f, 0.0f, kNoCone};
    const EpipolarLight& light = transform.light();
    if (light.kind == LightKind::Spot) {
        const glm::dvec3 direction = glm::normalize(light.direction);
        map.spot = glm::vec4(
            glm::dvec4(glm::dot(direction, transform.u()), glm::dot(direction, transform.v()),
                       -glm::dot(direction, transform.axis()), std::cos(light.coneAngle)));
    }
    map.layersAndSpace.z = static_cast<int>(vsv);
}

DepthMapPlan planDepthMaps(const EpipolarTransform& transform, const EpipolarVoxelizerDesc& desc,
                           std::uint32_t vsv) {
    DepthMapPlan plan;
    setLight(plan.map, transform, vsv);
    if (transform.isDirectional())
        planDirectional(transform, desc.depthMapTexels, plan);
    else
        planPerspective(transform, desc, plan);
    return plan;
}

} // namespace lamina
