#pragma once

#include <lamina/core/triangle_mesh.hpp>

#include <cstdint>

namespace example {

/// A broad-leaved tree at the origin, y up, about 6 units high.
struct Tree {
    lamina::TriangleMesh wood;   ///< Closed tubes.
    lamina::TriangleMesh leaves; ///< Two triangles each, folded along the middle.
};

struct TreeDesc {
    std::uint32_t seed = 5;
    int leavesPerTwig = 34;  ///< 960 triangles of leaves for each.
    float leafLength = 0.2f; ///< Of the longest, world units.
};

[[nodiscard]] Tree makeTree(const TreeDesc& desc);

[[nodiscard]] inline Tree makeTree(std::uint32_t seed) {
    return makeTree(TreeDesc{.seed = seed});
}

/// A tree in full leaf: 163,200 leaf triangles, as many as the chestnut of [ED06] has.
[[nodiscard]] inline Tree makeChestnut() {
    return makeTree(TreeDesc{.leavesPerTwig = 170, .leafLength = 0.13f});
}

} // namespace example
