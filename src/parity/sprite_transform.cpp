#include <lamina/parity/sprite_transform.hpp>

#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

namespace lamina {
namespace {

constexpr std::uint32_t kLeastResolution = 4;

/// Rows: right, up, back of a camera that looks along `direction`; exact for the axes.
glm::dmat3 cameraRows(const glm::dvec3& direction) {
    const glm::dvec3 back = -glm::normalize(direction);
    const glm::dvec3 size = glm::abs(back);
    glm::dvec3 helper(0.0);
    helper[size.x <= size.y && size.x <= size.z ? 0 : size.y <= size.z ? 1 : 2] = 1.0;
    const glm::dvec3 right = glm::normalize(glm::cross(helper, back));
    return glm::transpose(glm::dmat3(right, glm::cross(back, right), back));
}

/// Half the size, along `row`, of a box of half size `half`.
double reach(const glm::dvec3& row, const glm::dvec3& half) {
    return glm::dot(glm::abs(row), half);
}

} // namespace

Result<GridTransform> fitSprite(const Box3& bounds, const glm::dvec3& direction,
                                std::uint32_t resolution, std::uint32_t slices) {
    const auto invalid = [](const std::string& text) {
        return Error{ErrorCode::InvalidArgument, "fit of a depth sprite: expected " + text};
    };
    const double length = glm::length(direction);
    if (!(std::isfinite(length) && length > 0.0))
        return invalid("a finite direction that is not zero");
    if (resolution < kLeastResolution)
        return invalid("at least " + std::to_string(kLeastResolution) + " columns, found " +
                       std::to_string(resolution));
    if (bounds.isEmpty() || !(glm::length(bounds.size()) > 0.0) ||
        !std::isfinite(glm::length(bounds.size())))
        return invalid("a finite box with a size, found an empty one or a point");

    const glm::dmat3 rows = glm::transpose(cameraRows(direction / length));
    const glm::dvec3 half = 0.5 * bounds.size();
    const glm::dvec3 eyeHalf(reach(rows[0], half), reach(rows[1], half), reach(rows[2], half));
    const double side = std::max(eyeHalf.x, eyeHalf.y);
    const double inner = resolution - 2.0;
    const double column = 2.0 * (side > 0.0 ? side : eyeHalf.z) / inner;
    const auto columnsFor = [&](double extent) {
        // The ratio is exact for the longer side, and rounding must not add a column to it.
        const double needed = std::ceil(2.0 * extent / column - 1e-9);
        return static_cast<std::uint32_t>(std::clamp(needed, 1.0, inner)) + 2;
    };
    const glm::uvec3 size(columnsFor(eyeHalf.x), columnsFor(eyeHalf.y), slices);

    const glm::dvec3 center = bounds.center();
    GridCamera camera;
    camera.worldToEye = glm::dmat4(glm::transpose(rows));
    const glm::dvec3 eyeCenter(glm::dot(rows[0], center), glm::dot(rows[1], center),
                               glm::dot(rows[2], center));
    camera.left = eyeCenter.x - 0.5 * size.x * column;
    camera.right = eyeCenter.x + 0.5 * size.x * column;
    camera.bottom = eyeCenter.y - 0.5 * size.y * column;
    camera.top = eyeCenter.y + 0.5 * size.y * column;
    camera.near = -eyeCenter.z - eyeHalf.z - column;
    camera.far = -eyeCenter.z + eyeHalf.z + column;
    return GridTransform::camera(camera, size);
}

std::span<const glm::dvec3> spriteDirections() {
    static const auto directions = [] {
        std::array<glm::dvec3, 13> all = {{{0, 0, 1},
                                           {0, 1, 0},
                                           {1, 0, 0},
                                           {1, 1, 0},
                                           {1, -1, 0},
                                           {1, 0, 1},
                                           {1, 0, -1},
                                           {0, 1, 1},
                                           {0, 1, -1},
                                           {1, 1, 1},
                                           {1, 1, -1},
                                           {1, -1, 1},
                                           {1, -1, -1}}};
        for (glm::dvec3& direction : all)
            direction = glm::normalize(direction);
        return all;
    }();
    return directions;
}

std::span<const glm::dvec3> spriteAxes() {
    static constexpr glm::dvec3 kAxes[] = {{0, 0, 1}, {1, 0, 0}, {0, 1, 0}};
    return kAxes;
}

} // namespace lamina
