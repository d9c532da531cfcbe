#pragma once

#include "gl/device_state.hpp"

#include <array>
#include <vector>

namespace lamina::gl {

/// Saves the GL state that a raster pass touches and puts it back when it goes out of scope.
/// Between, the state is what a pass expects: no culling, no scissor, no logic op, all colours
/// written, filled polygons, default clip control, no clip distances, no primitive restart,
/// transform feedback paused. Passes draw to framebuffers without depth or stencil, where those
/// tests never apply.
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
    struct BufferBinding {
        GLint buffer;
        GLint64 offset;
        GLint64 size;
    };

    DeviceState& mDevice;
    std::vector<Capability> mCapabilities;
    std::vector<BufferBinding> mUniformBuffers;
    std::vector<std::array<GLboolean, 4>> mColorMasks;
    std::array<GLfloat, 4> mViewport{};
    GLboolean mScissor = GL_FALSE;
    GLboolean mRestart = GL_FALSE;
    GLboolean mRestartFixed = GL_FALSE;
    GLint mLogicOp = GL_COPY;
    std::array<GLint, 2> mPolygonMode{};
    GLint mClipOrigin = GL_LOWER_LEFT;
    GLint mClipDepth = GL_NEGATIVE_ONE_TO_ONE;
    GLint mDrawFramebuffer = 0;
    GLint mProgram = 0;
    GLint mVertexArray = 0;
    bool mFeedbackPaused = false;
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
