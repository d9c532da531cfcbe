#pragma once

#include "gl/device_state.hpp"
#include "gl/program_cache.hpp"
#include "gl/state_guard.hpp"

#include <lamina/voxelize/geometry_source.hpp>

#include <cstdint>
#include <functional>
#include <vector>

namespace lamina {

/// What is kept of a vertex: its position (three floats), or also normal, colour and material id
/// (LAMINA_CAPTURE_*).
enum class CaptureContent : std::uint8_t { Positions, Surfaces };

/// Separate triangles in a GL buffer.
struct CapturedTriangles {
    GLuint buffer = 0;
    CaptureContent content = CaptureContent::Positions;
    std::uint64_t capacity = 0; ///< Triangles; those that were not drawn have NaN positions.
};

/// Runs vertex stages and keeps the triangles they make, by transform feedback. No queries: the
/// host may have its own active. Buffers are kept, one a slot, and reused.
class TriangleCapture {
public:
    LAMINA_API TriangleCapture(std::shared_ptr<gl::DeviceState> device, CaptureContent content);

    /// The program for capture(): of the host's vertex stage, or of MeshView sources.
    /// Errors: ShaderError.
    [[nodiscard]] LAMINA_API Result<GLuint> program(const DrawSource& source) const;
    [[nodiscard]] LAMINA_API Result<GLuint> meshProgram() const;

    /// A paused transform feedback of the host would not survive another one: Mesa (22.3) keeps the
    /// primitive mode in the context.
    /// Errors: InvalidArgument while the host's is active.
    [[nodiscard]] LAMINA_API Result<void> checkHost() const;

    /// Room for a source's triangles, before any work. Errors: OutOfMemory.
    [[nodiscard]] LAMINA_API Result<void> reserve(std::size_t slot, std::uint64_t triangles);
    /// Bytes of GL memory held.
    [[nodiscard]] LAMINA_API std::uint64_t bytes() const;

    /// Captures a source's triangles. The state is put back as Voxelizer promises.
    /// Waits for the GPU if a DrawSource does not say how many triangles it draws.
    /// Errors: OutOfMemory.
    [[nodiscard]] LAMINA_API Result<CapturedTriangles>
    capture(std::size_t slot, const DrawSource& source, GLuint program);
    [[nodiscard]] LAMINA_API Result<CapturedTriangles>
    capture(std::size_t slot, const MeshView& view, GLuint program);

private:
    using Draw = std::function<void(gl::RasterStateGuard&)>;

    void run(std::size_t slot, GLuint program, const Draw& draw);
    [[nodiscard]] bool isFull(std::size_t slot) const;
    [[nodiscard]] std::uint64_t capacity(std::size_t slot) const;
    [[nodiscard]] Result<GLuint> buildProgram(const gl::ProgramStage& stage) const;
    [[nodiscard]] bool keepsSurfaces() const { return mContent == CaptureContent::Surfaces; }
    [[nodiscard]] std::uint64_t triangleBytes() const;

    std::shared_ptr<gl::DeviceState> mDevice;
    CaptureContent mContent;
    gl::TransformFeedback mFeedback;
    gl::Framebuffer mFramebuffer;
    gl::VertexArray mVertexArray;
    gl::Buffer mDefaultAttributes;
    std::vector<gl::Buffer> mBuffers;
};

} // namespace lamina
