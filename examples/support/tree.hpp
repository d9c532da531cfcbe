#pragma once

#include <lamina/core/triangle_mesh.hpp>

#include <cstdint>

namespace example {

/// A broad-leaved tree at the origin, y up, about 6 units high.
struct Tree {
    lamina::TriangleMesh wood;   ///< Closed tubes.
    lamina::TriangleMesh leaves; ///< Two triangles each, folded along the middle.
};

[[nodiscard]] Tree makeTree(std::uint32_t seed);

} // namespace example
