#pragma once

#include <lamina/core/box.hpp>

#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>

#include <cmath>

/// Is no component a NaN or an infinity?
namespace lamina::detail {

template<glm::length_t kCount, class Value, glm::qualifier kQualifier>
[[nodiscard]] bool isFinite(const glm::vec<kCount, Value, kQualifier>& vector) {
    for (glm::length_t i = 0; i < kCount; ++i)
        if (!std::isfinite(vector[i]))
            return false;
    return true;
}

template<glm::length_t kColumns, glm::length_t kRows, class Value, glm::qualifier kQualifier>
[[nodiscard]] bool isFinite(const glm::mat<kColumns, kRows, Value, kQualifier>& matrix) {
    for (glm::length_t column = 0; column < kColumns; ++column)
        if (!isFinite(matrix[column]))
            return false;
    return true;
}

[[nodiscard]] inline bool isFinite(const Box3& box) {
    return isFinite(box.min) && isFinite(box.max);
}

} // namespace lamina::detail
