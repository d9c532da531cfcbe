#pragma once

#include <lamina/core/box.hpp>
#include <lamina/core/export.hpp>
#include <lamina/core/result.hpp>
#include <lamina/grid/grid_transform.hpp>

#include <glm/vec3.hpp>

#include <cstdint>
#include <span>

namespace lamina {

/// The place of a depth sprite around a box: an orthographic grid whose columns run along
/// `direction`, square in cross-section, with a margin of a column on all sides, so that what lies
/// in the box reaches no side of the sprite. Any other orthographic GridTransform serves as well:
/// slices and their distribution only matter to SpriteLayers::voxels().
/// bounds: world (or the shape's own space), not empty; direction: any length, not zero;
/// resolution: columns along the longer side of the cross-section, at least 4.
/// Errors: InvalidArgument.
[[nodiscard]] LAMINA_API Result<GridTransform> fitSprite(const Box3& bounds,
                                                         const glm::dvec3& direction,
                                                         std::uint32_t resolution,
                                                         std::uint32_t slices = 128);

/// Unit directions that SpriteBuilder::downloadBestDirection() tries unless told otherwise: the
/// axes, the diagonals of the faces and of the corners of a cube; one of each opposite pair.
[[nodiscard]] LAMINA_API std::span<const glm::dvec3> spriteDirections();

} // namespace lamina
