#include "gl/stencil_guard.hpp"

namespace lamina::gl {
namespace {

struct FaceNames {
    GLenum face, function, reference, mask, writeMask, fail, depthFail, pass;
};

constexpr std::array<FaceNames, 2> kFaces = {{
    {GL_FRONT, GL_STENCIL_FUNC, GL_STENCIL_REF, GL_STENCIL_VALUE_MASK, GL_STENCIL_WRITEMASK,
     GL_STENCIL_FAIL, GL_STENCIL_PASS_DEPTH_FAIL, GL_STENCIL_PASS_DEPTH_PASS},
    {GL_BACK, GL_STENCIL_BACK_FUNC, GL_STENCIL_BACK_REF, GL_STENCIL_BACK_VALUE_MASK,
     GL_STENCIL_BACK_WRITEMASK, GL_STENCIL_BACK_FAIL, GL_STENCIL_BACK_PASS_DEPTH_FAIL,
     GL_STENCIL_BACK_PASS_DEPTH_PASS},
}};

} // namespace

StencilStateGuard::StencilStateGuard(DeviceState& device)
    : mDevice(device)
    , mTest(device.gl.IsEnabled(GL_STENCIL_TEST)) {
    const GladGLContext& gl = device.gl;
    for (std::size_t i = 0; i < kFaces.size(); ++i) {
        const FaceNames& names = kFaces[i];
        Face& face = mFaces[i];
        gl.GetIntegerv(names.function, &face.function);
        gl.GetIntegerv(names.reference, &face.reference);
        gl.GetIntegerv(names.mask, &face.mask);
        gl.GetIntegerv(names.writeMask, &face.writeMask);
        gl.GetIntegerv(names.fail, &face.fail);
        gl.GetIntegerv(names.depthFail, &face.depthFail);
        gl.GetIntegerv(names.pass, &face.pass);
    }
    gl.Enable(GL_STENCIL_TEST);
}

StencilStateGuard::~StencilStateGuard() {
    const GladGLContext& gl = mDevice.gl;
    for (std::size_t i = 0; i < kFaces.size(); ++i) {
        const GLenum name = kFaces[i].face;
        const Face& face = mFaces[i];
        gl.StencilFuncSeparate(name, static_cast<GLenum>(face.function), face.reference,
                               static_cast<GLuint>(face.mask));
        gl.StencilMaskSeparate(name, static_cast<GLuint>(face.writeMask));
        gl.StencilOpSeparate(name, static_cast<GLenum>(face.fail),
                             static_cast<GLenum>(face.depthFail), static_cast<GLenum>(face.pass));
    }
    if (!mTest)
        gl.Disable(GL_STENCIL_TEST);
}

} // namespace lamina::gl
