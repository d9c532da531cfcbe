#pragma once

#include <glm/vec4.hpp>

#include <cstdint>

namespace lamina {

/// Which triangles of a material are voxelized, by how they face the grid's camera. The front is
/// where a triangle's corners turn counter-clockwise in world space.
enum class OrientationRule : std::uint8_t { TwoSided, FrontFaces, BackFaces };

/// What a surface is made of. A GeometrySource's material id is an index into a table of these.
struct Material {
    glm::vec4 color{1.0f};        ///< RGBA in [0,1]; multiplied by the vertices' colours.
    float absorption = 1.0f;      ///< Light taken by one hit, >= 0; sums up in a voxel ([CLN11] 3).
    std::uint32_t colorClass = 0; ///< Which of several slicemaps takes it (leaf colours).
    float refractiveIndex = 1.0f; ///< Of the inside, >= 1.
    float transmission = 1.0f;    ///< Share of light left after one world unit inside, in [0,1].
    OrientationRule orientation = OrientationRule::TwoSided;
};

} // namespace lamina
