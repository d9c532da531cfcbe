#pragma once

#include "engine_mesh.hpp"

#include <lamina/core/triangle_mesh.hpp>
#include <lamina/gl/view.hpp>
#include <lamina/grid_io/image.hpp>

#include <glm/mat4x4.hpp>

#include <cstdint>
#include <string>
#include <vector>

namespace example {

/// Normals of the vertices: the mean of their triangles', by area.
void addNormals(lamina::TriangleMesh& mesh);

/// What the engine draws of a frame of meshes with normals: an HDR picture with the sky, and the
/// G-buffer of the objects that refract. Textures of view.size.
struct Stage {
    lamina::View view;
    glm::dvec3 eye{0.0};
    GLuint color = 0, colorDepth = 0;           ///< What lies behind.
    GLuint depth = 0, normals = 0, objects = 0; ///< Of the objects.
    GLuint colorFrame = 0, objectFrame = 0;
};

/// A camera at `eye` that looks at `target`; field of view in degrees, upright.
[[nodiscard]] Stage makeStage(const HostGl& gl, const glm::uvec2& size, const glm::dvec3& eye,
                              const glm::dvec3& target, double fieldOfView);

/// Paints the environment (a cube map) over the picture and clears the G-buffer.
void beginStage(const HostGl& gl, const Stage& stage, GLuint environment);
/// An opaque, lit mesh in the picture.
void drawOpaque(const HostGl& gl, const Stage& stage, const EngineMesh& mesh,
                const glm::mat4& model, const glm::vec3& albedo);
/// An object of the G-buffer. vertexStage: GLSL that moves a vertex: `void deform(inout vec3
/// position, inout vec3 normal)`; empty: by `model`.
void drawObject(const HostGl& gl, const Stage& stage, const EngineMesh& mesh,
                const glm::mat4& model, std::uint32_t object, const std::string& vertexStage = {},
                float time = 0.0f);

/// A linear HDR texture as a picture, 2 x 2 pixels averaged to one.
[[nodiscard]] lamina::Image develop(const HostGl& gl, const Stage& stage, GLuint color);

/// Pictures of one height side by side.
[[nodiscard]] lamina::Image sideBySide(const std::vector<lamina::Image>& images);

} // namespace example
