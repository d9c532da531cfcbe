#include "voxelize/volume_state.hpp"

namespace lamina {

BlendStateGuard::BlendStateGuard(gl::DeviceState& device, GLuint targets)
    : mDevice(device)
    , mTargets(targets) {
    const GladGLContext& gl = device.gl;
    mDither = gl.IsEnabled(GL_DITHER);
    gl.Disable(GL_DITHER);
    for (GLuint i = 0; i < targets; ++i) {
        Target& target = mTargets[i];
        target.isEnabled = gl.IsEnabledi(GL_BLEND, i);
        gl.GetIntegeri_v(GL_BLEND_SRC_RGB, i, &target.sourceRgb);
        gl.GetIntegeri_v(GL_BLEND_SRC_ALPHA, i, &target.sourceAlpha);
        gl.GetIntegeri_v(GL_BLEND_DST_RGB, i, &target.destinationRgb);
        gl.GetIntegeri_v(GL_BLEND_DST_ALPHA, i, &target.destinationAlpha);
        gl.GetIntegeri_v(GL_BLEND_EQUATION_RGB, i, &target.equationRgb);
        gl.GetIntegeri_v(GL_BLEND_EQUATION_ALPHA, i, &target.equationAlpha);
        gl.Enablei(GL_BLEND, i);
        gl.BlendEquationi(i, GL_FUNC_ADD);
        gl.BlendFunci(i, GL_ONE, GL_ONE);
    }
}

BlendStateGuard::~BlendStateGuard() {
    const GladGLContext& gl = mDevice.gl;
    if (mDither)
        gl.Enable(GL_DITHER);
    for (GLuint i = 0; i < mTargets.size(); ++i) {
        const Target& target = mTargets[i];
        if (!target.isEnabled)
            gl.Disablei(GL_BLEND, i);
        gl.BlendEquationSeparatei(i, static_cast<GLenum>(target.equationRgb),
                                  static_cast<GLenum>(target.equationAlpha));
        gl.BlendFuncSeparatei(
            i, static_cast<GLenum>(target.sourceRgb), static_cast<GLenum>(target.destinationRgb),
            static_cast<GLenum>(target.sourceAlpha), static_cast<GLenum>(target.destinationAlpha));
    }
}

IndirectDrawGuard::IndirectDrawGuard(gl::DeviceState& device)
    : mDevice(device) {
    const GladGLContext& gl = device.gl;
    gl.GetIntegerv(GL_DRAW_INDIRECT_BUFFER_BINDING, &mIndirect);
    gl.GetIntegeri_v(GL_SHADER_STORAGE_BUFFER_BINDING, 0, &mStorage);
    gl.GetInteger64i_v(GL_SHADER_STORAGE_BUFFER_START, 0, &mStorageOffset);
    gl.GetInteger64i_v(GL_SHADER_STORAGE_BUFFER_SIZE, 0, &mStorageSize);
}

IndirectDrawGuard::~IndirectDrawGuard() {
    const GladGLContext& gl = mDevice.gl;
    gl.BindBuffer(GL_DRAW_INDIRECT_BUFFER, static_cast<GLuint>(mIndirect));
    const auto buffer = static_cast<GLuint>(mStorage);
    const auto offset = static_cast<GLintptr>(mStorageOffset);
    const auto size = static_cast<GLsizeiptr>(mStorageSize);
    // Multi-bind leaves the generic binding alone.
    if (buffer != 0 && size != 0)
        gl.BindBuffersRange(GL_SHADER_STORAGE_BUFFER, 0, 1, &buffer, &offset, &size);
    else
        gl.BindBuffersBase(GL_SHADER_STORAGE_BUFFER, 0, 1, &buffer);
}

ImageUnitGuard::ImageUnitGuard(gl::DeviceState& device, GLuint units)
    : mDevice(device)
    , mUnits(units) {
    const GladGLContext& gl = device.gl;
    for (GLuint i = 0; i < units; ++i) {
        Unit& unit = mUnits[i];
        gl.GetIntegeri_v(GL_IMAGE_BINDING_NAME, i, &unit.name);
        gl.GetIntegeri_v(GL_IMAGE_BINDING_LEVEL, i, &unit.level);
        gl.GetIntegeri_v(GL_IMAGE_BINDING_LAYER, i, &unit.layer);
        gl.GetIntegeri_v(GL_IMAGE_BINDING_ACCESS, i, &unit.access);
        gl.GetIntegeri_v(GL_IMAGE_BINDING_FORMAT, i, &unit.format);
        gl.GetBooleani_v(GL_IMAGE_BINDING_LAYERED, i, &unit.isLayered);
    }
}

ImageUnitGuard::~ImageUnitGuard() {
    for (GLuint i = 0; i < mUnits.size(); ++i) {
        const Unit& unit = mUnits[i];
        mDevice.gl.BindImageTexture(i, static_cast<GLuint>(unit.name), unit.level, unit.isLayered,
                                    unit.layer, static_cast<GLenum>(unit.access),
                                    static_cast<GLenum>(unit.format));
    }
}

} // namespace lamina
