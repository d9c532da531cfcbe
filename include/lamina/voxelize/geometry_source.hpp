#pragma once

#include <lamina/core/export.hpp>
#include <lamina/core/result.hpp>
#include <lamina/core/triangle_mesh.hpp>
#include <lamina/gl/device.hpp>

#include <glm/mat4x4.hpp>

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <variant>

namespace lamina {

enum class IndexType : std::uint8_t { None, UInt16, UInt32 };

/// One more attribute of a MeshView's vertices; needed by backends that record it.
struct VertexStream {
    std::uint32_t buffer = 0;      ///< GL buffer name; 0: the vertices have no such attribute.
    std::uint64_t offsetBytes = 0; ///< Of vertex 0; a multiple of 4.
    std::uint32_t strideBytes = 0; ///< From one vertex to the next; a multiple of 4, above 0.
};

enum class VertexColorFormat : std::uint8_t {
    Float, ///< Four floats, RGBA in [0,1].
    UNorm8 ///< Four bytes, RGBA.
};

/// Triangles in the host's own GL buffers (GL_TRIANGLES). Borrowed for the call; nothing is copied.
/// Indices are not checked: what a triangle with one of vertexCount or more sets is undefined, and
/// differs between backends.
struct MeshView {
    std::uint32_t vertexBuffer = 0; ///< GL buffer name.
    /// Of vertex 0's position (three floats) in the buffer; a multiple of 4.
    std::uint64_t positionOffsetBytes = 0;
    /// From one vertex to the next; a multiple of 4, above 0.
    std::uint32_t vertexStrideBytes = 12;
    std::uint32_t vertexCount = 0; ///< Vertices in the buffer; not indexed: what is drawn.

    std::uint32_t indexBuffer = 0; ///< GL buffer name; unused for IndexType::None.
    IndexType indexType = IndexType::None;
    std::uint64_t indexOffsetBytes = 0; ///< Of the first index; a multiple of the index size.
    std::uint32_t indexCount = 0;       ///< Three a triangle.

    glm::mat4 model{1.0f}; ///< Affine, model to world.
    /// Index into the material table. Past its end: an error of VolumeVoxelizer and
    /// AttributeVoxelizer, the last entry for VoxelizeOptions::materials.
    std::uint32_t materialId = 0;

    VertexStream normals{}; ///< Three floats, model space, any length; none: the faces' own.
    VertexStream colors{};  ///< None: white.
    VertexColorFormat colorFormat = VertexColorFormat::Float;
};

/// What the draw callback of a DrawSource is given.
struct DrawContext {
    std::uint32_t program = 0; ///< GL program in use: for the uniforms of the host's vertex stage.
    std::uint32_t pass = 0;    ///< From 0; the callback runs once a pass.
    std::uint32_t passCount = 1; ///< Passes of this voxelize() call.
};

/// Geometry that the host's own vertex stage makes: skinned, instanced, displaced.
struct DrawSource {
    /// GLSL 4.50 that defines `LaminaVertex laminaVertex()` (lamina/vertex_interface.glsl) and
    /// declares what it needs: inputs, uniforms, buffers. It must not declare main(), nor use
    /// uniform buffer bindings 0 to 2, image units 0 and 1 and storage buffer binding 7, nor
    /// names that begin with `lamina` or `Lamina` otherwise.
    std::string vertexShader;
    /// Binds the host's vertex array and resources and issues draws of GL_TRIANGLES,
    /// GL_TRIANGLE_STRIP or GL_TRIANGLE_FAN. It runs with Lamina's program and framebuffer bound
    /// and must leave both, under state for voxelization (no face culling, clip distances, scissor
    /// test or rasterizer discard; filled polygons; all of the viewport), of which it changes
    /// nothing but primitive restart: that is as the host set it before the call, so indices equal
    /// to its restart index are no vertices. Vertex array, uniform buffers 0 to 2 and raster state
    /// are put back after voxelize(); what else it binds (textures, storage buffers, other uniform
    /// buffers) stays as it leaves it.
    std::function<void(const DrawContext&)> draw;
    /// At least the number of triangles that the callback draws; 0: unknown. A compute backend
    /// keeps them in a buffer of 36 bytes each: what exceeds a number given here is not voxelized,
    /// and without one the backend waits for the GPU to see whether its buffer was large enough,
    /// and if not runs the callback again with a larger one. Raster backends do not use it. For
    /// compute backends no transform feedback of the host may be active.
    std::uint64_t maxTriangles = 0;
};

using GeometrySource = std::variant<MeshView, DrawSource>;

/// A host mesh (positions, and normals and colours where it has them) copied to GL buffers, for
/// callers that have none yet. Move-only.
class LAMINA_API MeshBuffers {
public:
    /// Errors: InvalidMesh (see validate()), OutOfMemory.
    [[nodiscard]] static Result<MeshBuffers> upload(const Device& device, const TriangleMesh& mesh);

    MeshBuffers(MeshBuffers&&) noexcept;
    MeshBuffers& operator=(MeshBuffers&&) noexcept;
    ~MeshBuffers();

    /// The buffers as a source; valid while this object lives.
    [[nodiscard]] MeshView view(const glm::mat4& model = glm::mat4(1.0f)) const;
    /// Bytes of GL memory held.
    [[nodiscard]] std::uint64_t gpuBytes() const;

private:
    struct Impl;
    explicit MeshBuffers(std::unique_ptr<Impl> impl);
    std::unique_ptr<Impl> mImpl;
};

} // namespace lamina
