#include "grid/grid_constants.hpp"

#include <glm/matrix.hpp>

#include <algorithm>

namespace lamina {

std::uint32_t gridFlags(const GridTransform& transform) {
    std::uint32_t flags = 0;
    if (transform.projection() == Projection::Perspective)
        flags |= LAMINA_GRID_PERSPECTIVE;
    if (!transform.sliceBoundaries().empty())
        flags |= LAMINA_GRID_CUSTOM_SLICES;
    return flags;
}

GridBlock makeGridBlock(const GridTransform& transform, bool hasLocalRanges) {
    GridBlock block;
    const glm::dmat4 rows = glm::transpose(transform.worldToColumn());
    for (int row = 0; row < 3; ++row)
        block.constants.worldToColumn[row] = glm::vec4(rows[row]);
    const double near = transform.nearDepth();
    const double far = transform.farDepth();
    block.constants.depthRange =
        glm::vec4(glm::dvec4(near, far, 1.0 / (far - near), transform.size().z));
    block.constants.size = glm::uvec4(
        transform.size(), gridFlags(transform) | (hasLocalRanges ? LAMINA_GRID_LOCAL : 0));
    std::ranges::copy(transform.sliceBoundaries(), block.boundaries.begin());
    return block;
}

} // namespace lamina
