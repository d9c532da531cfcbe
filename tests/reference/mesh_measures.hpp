#pragma once

#include <lamina/core/triangle_mesh.hpp>

namespace lamina::reference {

/// Volume inside a closed mesh, world units cubed; negative if it is oriented inward.
[[nodiscard]] double signedVolume(const TriangleMesh& mesh);

/// Sum of the triangles' areas, world units squared.
[[nodiscard]] double surfaceArea(const TriangleMesh& mesh);

/// Does every directed edge (by vertex index) occur as often as its opposite? True for closed,
/// consistently oriented meshes.
[[nodiscard]] bool isWatertight(const TriangleMesh& mesh);

} // namespace lamina::reference
