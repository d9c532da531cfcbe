#include "gl/binding_guards.hpp"

namespace lamina::gl {
namespace {

struct TextureTarget {
    GLenum target;
    GLenum binding;
};

constexpr std::array<TextureTarget, 11> kTextureTargets = {{
    {GL_TEXTURE_1D, GL_TEXTURE_BINDING_1D},
    {GL_TEXTURE_1D_ARRAY, GL_TEXTURE_BINDING_1D_ARRAY},
    {GL_TEXTURE_2D, GL_TEXTURE_BINDING_2D},
    {GL_TEXTURE_2D_ARRAY, GL_TEXTURE_BINDING_2D_ARRAY},
    {GL_TEXTURE_3D, GL_TEXTURE_BINDING_3D},
    {GL_TEXTURE_CUBE_MAP, GL_TEXTURE_BINDING_CUBE_MAP},
    {GL_TEXTURE_CUBE_MAP_ARRAY, GL_TEXTURE_BINDING_CUBE_MAP_ARRAY},
    {GL_TEXTURE_RECTANGLE, GL_TEXTURE_BINDING_RECTANGLE},
    {GL_TEXTURE_2D_MULTISAMPLE, GL_TEXTURE_BINDING_2D_MULTISAMPLE},
    {GL_TEXTURE_2D_MULTISAMPLE_ARRAY, GL_TEXTURE_BINDING_2D_MULTISAMPLE_ARRAY},
    {GL_TEXTURE_BUFFER, GL_TEXTURE_BINDING_BUFFER},
}};

/// Makes texture units active in turn and the host's active again at the end.
class ActiveUnit {
public:
    explicit ActiveUnit(const GladGLContext& gl)
        : mGl(gl) {
        gl.GetIntegerv(GL_ACTIVE_TEXTURE, &mHost);
    }
    ~ActiveUnit() { mGl.ActiveTexture(static_cast<GLenum>(mHost)); }
    ActiveUnit(const ActiveUnit&) = delete;
    ActiveUnit& operator=(const ActiveUnit&) = delete;
    void set(GLuint unit) const { mGl.ActiveTexture(GL_TEXTURE0 + unit); }

private:
    const GladGLContext& mGl;
    GLint mHost = GL_TEXTURE0;
};

} // namespace

TextureUnitGuard::TextureUnitGuard(DeviceState& device, GLuint first, GLuint count)
    : mDevice(device)
    , mFirst(first)
    , mUnits(count) {
    static_assert(kTextureTargets.size() == kTargetCount);
    const GladGLContext& gl = device.gl;
    const ActiveUnit active(gl);
    for (GLuint i = 0; i < count; ++i) {
        active.set(first + i);
        for (std::size_t t = 0; t < kTargetCount; ++t)
            gl.GetIntegerv(kTextureTargets[t].binding, &mUnits[i].textures[t]);
        gl.GetIntegerv(GL_SAMPLER_BINDING, &mUnits[i].sampler);
    }
}

TextureUnitGuard::~TextureUnitGuard() {
    const GladGLContext& gl = mDevice.gl;
    const ActiveUnit active(gl);
    for (GLuint i = 0; i < mUnits.size(); ++i) {
        active.set(mFirst + i);
        // glBindTextureUnit() with 0 clears every target of the unit, so every one is put back.
        for (std::size_t t = 0; t < kTargetCount; ++t)
            gl.BindTexture(kTextureTargets[t].target, static_cast<GLuint>(mUnits[i].textures[t]));
        gl.BindSampler(mFirst + i, static_cast<GLuint>(mUnits[i].sampler));
    }
}

ImageUnitGuard::ImageUnitGuard(DeviceState& device, GLuint count)
    : mDevice(device)
    , mUnits(count) {
    const GladGLContext& gl = device.gl;
    for (GLuint i = 0; i < count; ++i) {
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

DrawBufferGuard::DrawBufferGuard(DeviceState& device, GLuint storageBuffers)
    : mDevice(device)
    , mStorageBuffers(device.gl, GL_SHADER_STORAGE_BUFFER, storageBuffers) {
    device.gl.GetIntegerv(GL_DRAW_INDIRECT_BUFFER_BINDING, &mIndirect);
}

DrawBufferGuard::~DrawBufferGuard() {
    mStorageBuffers.restore(mDevice.gl);
    mDevice.gl.BindBuffer(GL_DRAW_INDIRECT_BUFFER, static_cast<GLuint>(mIndirect));
}

} // namespace lamina::gl
