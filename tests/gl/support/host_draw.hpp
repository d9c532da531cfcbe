#pragma once

#include "gl/device_state.hpp"

#include <lamina/gl/device.hpp>
#include <lamina/voxelize/geometry_source.hpp>

#include <glm/mat4x4.hpp>
#include <glm/vec4.hpp>

#include <span>
#include <vector>

/// A host that draws meshes with programs of its own into textures of its own.
namespace lamina::test {

/// Vertex stage: attribute 0 is a world position, handed on as `world`; uniform 0 is worldToClip.
extern const char* const kWorldVertexShader;

[[nodiscard]] gl::Texture makeTexture(const Device& device, GLenum format, const glm::uvec2& size);

/// A framebuffer of a depth texture (0: none) and colour outputs 0, 1, ...
[[nodiscard]] gl::Framebuffer makeFramebuffer(const Device& device, GLuint depth,
                                              std::span<const GLuint> colors);

/// A vertex array whose attribute 0 holds the positions of a mesh, and its indices.
[[nodiscard]] gl::VertexArray makeVertexArray(const Device& device, const MeshView& mesh);

/// Draws a mesh of 32-bit indices, nearest first, depth cleared to 1. Leaves the default bindings
/// behind.
void drawMesh(const Device& device, GLuint program, GLuint framebuffer, const glm::uvec2& size,
              const glm::dmat4& worldToClip, const MeshView& mesh);

/// Texels of a 2D texture of that size.
[[nodiscard]] std::vector<glm::vec4> readPixels(const Device& device, GLuint texture,
                                                const glm::uvec2& size);

} // namespace lamina::test
