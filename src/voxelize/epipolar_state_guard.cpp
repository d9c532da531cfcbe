#include "voxelize/epipolar_state_guard.hpp"

#include "voxelize/epipolar_constants.hpp"

namespace lamina {
namespace {

constexpr std::array kImageNames = {GL_IMAGE_BINDING_NAME,    GL_IMAGE_BINDING_LEVEL,
                                    GL_IMAGE_BINDING_LAYERED, GL_IMAGE_BINDING_LAYER,
                                    GL_IMAGE_BINDING_ACCESS,  GL_IMAGE_BINDING_FORMAT};
constexpr std::array kTextureBindings = {GL_TEXTURE_BINDING_2D, GL_TEXTURE_BINDING_2D_ARRAY,
                                         GL_TEXTURE_BINDING_CUBE_MAP};

void setEnabled(const GladGLContext& gl, GLenum capability, GLboolean enabled) {
    if (enabled)
        gl.Enable(capability);
    else
        gl.Disable(capability);
}

} // namespace

EpipolarBindingsGuard::EpipolarBindingsGuard(gl::DeviceState& device)
    : mDevice(device) {
    const GladGLContext& gl = device.gl;
    for (std::size_t i = 0; i < kImageNames.size(); ++i)
        gl.GetIntegeri_v(static_cast<GLenum>(kImageNames[i]), LAMINA_EPIPOLAR_PASS_WORD_IMAGE,
                         &mImage[i]);
    GLint activeUnit = 0;
    gl.GetIntegerv(GL_ACTIVE_TEXTURE, &activeUnit);
    gl.ActiveTexture(GL_TEXTURE0 + LAMINA_EPIPOLAR_PASS_DEPTH_UNIT);
    for (std::size_t i = 0; i < kTextureBindings.size(); ++i)
        gl.GetIntegerv(static_cast<GLenum>(kTextureBindings[i]), &mTextures[i]);
    gl.GetIntegerv(GL_SAMPLER_BINDING, &mSampler);
    gl.ActiveTexture(static_cast<GLenum>(activeUnit));
}

EpipolarBindingsGuard::~EpipolarBindingsGuard() {
    const GladGLContext& gl = mDevice.gl;
    gl.BindImageTexture(LAMINA_EPIPOLAR_PASS_WORD_IMAGE, static_cast<GLuint>(mImage[0]), mImage[1],
                        static_cast<GLboolean>(mImage[2]), mImage[3],
                        static_cast<GLenum>(mImage[4]), static_cast<GLenum>(mImage[5]));
    // Binding texture 0 to a unit at once would unbind the targets that we never touched.
    GLint activeUnit = 0;
    gl.GetIntegerv(GL_ACTIVE_TEXTURE, &activeUnit);
    gl.ActiveTexture(GL_TEXTURE0 + LAMINA_EPIPOLAR_PASS_DEPTH_UNIT);
    for (std::size_t i = 0; i < kTextureTargets.size(); ++i)
        gl.BindTexture(static_cast<GLenum>(kTextureTargets[i]), static_cast<GLuint>(mTextures[i]));
    gl.ActiveTexture(static_cast<GLenum>(activeUnit));
    gl.BindSampler(LAMINA_EPIPOLAR_PASS_DEPTH_UNIT, static_cast<GLuint>(mSampler));
}

EpipolarDepthGuard::EpipolarDepthGuard(gl::DeviceState& device)
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
    gl.DepthFunc(GL_GREATER);
    gl.DepthMask(GL_TRUE);
    gl.DepthRangeIndexed(0, 0.0, 1.0);
    gl.ClipControl(GL_LOWER_LEFT, GL_ZERO_TO_ONE);
}

EpipolarDepthGuard::~EpipolarDepthGuard() {
    const GladGLContext& gl = mDevice.gl;
    setEnabled(gl, GL_DEPTH_TEST, mTest);
    setEnabled(gl, GL_DEPTH_CLAMP, mClamp);
    setEnabled(gl, GL_POLYGON_OFFSET_FILL, mOffset);
    gl.DepthFunc(static_cast<GLenum>(mFunction));
    gl.DepthMask(mWritten);
    gl.DepthRangeIndexed(0, mRange[0], mRange[1]);
}

} // namespace lamina
