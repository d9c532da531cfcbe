#pragma once

#include "gl/glad.hpp"

#include <algorithm>
#include <cstddef>
#include <map>

namespace lamina::test {

namespace detail {
struct GlCallCounts {
    std::size_t work = 0;
    std::size_t allocations = 0;
    std::map<GLuint, std::size_t> streamed;
};
} // namespace detail

/// Counts a device's GL calls that do work or take memory, while it lives. One at a time.
class GlCalls {
public:
    explicit GlCalls(GladGLContext& gl)
        : mGl(gl)
        , mSaved(gl) {
        gCounts = {};
        gSaved = &mSaved;
        gl.DispatchCompute = [](GLuint x, GLuint y, GLuint z) {
            ++gCounts.work;
            gSaved->DispatchCompute(x, y, z);
        };
        gl.DrawArrays = [](GLenum mode, GLint first, GLsizei count) {
            ++gCounts.work;
            gSaved->DrawArrays(mode, first, count);
        };
        gl.DrawElements = [](GLenum mode, GLsizei count, GLenum type, const void* indices) {
            ++gCounts.work;
            gSaved->DrawElements(mode, count, type, indices);
        };
        gl.DrawElementsBaseVertex = [](GLenum mode, GLsizei count, GLenum type, const void* indices,
                                       GLint base) {
            ++gCounts.work;
            gSaved->DrawElementsBaseVertex(mode, count, type, indices, base);
        };
        gl.ClearTexSubImage = [](GLuint texture, GLint level, GLint x, GLint y, GLint z, GLsizei w,
                                 GLsizei h, GLsizei d, GLenum format, GLenum type,
                                 const void* data) {
            ++gCounts.work;
            gSaved->ClearTexSubImage(texture, level, x, y, z, w, h, d, format, type, data);
        };
        gl.CreateTextures = [](GLenum target, GLsizei n, GLuint* names) {
            ++gCounts.allocations;
            gSaved->CreateTextures(target, n, names);
        };
        gl.CreateBuffers = [](GLsizei n, GLuint* names) {
            ++gCounts.allocations;
            gSaved->CreateBuffers(n, names);
        };
        gl.NamedBufferStorage = [](GLuint buffer, GLsizeiptr bytes, const void* data,
                                   GLbitfield flags) {
            ++gCounts.allocations;
            gSaved->NamedBufferStorage(buffer, bytes, data, flags);
        };
        gl.TextureStorage2D = [](GLuint texture, GLsizei levels, GLenum format, GLsizei w,
                                 GLsizei h) {
            ++gCounts.allocations;
            gSaved->TextureStorage2D(texture, levels, format, w, h);
        };
        gl.TextureStorage3D = [](GLuint texture, GLsizei levels, GLenum format, GLsizei w,
                                 GLsizei h, GLsizei d) {
            ++gCounts.allocations;
            gSaved->TextureStorage3D(texture, levels, format, w, h, d);
        };
        gl.NamedBufferData = [](GLuint buffer, GLsizeiptr bytes, const void* data, GLenum usage) {
            std::size_t& streamed = gCounts.streamed[buffer];
            streamed = std::max(streamed, static_cast<std::size_t>(bytes));
            gSaved->NamedBufferData(buffer, bytes, data, usage);
        };
    }
    ~GlCalls() {
        mGl = mSaved;
        gSaved = nullptr;
    }
    GlCalls(const GlCalls&) = delete;
    GlCalls& operator=(const GlCalls&) = delete;

    /// Draws, dispatches and clears of textures.
    [[nodiscard]] std::size_t work() const { return gCounts.work; }
    /// New objects and new immutable storage.
    [[nodiscard]] std::size_t allocations() const { return gCounts.allocations; }
    /// Bytes of each buffer that is streamed (respecified, which drivers serve by recycling).
    [[nodiscard]] std::map<GLuint, std::size_t> streamed() const { return gCounts.streamed; }

private:
    static inline detail::GlCallCounts gCounts;
    static inline GladGLContext* gSaved = nullptr;

    GladGLContext& mGl;
    GladGLContext mSaved;
};

} // namespace lamina::test
