#pragma once

#include "mesh_io/index_table.hpp"

#include <glm/vec3.hpp>

#include <cstdint>
#include <vector>

namespace lamina::detail {

/// Gives equal positions one index. Positions are equal if their bits are; -0 counts as 0.
class VertexWelder {
public:
    /// The index of `position`; new positions get the next one.
    [[nodiscard]] std::uint32_t add(const glm::vec3& position);

    [[nodiscard]] const std::vector<glm::vec3>& positions() const { return mPositions; }
    [[nodiscard]] std::vector<glm::vec3> takePositions() { return std::move(mPositions); }

private:
    IndexTable mTable;
    std::vector<glm::vec3> mPositions;
};

} // namespace lamina::detail
