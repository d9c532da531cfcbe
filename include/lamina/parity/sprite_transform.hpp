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
/// Shaders place points in single precision: keep shapes and points near the origin of the space
/// they share, since far from it the seven digits are spent before columns are told apart.
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

/// The three axes z, x, y. Sprites of one shape along them, asked together
/// (laminaParityInsideRefined(), PointQuery::directions = 3), are what accuracy needs: of a million
/// random points in a shape's bounds at most 1 % are wrong with 128 columns and 0.1 % with 1024, on
/// every shape tried; the plain test of one sprite is wrong on up to 2.3 % and 0.35 %, at walls
/// parallel to its axis. Cost: three sprites to build and hold; a point asks four columns of the
/// first sprite, and of the others only near a wall.
[[nodiscard]] LAMINA_API std::span<const glm::dvec3> spriteAxes();

} // namespace lamina
