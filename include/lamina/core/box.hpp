#pragma once

#include <glm/vec3.hpp>

#include <limits>

namespace lamina {

/// An axis-aligned box in world units. Default: empty (min > max), ready for extend().
struct Box3 {
    glm::dvec3 min{std::numeric_limits<double>::infinity()};
    glm::dvec3 max{-std::numeric_limits<double>::infinity()};

    void extend(const glm::dvec3& point) {
        for (int axis = 0; axis < 3; ++axis) {
            min[axis] = point[axis] < min[axis] ? point[axis] : min[axis];
            max[axis] = point[axis] > max[axis] ? point[axis] : max[axis];
        }
    }
    [[nodiscard]] bool isEmpty() const {
        return !(min.x <= max.x && min.y <= max.y && min.z <= max.z);
    }
    [[nodiscard]] glm::dvec3 size() const { return max - min; }
    [[nodiscard]] glm::dvec3 center() const { return 0.5 * (min + max); }
};

} // namespace lamina
