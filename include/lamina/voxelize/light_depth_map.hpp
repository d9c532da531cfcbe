#pragma once

#include <glm/mat3x3.hpp>
#include <glm/mat4x4.hpp>
#include <glm/vec2.hpp>

#include <cstdint>

namespace lamina {

enum class DepthMapKind : std::uint8_t {
    Texture2D,
    TextureArray,
    TextureCube,
    /// A layer of a 2D array that maps half the directions from the light to a square, an
    /// octahedron's upper half turned by 45 degrees, and holds distances to the light.
    HemisphereArray,
};

/// A light's depth map in the host's own texture (a depth format, or a float one that holds window
/// depths in red). Borrowed for the call; its filter, wrap and compare modes do not matter.
struct LightDepthMap {
    std::uint32_t texture = 0; ///< GL name.
    DepthMapKind kind = DepthMapKind::Texture2D;
    std::uint32_t layer = 0; ///< Of arrays alone.
    /// The part of the texture to use (all but cube), texels: many maps may share a texture.
    glm::uvec2 firstTexel{0};
    glm::uvec2 size{0}; ///< 0 x 0: the whole texture.

    /// 2D and array: the light's projection * view, as the map was drawn. The centre of projection
    /// is the light; for a directional light, projection lines are parallel to it.
    glm::dmat4 worldToClip{1.0};
    /// Cube: the projection that all six faces were drawn with: a right angle, centred, faces along
    /// the world axes as GL names them.
    glm::dmat4 faceProjection{1.0};
    /// Hemisphere: rotation from world axes to the map's (s, t, middle): the direction d of the
    /// light's rays is seen at ((x + y), (x - y)) of (x, y) = (d_s, d_t) / (|d_s| + |d_t| + d_m),
    /// from -1 to 1 over the map. Rays with d_m <= 0 are lit.
    glm::dmat3 worldToHemisphere{1.0};
    bool zeroToOneDepth = false; ///< glClipControl(..., GL_ZERO_TO_ONE) when the map was drawn.
    float emptyDepth = 1.0f;     ///< Depth where nothing was drawn (0 for reversed depth).
};

} // namespace lamina
