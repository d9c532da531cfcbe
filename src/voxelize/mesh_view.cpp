#include "voxelize/mesh_view.hpp"

#include "core/finite.hpp"

#include <algorithm>
#include <limits>
#include <string>

namespace lamina {
namespace {

std::uint64_t indexBytes(IndexType type) {
    return type == IndexType::UInt16 ? 2 : 4;
}

std::uint64_t bufferBytes(const GladGLContext& gl, GLuint buffer) {
    GLint64 size = 0;
    gl.GetNamedBufferParameteri64v(buffer, GL_BUFFER_SIZE, &size);
    return static_cast<std::uint64_t>(size);
}

bool isAffine(const glm::mat4& matrix) {
    return detail::isFinite(matrix) && matrix[0][3] == 0.0f && matrix[1][3] == 0.0f &&
           matrix[2][3] == 0.0f && matrix[3][3] == 1.0f;
}

} // namespace

std::uint64_t endOfRange(std::uint64_t offset, std::uint64_t bytes) {
    constexpr std::uint64_t kMost = std::numeric_limits<std::uint64_t>::max();
    return offset > kMost - bytes ? kMost : offset + bytes;
}

std::uint64_t triangleCount(const MeshView& view) {
    return (view.indexType == IndexType::None ? view.vertexCount : view.indexCount) / 3;
}

Result<void> checkMeshView(const gl::DeviceState& device, const MeshView& view, std::size_t index,
                           std::string_view what) {
    const GladGLContext& gl = device.gl;
    const std::string prefix = std::string(what) + " " + std::to_string(index) + ": ";
    const auto invalid = [&prefix](const std::string& text) {
        return Error{ErrorCode::InvalidArgument, prefix + text};
    };
    constexpr std::uint64_t kPositionBytes = 3 * sizeof(float);
    if (!gl.IsBuffer(view.vertexBuffer)) {
        if (auto current = gl::checkContext(device, what); !current)
            return current;
        return invalid("expected vertexBuffer to name a GL buffer, found " +
                       std::to_string(view.vertexBuffer));
    }
    if (view.vertexStrideBytes > device.limits.maxVertexAttribStride)
        return Error{ErrorCode::DeviceLimit,
                     prefix + "vertex stride " + std::to_string(view.vertexStrideBytes) +
                         " bytes, the device's limit is " +
                         std::to_string(device.limits.maxVertexAttribStride) +
                         "; repack the vertices"};
    if (view.vertexStrideBytes == 0 || view.positionOffsetBytes % 4 != 0 ||
        view.vertexStrideBytes % 4 != 0)
        return invalid(
            "expected a vertex stride above 0 and stride and offset in multiples of 4 bytes, "
            "found stride " +
            std::to_string(view.vertexStrideBytes) + ", offset " +
            std::to_string(view.positionOffsetBytes));
    if (view.vertexCount > 0) {
        const std::uint64_t needed = endOfRange(
            view.positionOffsetBytes,
            std::uint64_t{view.vertexCount - 1} * view.vertexStrideBytes + kPositionBytes);
        const std::uint64_t found = bufferBytes(gl, view.vertexBuffer);
        if (needed > found)
            return invalid("expected a vertex buffer of " + std::to_string(needed) + " bytes for " +
                           std::to_string(view.vertexCount) + " vertices, found " +
                           std::to_string(found));
    }
    if (view.indexType == IndexType::None) {
        if (view.vertexCount % 3 != 0)
            return invalid("expected three vertices a triangle, found " +
                           std::to_string(view.vertexCount) + " vertices");
    } else {
        if (!gl.IsBuffer(view.indexBuffer))
            return invalid("expected indexBuffer to name a GL buffer, found " +
                           std::to_string(view.indexBuffer));
        if (view.indexCount % 3 != 0)
            return invalid("expected three indices a triangle, found " +
                           std::to_string(view.indexCount) + " indices");
        const std::uint64_t size = indexBytes(view.indexType);
        if (view.indexOffsetBytes % size != 0)
            return invalid("expected an index offset in multiples of " + std::to_string(size) +
                           " bytes, found " + std::to_string(view.indexOffsetBytes));
        const std::uint64_t needed = endOfRange(view.indexOffsetBytes, view.indexCount * size);
        const std::uint64_t found = bufferBytes(gl, view.indexBuffer);
        if (needed > found)
            return invalid("expected an index buffer of " + std::to_string(needed) + " bytes for " +
                           std::to_string(view.indexCount) + " indices, found " +
                           std::to_string(found));
        if (view.indexCount > 0 && view.vertexCount == 0)
            return invalid("expected vertexCount above 0 for an indexed mesh, found 0");
    }
    if (!isAffine(view.model))
        return invalid("expected a finite, affine model matrix with last row (0,0,0,1)");
    return {};
}

Result<void> checkDrawSource(const DrawSource& source, std::size_t index, std::string_view what) {
    const std::string prefix = std::string(what) + " " + std::to_string(index) + ": ";
    if (source.vertexShader.empty() || !source.draw)
        return Error{ErrorCode::InvalidArgument,
                     prefix +
                         "expected a DrawSource with a vertex stage and a draw callback, found "
                         "one without"};
    // What 32-bit vertex counts can number.
    constexpr std::uint64_t kMostTriangles = 0xffffffffu / 3;
    if (source.maxTriangles > kMostTriangles)
        return Error{ErrorCode::DeviceLimit, prefix + "expected maxTriangles up to " +
                                                 std::to_string(kMostTriangles) + ", found " +
                                                 std::to_string(source.maxTriangles)};
    return {};
}

void drawMeshView(gl::DeviceState& device, GLuint vertexArray, const MeshView& view) {
    const GladGLContext& gl = device.gl;
    gl.VertexArrayVertexBuffer(vertexArray, 0, view.vertexBuffer,
                               static_cast<GLintptr>(view.positionOffsetBytes),
                               static_cast<GLsizei>(view.vertexStrideBytes));
    // In parts: the count of a draw is a signed 32-bit integer.
    constexpr std::uint32_t kMaxPerDraw = 3u << 28u;
    if (view.indexType == IndexType::None) {
        for (std::uint64_t first = 0; first < view.vertexCount; first += kMaxPerDraw)
            gl.DrawArrays(GL_TRIANGLES, static_cast<GLint>(first),
                          static_cast<GLsizei>(
                              std::min<std::uint64_t>(view.vertexCount - first, kMaxPerDraw)));
        return;
    }
    gl.VertexArrayElementBuffer(vertexArray, view.indexBuffer);
    const GLenum type = view.indexType == IndexType::UInt16 ? GL_UNSIGNED_SHORT : GL_UNSIGNED_INT;
    for (std::uint64_t first = 0; first < view.indexCount; first += kMaxPerDraw) {
        const std::uint64_t count = std::min<std::uint64_t>(view.indexCount - first, kMaxPerDraw);
        const std::uint64_t offset = view.indexOffsetBytes + first * indexBytes(view.indexType);
        gl.DrawElements(GL_TRIANGLES, static_cast<GLsizei>(count), type,
                        reinterpret_cast<const void*>(offset));
    }
}

} // namespace lamina
