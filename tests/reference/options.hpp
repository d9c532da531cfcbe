#pragma once

#include <glm/mat4x4.hpp>

namespace lamina::reference {

/// What every reference takes besides the mesh and the grid.
struct Options {
    glm::dmat4 model{1.0}; ///< Mesh to world; affine.
    /// Voxels are grown by this much on every side (in columns and slices); negative shrinks.
    /// A device result is proved by two sets: all of grow = -e set, nothing outside grow = +e set.
    /// Each reference says whether it honours this.
    double grow = 0.0;
};

} // namespace lamina::reference
