#pragma once

#include <glm/mat4x4.hpp>
#include <glm/vec2.hpp>

#include <cstdint>

namespace lamina {

enum class DepthMapKind : std::uint8_t { Texture2D, TextureArray, TextureCube };

/// A light's depth map in the host's own texture (a depth format, or a float one that holds window
/// depths in red). Borrowed for the call; its filter, wrap and compare modes do not matter.
struct LightDepthMap {
    std::uint32_t texture = 0; ///< GL name.
    DepthMapKind kind = DepthMapKind::Texture2D;
    std::uint32_t layer = 0; ///< TextureArray alone.
    /// The part of the texture to use (2D and array), texels: many maps may share a texture.
    glm::uvec2 firstTexel{0};
    glm::uvec2 size{0}; ///< 0 x 0: the whole texture.

    /// 2D and array: the light's projection * view, as the map was drawn. The centre of projection
    /// is the light; for a directional light, projection lines are parallel to it.
    glm::dmat4 worldToClip{1.0};
    /// Cube: the projection that all six faces were drawn with: a right angle, centred, faces along
    /// the world axes as GL names them.
    glm::dmat4 faceProjection{1.0};
    bool zeroToOneDepth = false; ///< glClipControl(..., GL_ZERO_TO_ONE) when the map was drawn.
    float emptyDepth = 1.0f;     ///< Depth where nothing was drawn (0 for reversed depth).
};

} // namespace lamina
