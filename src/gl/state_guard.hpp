#pragma once

#include "gl/device_state.hpp"

#include <array>
#include <vector>

namespace lamina::gl {

/// Bindings [0, count) of an indexed buffer target, saved and put back. The generic binding of the
/// target is not touched.
class IndexedBufferBindings {
public:
    LAMINA_API IndexedBufferBindings(const GladGLContext& gl, GLenum target, GLuint count);
    LAMINA_API void restore(const GladGLContext& gl) const;

private:
    struct Binding {
        GLint buffer;
        GLint64 offset;
        GLint64 size;
    };

    GLenum mTarget;
    std::vector<Binding> mBindings;
};

/// Pauses the host's transform feedback, without which neither programs nor feedback objects can be
/// bound, and resumes it.
class FeedbackPause {
public:
    LAMINA_API explicit FeedbackPause(const GladGLContext& gl);
    /// After the host's program is bound again.
    LAMINA_API void resume(const GladGLContext& gl) const;

private:
    GLint mObject = 0;
    bool mPaused = false;
};

/// Saves the GL state that a raster pass touches and puts it back when it goes out of scope.
/// Between, the state is what a pass expects: no culling, no scissor, no logic op, all colours
/// written, filled polygons, default clip control and provoking vertex, no clip distances, no
/// primitive restart, transform feedback paused, its object free to be rebound. Passes draw to
/// framebuffers without depth or stencil, where those tests never apply.
class RasterStateGuard {
public:
    /// uniformBuffers: uniform buffer bindings [0, uniformBuffers) that the pass rebinds.
    LAMINA_API RasterStateGuard(DeviceState& device, GLuint uniformBuffers);
    LAMINA_API ~RasterStateGuard();
    RasterStateGuard(const RasterStateGuard&) = delete;
    RasterStateGuard& operator=(const RasterStateGuard&) = delete;

    /// Restart as the host left it, for draws that the host makes; false for Lamina's own draws.
    LAMINA_API void setHostPrimitiveRestart(bool asHost);

private:
    struct Capability {
        GLenum name;
        GLboolean wasEnabled;
    };

    DeviceState& mDevice;
    IndexedBufferBindings mUniformBuffers;
    FeedbackPause mFeedback;
    std::vector<Capability> mCapabilities;
    std::vector<std::array<GLboolean, 4>> mColorMasks;
    std::array<GLfloat, 4> mViewport{};
    GLboolean mScissor = GL_FALSE;
    GLboolean mRestart = GL_FALSE;
    GLboolean mRestartFixed = GL_FALSE;
    GLint mLogicOp = GL_COPY;
    std::array<GLint, 2> mPolygonMode{};
    GLint mClipOrigin = GL_LOWER_LEFT;
    GLint mClipDepth = GL_NEGATIVE_ONE_TO_ONE;
    GLint mProvokingVertex = GL_LAST_VERTEX_CONVENTION;
    GLint mDrawFramebuffer = 0;
    GLint mProgram = 0;
    GLint mVertexArray = 0;
};

/// Saves the GL state that a compute pass touches (program, indexed buffer bindings, indirect
/// buffer) and puts it back when it goes out of scope. Between, transform feedback is paused.
class ComputeStateGuard {
public:
    /// The pass rebinds uniform buffers [0, uniformBuffers) and storage buffers [0,
    /// storageBuffers).
    LAMINA_API ComputeStateGuard(DeviceState& device, GLuint uniformBuffers, GLuint storageBuffers);
    LAMINA_API ~ComputeStateGuard();
    ComputeStateGuard(const ComputeStateGuard&) = delete;
    ComputeStateGuard& operator=(const ComputeStateGuard&) = delete;

private:
    DeviceState& mDevice;
    IndexedBufferBindings mUniformBuffers;
    IndexedBufferBindings mStorageBuffers;
    FeedbackPause mFeedback;
    GLint mProgram = 0;
    GLint mIndirectBuffer = 0;
};

/// Saves the pixel pack state and buffer, and sets the defaults, for a read-back.
class PixelPackGuard {
public:
    LAMINA_API explicit PixelPackGuard(DeviceState& device);
    LAMINA_API ~PixelPackGuard();
    PixelPackGuard(const PixelPackGuard&) = delete;
    PixelPackGuard& operator=(const PixelPackGuard&) = delete;

private:
    DeviceState& mDevice;
    std::array<GLint, 8> mValues{};
    GLint mBuffer = 0;
};

/// The same for an upload.
class PixelUnpackGuard {
public:
    LAMINA_API explicit PixelUnpackGuard(DeviceState& device);
    LAMINA_API ~PixelUnpackGuard();
    PixelUnpackGuard(const PixelUnpackGuard&) = delete;
    PixelUnpackGuard& operator=(const PixelUnpackGuard&) = delete;

private:
    DeviceState& mDevice;
    std::array<GLint, 8> mValues{};
    GLint mBuffer = 0;
};

} // namespace lamina::gl
