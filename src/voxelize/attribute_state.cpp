#include "voxelize/attribute_state.hpp"

namespace lamina {

TextureUnitGuard::TextureUnitGuard(gl::DeviceState& device, GLuint units)
    : mDevice(device)
    , mUnits(units) {
    const GladGLContext& gl = device.gl;
    GLint active = 0;
    gl.GetIntegerv(GL_ACTIVE_TEXTURE, &active);
    for (GLuint i = 0; i < units; ++i) {
        gl.ActiveTexture(GL_TEXTURE0 + i);
        gl.GetIntegerv(GL_TEXTURE_BINDING_BUFFER, &mUnits[i].buffer);
        gl.GetIntegerv(GL_TEXTURE_BINDING_2D_ARRAY, &mUnits[i].array);
        gl.GetIntegerv(GL_SAMPLER_BINDING, &mUnits[i].sampler);
    }
    gl.ActiveTexture(static_cast<GLenum>(active));
}

TextureUnitGuard::~TextureUnitGuard() {
    const GladGLContext& gl = mDevice.gl;
    GLint active = 0;
    gl.GetIntegerv(GL_ACTIVE_TEXTURE, &active);
    for (GLuint i = 0; i < mUnits.size(); ++i) {
        gl.ActiveTexture(GL_TEXTURE0 + i);
        gl.BindTexture(GL_TEXTURE_BUFFER, static_cast<GLuint>(mUnits[i].buffer));
        gl.BindTexture(GL_TEXTURE_2D_ARRAY, static_cast<GLuint>(mUnits[i].array));
        gl.BindSampler(i, static_cast<GLuint>(mUnits[i].sampler));
    }
    gl.ActiveTexture(static_cast<GLenum>(active));
}

} // namespace lamina
