#include "gl/state_guard.hpp"

#include <span>

namespace lamina::gl {
namespace {

constexpr std::array kDisabled = {
    GL_CULL_FACE,      GL_RASTERIZER_DISCARD, GL_COLOR_LOGIC_OP, GL_POLYGON_SMOOTH,
    GL_CLIP_DISTANCE0, GL_CLIP_DISTANCE1,     GL_CLIP_DISTANCE2, GL_CLIP_DISTANCE3,
    GL_CLIP_DISTANCE4, GL_CLIP_DISTANCE5,     GL_CLIP_DISTANCE6, GL_CLIP_DISTANCE7,
};

constexpr std::array kPackNames = {
    GL_PACK_SWAP_BYTES,  GL_PACK_LSB_FIRST, GL_PACK_ROW_LENGTH,  GL_PACK_IMAGE_HEIGHT,
    GL_PACK_SKIP_PIXELS, GL_PACK_SKIP_ROWS, GL_PACK_SKIP_IMAGES, GL_PACK_ALIGNMENT,
};

constexpr std::array kUnpackNames = {
    GL_UNPACK_SWAP_BYTES,  GL_UNPACK_LSB_FIRST, GL_UNPACK_ROW_LENGTH,  GL_UNPACK_IMAGE_HEIGHT,
    GL_UNPACK_SKIP_PIXELS, GL_UNPACK_SKIP_ROWS, GL_UNPACK_SKIP_IMAGES, GL_UNPACK_ALIGNMENT,
};

GLint integer(const GladGLContext& gl, GLenum name) {
    GLint value = 0;
    gl.GetIntegerv(name, &value);
    return value;
}

void setEnabled(const GladGLContext& gl, GLenum capability, GLboolean enabled) {
    if (enabled)
        gl.Enable(capability);
    else
        gl.Disable(capability);
}

void savePixelStore(const GladGLContext& gl, std::span<const int> names, std::span<GLint> values) {
    constexpr GLint kTight = 1; // the last name is the alignment
    for (std::size_t i = 0; i < names.size(); ++i) {
        const auto name = static_cast<GLenum>(names[i]);
        values[i] = integer(gl, name);
        gl.PixelStorei(name, i + 1 == names.size() ? kTight : 0);
    }
}

void restorePixelStore(const GladGLContext& gl, std::span<const int> names,
                       std::span<const GLint> values) {
    for (std::size_t i = 0; i < names.size(); ++i)
        gl.PixelStorei(static_cast<GLenum>(names[i]), values[i]);
}

} // namespace

IndexedBufferBindings::IndexedBufferBindings(const GladGLContext& gl, GLenum target, GLuint count)
    : mTarget(target)
    , mBindings(count) {
    const bool isStorage = target == GL_SHADER_STORAGE_BUFFER;
    for (GLuint i = 0; i < count; ++i) {
        Binding& binding = mBindings[i];
        gl.GetIntegeri_v(isStorage ? GL_SHADER_STORAGE_BUFFER_BINDING : GL_UNIFORM_BUFFER_BINDING,
                         i, &binding.buffer);
        gl.GetInteger64i_v(isStorage ? GL_SHADER_STORAGE_BUFFER_START : GL_UNIFORM_BUFFER_START, i,
                           &binding.offset);
        gl.GetInteger64i_v(isStorage ? GL_SHADER_STORAGE_BUFFER_SIZE : GL_UNIFORM_BUFFER_SIZE, i,
                           &binding.size);
    }
}

void IndexedBufferBindings::restore(const GladGLContext& gl) const {
    // Multi-bind leaves the generic binding alone.
    for (GLuint i = 0; i < mBindings.size(); ++i) {
        const Binding& binding = mBindings[i];
        const auto buffer = static_cast<GLuint>(binding.buffer);
        const auto offset = static_cast<GLintptr>(binding.offset);
        const auto size = static_cast<GLsizeiptr>(binding.size);
        if (buffer != 0 && size != 0)
            gl.BindBuffersRange(mTarget, i, 1, &buffer, &offset, &size);
        else
            gl.BindBuffersBase(mTarget, i, 1, &buffer);
    }
}

FeedbackPause::FeedbackPause(const GladGLContext& gl) {
    GLboolean active = GL_FALSE;
    GLboolean paused = GL_FALSE;
    gl.GetBooleanv(GL_TRANSFORM_FEEDBACK_ACTIVE, &active);
    gl.GetBooleanv(GL_TRANSFORM_FEEDBACK_PAUSED, &paused);
    mObject = integer(gl, GL_TRANSFORM_FEEDBACK_BINDING);
    mPaused = active && !paused;
    if (mPaused)
        gl.PauseTransformFeedback();
}

void FeedbackPause::resume(const GladGLContext& gl) const {
    gl.BindTransformFeedback(GL_TRANSFORM_FEEDBACK, static_cast<GLuint>(mObject));
    if (mPaused)
        gl.ResumeTransformFeedback();
}

RasterStateGuard::RasterStateGuard(DeviceState& device, GLuint uniformBuffers)
    : mDevice(device)
    , mUniformBuffers(device.gl, GL_UNIFORM_BUFFER, uniformBuffers)
    , mFeedback(device.gl) {
    const GladGLContext& gl = device.gl;
    for (const int capability : kDisabled) {
        const auto cap = static_cast<GLenum>(capability);
        mCapabilities.push_back({cap, gl.IsEnabled(cap)});
        gl.Disable(cap);
    }
    mRestart = gl.IsEnabled(GL_PRIMITIVE_RESTART);
    mRestartFixed = gl.IsEnabled(GL_PRIMITIVE_RESTART_FIXED_INDEX);
    mScissor = gl.IsEnabledi(GL_SCISSOR_TEST, 0);
    gl.Disablei(GL_SCISSOR_TEST, 0);
    mLogicOp = integer(gl, GL_LOGIC_OP_MODE);
    gl.GetIntegerv(GL_POLYGON_MODE, mPolygonMode.data());
    gl.PolygonMode(GL_FRONT_AND_BACK, GL_FILL);
    mClipOrigin = integer(gl, GL_CLIP_ORIGIN);
    mClipDepth = integer(gl, GL_CLIP_DEPTH_MODE);
    gl.ClipControl(GL_LOWER_LEFT, GL_NEGATIVE_ONE_TO_ONE);
    // Also the order in which a rasterizer takes the vertices, and so how it rounds.
    mProvokingVertex = integer(gl, GL_PROVOKING_VERTEX);
    gl.ProvokingVertex(GL_LAST_VERTEX_CONVENTION);
    gl.GetFloati_v(GL_VIEWPORT, 0, mViewport.data());

    mColorMasks.resize(device.limits.maxDrawBuffers);
    for (GLuint i = 0; i < mColorMasks.size(); ++i) {
        gl.GetBooleani_v(GL_COLOR_WRITEMASK, i, mColorMasks[i].data());
        gl.ColorMaski(i, GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
    }
    mDrawFramebuffer = integer(gl, GL_DRAW_FRAMEBUFFER_BINDING);
    mVertexArray = integer(gl, GL_VERTEX_ARRAY_BINDING);
    mProgram = integer(gl, GL_CURRENT_PROGRAM);
}

RasterStateGuard::~RasterStateGuard() {
    const GladGLContext& gl = mDevice.gl;
    for (const Capability& capability : mCapabilities)
        setEnabled(gl, capability.name, capability.wasEnabled);
    setHostPrimitiveRestart(true);
    if (mScissor)
        gl.Enablei(GL_SCISSOR_TEST, 0);
    gl.LogicOp(static_cast<GLenum>(mLogicOp));
    gl.PolygonMode(GL_FRONT_AND_BACK, static_cast<GLenum>(mPolygonMode[0]));
    gl.ClipControl(static_cast<GLenum>(mClipOrigin), static_cast<GLenum>(mClipDepth));
    gl.ProvokingVertex(static_cast<GLenum>(mProvokingVertex));
    gl.ViewportIndexedfv(0, mViewport.data());
    for (GLuint i = 0; i < mColorMasks.size(); ++i) {
        const auto& mask = mColorMasks[i];
        gl.ColorMaski(i, mask[0], mask[1], mask[2], mask[3]);
    }
    mUniformBuffers.restore(gl);
    gl.BindFramebuffer(GL_DRAW_FRAMEBUFFER, static_cast<GLuint>(mDrawFramebuffer));
    gl.BindVertexArray(static_cast<GLuint>(mVertexArray));
    gl.UseProgram(static_cast<GLuint>(mProgram));
    mFeedback.resume(gl);
}

void RasterStateGuard::setHostPrimitiveRestart(bool asHost) {
    setEnabled(mDevice.gl, GL_PRIMITIVE_RESTART, asHost && mRestart);
    setEnabled(mDevice.gl, GL_PRIMITIVE_RESTART_FIXED_INDEX, asHost && mRestartFixed);
}

ComputeStateGuard::ComputeStateGuard(DeviceState& device, GLuint uniformBuffers,
                                     GLuint storageBuffers)
    : mDevice(device)
    , mUniformBuffers(device.gl, GL_UNIFORM_BUFFER, uniformBuffers)
    , mStorageBuffers(device.gl, GL_SHADER_STORAGE_BUFFER, storageBuffers)
    , mFeedback(device.gl)
    , mProgram(integer(device.gl, GL_CURRENT_PROGRAM))
    , mIndirectBuffer(integer(device.gl, GL_DISPATCH_INDIRECT_BUFFER_BINDING)) {}

ComputeStateGuard::~ComputeStateGuard() {
    const GladGLContext& gl = mDevice.gl;
    mUniformBuffers.restore(gl);
    mStorageBuffers.restore(gl);
    gl.BindBuffer(GL_DISPATCH_INDIRECT_BUFFER, static_cast<GLuint>(mIndirectBuffer));
    gl.UseProgram(static_cast<GLuint>(mProgram));
    mFeedback.resume(gl);
}

PixelPackGuard::PixelPackGuard(DeviceState& device)
    : mDevice(device) {
    mBuffer = integer(device.gl, GL_PIXEL_PACK_BUFFER_BINDING);
    device.gl.BindBuffer(GL_PIXEL_PACK_BUFFER, 0);
    savePixelStore(device.gl, kPackNames, mValues);
}

PixelPackGuard::~PixelPackGuard() {
    restorePixelStore(mDevice.gl, kPackNames, mValues);
    mDevice.gl.BindBuffer(GL_PIXEL_PACK_BUFFER, static_cast<GLuint>(mBuffer));
}

PixelUnpackGuard::PixelUnpackGuard(DeviceState& device)
    : mDevice(device) {
    mBuffer = integer(device.gl, GL_PIXEL_UNPACK_BUFFER_BINDING);
    device.gl.BindBuffer(GL_PIXEL_UNPACK_BUFFER, 0);
    savePixelStore(device.gl, kUnpackNames, mValues);
}

PixelUnpackGuard::~PixelUnpackGuard() {
    restorePixelStore(mDevice.gl, kUnpackNames, mValues);
    mDevice.gl.BindBuffer(GL_PIXEL_UNPACK_BUFFER, static_cast<GLuint>(mBuffer));
}

} // namespace lamina::gl
