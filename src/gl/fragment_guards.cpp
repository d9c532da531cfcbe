#include "gl/fragment_guards.hpp"

namespace lamina::gl {
namespace {

void setEnabled(const GladGLContext& gl, GLenum capability, GLboolean enabled) {
    if (enabled)
        gl.Enable(capability);
    else
        gl.Disable(capability);
}

} // namespace

BlendStateGuard::BlendStateGuard(DeviceState& device, GLuint targets, Blending blending)
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
        if (blending == Blending::Off) {
            gl.Disablei(GL_BLEND, i);
            continue;
        }
        gl.Enablei(GL_BLEND, i);
        gl.BlendEquationi(i, blending == Blending::Add ? GL_FUNC_ADD : GL_MIN);
        gl.BlendFunci(i, GL_ONE, GL_ONE);
    }
}

BlendStateGuard::~BlendStateGuard() {
    const GladGLContext& gl = mDevice.gl;
    if (mDither)
        gl.Enable(GL_DITHER);
    for (GLuint i = 0; i < mTargets.size(); ++i) {
        const Target& target = mTargets[i];
        if (target.isEnabled)
            gl.Enablei(GL_BLEND, i);
        else
            gl.Disablei(GL_BLEND, i);
        gl.BlendEquationSeparatei(i, static_cast<GLenum>(target.equationRgb),
                                  static_cast<GLenum>(target.equationAlpha));
        gl.BlendFuncSeparatei(
            i, static_cast<GLenum>(target.sourceRgb), static_cast<GLenum>(target.destinationRgb),
            static_cast<GLenum>(target.sourceAlpha), static_cast<GLenum>(target.destinationAlpha));
    }
}

DepthStateGuard::DepthStateGuard(DeviceState& device, GLenum function)
    : mDevice(device)
    , mTest(device.gl.IsEnabled(GL_DEPTH_TEST))
    , mClamp(device.gl.IsEnabled(GL_DEPTH_CLAMP))
    , mOffset(device.gl.IsEnabled(GL_POLYGON_OFFSET_FILL)) {
    const GladGLContext& gl = device.gl;
    gl.GetIntegerv(GL_DEPTH_FUNC, &mFunction);
    gl.GetBooleanv(GL_DEPTH_WRITEMASK, &mWritten);
    gl.GetDoublei_v(GL_DEPTH_RANGE, 0, mRange.data());
    gl.Enable(GL_DEPTH_TEST);
    gl.Disable(GL_POLYGON_OFFSET_FILL);
    gl.DepthFunc(function);
    gl.DepthMask(GL_TRUE);
    gl.DepthRangeIndexed(0, 0.0, 1.0);
    gl.ClipControl(GL_LOWER_LEFT, GL_ZERO_TO_ONE);
}

DepthStateGuard::~DepthStateGuard() {
    const GladGLContext& gl = mDevice.gl;
    setEnabled(gl, GL_DEPTH_TEST, mTest);
    setEnabled(gl, GL_DEPTH_CLAMP, mClamp);
    setEnabled(gl, GL_POLYGON_OFFSET_FILL, mOffset);
    gl.DepthFunc(static_cast<GLenum>(mFunction));
    gl.DepthMask(mWritten);
    gl.DepthRangeIndexed(0, mRange[0], mRange[1]);
}

} // namespace lamina::gl
