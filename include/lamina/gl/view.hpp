#pragma once

#include <lamina/core/export.hpp>
#include <lamina/core/result.hpp>

#include <glm/mat4x4.hpp>
#include <glm/vec2.hpp>

#include <cstdint>

namespace lamina {

/// The depths that clip space spans, as glClipControl names them.
enum class ClipDepth : std::uint8_t {
    NegativeOneToOne, ///< OpenGL's default.
    ZeroToOne,
};

/// The engine's camera of one frame, and what its depth buffer means: all that an effect needs to
/// find the world point of a pixel. Any projection with an inverse: orthographic or perspective,
/// infinite or reversed depth, oblique near planes.
struct View {
    /// From world space to clip space.
    glm::dmat4 worldToClip{1.0};
    /// Pixels of the depth buffer in x and y.
    glm::uvec2 size{0};
    ClipDepth clipDepth = ClipDepth::NegativeOneToOne;
    /// Depths in the buffer of clip space's two ends (glDepthRange).
    glm::dvec2 depthRange{0.0, 1.0};
    /// The depth to which the engine clears: pixels that hold it show no surface. 0 with reversed
    /// depth.
    float backgroundDepth = 1.0f;
};

/// Where a view looks from: the eye of a perspective view; for an orthographic one the direction
/// towards the viewer, w = 0. World space.
/// Errors: InvalidArgument (a matrix that is not finite or has no inverse, a size of 0, an empty
/// depth range).
[[nodiscard]] LAMINA_API Result<glm::dvec4> viewpoint(const View& view);

} // namespace lamina
