#include "shadow_volumes/volume_pass.hpp"

#include "gl/binding_guards.hpp"
#include "gl/fragment_guards.hpp"
#include "gl/state_guard.hpp"
#include "gl/stencil_guard.hpp"

#include <array>

namespace lamina {
namespace {

constexpr const char* kOperation = "shadow volumes";

} // namespace

VolumePass::VolumePass(std::shared_ptr<gl::DeviceState> device, const ShadowVolumesDesc& desc)
    : mDevice(device)
    , mDesc(desc)
    , mScreen(device, "lamina shadow volumes")
    , mVertexArray(gl::VertexArray::create(device, "lamina shadow volumes"))
    , mStencilTarget(gl::Framebuffer::create(device, "lamina shadow volumes"))
    , mOverdrawTarget(gl::Framebuffer::create(device, "lamina stencil overdraw")) {
    device->gl.NamedFramebufferDrawBuffer(mStencilTarget.id(), GL_NONE);
}

Result<void> VolumePass::build() {
    const auto volume = [this](GLuint& program, const char* geometry) {
        auto built =
            gl::findOrBuildProgram(*mDevice, {kOperation,
                                              {{GL_VERTEX_SHADER, "shadow_volumes/caster.vert"},
                                               {GL_GEOMETRY_SHADER, geometry},
                                               {GL_FRAGMENT_SHADER, "shadow_volumes/volume.frag"}},
                                              {}});
        program = built ? *built : 0;
        return built;
    };
    const auto screen = [this](GLuint& program, const char* fragment) {
        auto built = gl::findOrBuildProgram(
            *mDevice, {kOperation,
                       {{GL_VERTEX_SHADER, "gl/screen.vert"}, {GL_FRAGMENT_SHADER, fragment}},
                       {}});
        program = built ? *built : 0;
        return built;
    };
    const std::array built = {volume(mSides, "shadow_volumes/volume_sides.geom"),
                              volume(mCaps, "shadow_volumes/volume_caps.geom"),
                              screen(mCopy, "shadow_volumes/depth_copy.frag"),
                              screen(mLit, "shadow_volumes/lit.frag")};
    for (const auto& program : built)
        if (!program)
            return program.error();
    return {};
}

Result<void> VolumePass::resize(const glm::uvec2& size) {
    if (size == mSize)
        return {};
    auto depthStencil = gl::createTexture2d(mDevice, GL_DEPTH32F_STENCIL8, 8, size.x, size.y,
                                            kOperation, "lamina shadow stencil");
    if (!depthStencil)
        return depthStencil.error();
    auto light =
        gl::createTexture2d(mDevice, GL_R8, 1, size.x, size.y, kOperation, "lamina shadow light");
    if (!light)
        return light.error();
    mDepthStencil = std::move(*depthStencil);
    mLight = std::move(*light);
    mOverdraw = {};
    const GladGLContext& gl = mDevice->gl;
    gl.TextureParameteri(mDepthStencil.id(), GL_DEPTH_STENCIL_TEXTURE_MODE, GL_STENCIL_INDEX);
    gl.NamedFramebufferTexture(mStencilTarget.id(), GL_DEPTH_STENCIL_ATTACHMENT, mDepthStencil.id(),
                               0);
    mSize = size;
    return {};
}

void VolumePass::bindFrame(const VolumeFrame& frame) const {
    const GladGLContext& gl = mDevice->gl;
    frame.depths.bind(gl, LAMINA_SHADOW_DEPTH_UNIT);
    gl.BindBuffersBase(GL_UNIFORM_BUFFER, LAMINA_SHADOW_FRAME_BINDING, 1, &frame.constants);
    gl.BindBuffersBase(GL_SHADER_STORAGE_BUFFER, LAMINA_SHADOW_CASTER_BINDING, 1, &frame.masks);
    gl.BindBuffer(GL_DRAW_INDIRECT_BUFFER, frame.commands);
    gl.ViewportIndexedf(0, 0.0f, 0.0f, static_cast<float>(mSize.x), static_cast<float>(mSize.y));
}

void VolumePass::copyDepth() {
    const GladGLContext& gl = mDevice->gl;
    gl.Disable(GL_STENCIL_TEST);
    gl.Disable(GL_DEPTH_CLAMP);
    gl.DepthFunc(GL_ALWAYS);
    gl.BindVertexArray(mVertexArray.id());
    gl.UseProgram(mCopy);
    gl.DrawArrays(GL_TRIANGLES, 0, 3);
    gl.Enable(GL_STENCIL_TEST);
}

void VolumePass::drawPart(const VolumeFrame& frame, VolumeExtent extent, CasterPart part) {
    const GladGLContext& gl = mDevice->gl;
    gl.UseProgram(part == CasterPart::Edges ? mSides : mCaps);
    for (std::uint32_t i = 0; i < frame.casters->size(); ++i) {
        const std::size_t command = 2 * std::size_t{i} + (part == CasterPart::Edges ? 0 : 1);
        if (extent == VolumeExtent::Whole)
            frame.casters->draw(i, part, extent, {});
        else
            frame.casters->draw(i, part, extent, command * sizeof(shared::LaminaShadowCommand));
    }
}

void VolumePass::drawVolumes(const VolumeFrame& frame, VolumeExtent extent) {
    const GladGLContext& gl = mDevice->gl;
    // Without near and far planes volumes stay closed.
    gl.Enable(GL_DEPTH_CLAMP);
    gl.ClipControl(GL_LOWER_LEFT, frame.view->clipDepth == ClipDepth::ZeroToOne
                                      ? GL_ZERO_TO_ONE
                                      : GL_NEGATIVE_ONE_TO_ONE);
    gl.DepthRangeIndexed(0, frame.view->depthRange.x, frame.view->depthRange.y);
    if (mDesc.clipVolumes && extent == VolumeExtent::Kept) {
        gl.Enable(GL_CLIP_DISTANCE0);
        gl.Enable(GL_CLIP_DISTANCE1);
    }
    frame.casters->bind();
    drawPart(frame, extent, CasterPart::Edges);
    drawPart(frame, extent, CasterPart::Triangles);
    gl.Disable(GL_CLIP_DISTANCE0);
    gl.Disable(GL_CLIP_DISTANCE1);
}

GLuint VolumePass::light(const VolumeFrame& frame, VolumeExtent extent) {
    const gl::DebugGroup group(*mDevice, "lamina: shadow volumes");
    const GladGLContext& gl = mDevice->gl;
    const gl::TextureUnitGuard textures(*mDevice, 0, LAMINA_SHADOW_TEXTURE_UNITS);
    const gl::DrawBufferGuard buffers(*mDevice, LAMINA_SHADOW_STORAGE_BINDINGS);
    gl::RasterStateGuard guard(*mDevice, 2);
    guard.setHostPrimitiveRestart(false);
    bindFrame(frame);
    {
        const gl::DepthStateGuard depthGuard(*mDevice, GL_ALWAYS);
        const gl::StencilStateGuard stencilGuard(*mDevice);
        gl.StencilMask(0xff);
        gl.BindFramebuffer(GL_DRAW_FRAMEBUFFER, mStencilTarget.id());
        gl.ClearNamedFramebufferfi(mStencilTarget.id(), GL_DEPTH_STENCIL, 0, 1.0f, 0);
        copyDepth();
        gl.DepthMask(GL_FALSE);
        gl.DepthFunc(frame.view->backgroundDepth > 0.5f ? GL_LESS : GL_GREATER);
        gl.StencilFunc(GL_ALWAYS, 0, 0xff);
        gl.StencilOpSeparate(GL_FRONT, GL_KEEP, GL_DECR_WRAP, GL_KEEP);
        gl.StencilOpSeparate(GL_BACK, GL_KEEP, GL_INCR_WRAP, GL_KEEP);
        drawVolumes(frame, extent);
    }
    gl.BindTextureUnit(LAMINA_SHADOW_STENCIL_UNIT, mDepthStencil.id());
    gl.BindSampler(LAMINA_SHADOW_STENCIL_UNIT, 0);
    const GLuint target = mLight.id();
    mScreen.draw(mLit, {&target, 1}, mSize);
    return target;
}

Result<GLuint> VolumePass::overdraw(const VolumeFrame& frame, VolumeExtent extent) {
    const gl::DebugGroup group(*mDevice, "lamina: stencil overdraw");
    const GladGLContext& gl = mDevice->gl;
    if (!mOverdraw) {
        auto made = gl::createTexture2d(mDevice, GL_R32F, 4, mSize.x, mSize.y, kOperation,
                                        "lamina stencil overdraw");
        if (!made)
            return made.error();
        mOverdraw = std::move(*made);
        gl.NamedFramebufferTexture(mOverdrawTarget.id(), GL_COLOR_ATTACHMENT0, mOverdraw.id(), 0);
    }
    const gl::TextureUnitGuard textures(*mDevice, LAMINA_SHADOW_DEPTH_UNIT, 1);
    const gl::DrawBufferGuard buffers(*mDevice, LAMINA_SHADOW_STORAGE_BINDINGS);
    gl::RasterStateGuard guard(*mDevice, 2);
    guard.setHostPrimitiveRestart(false);
    const gl::DepthStateGuard depthGuard(*mDevice, GL_ALWAYS);
    const gl::StencilStateGuard stencilGuard(*mDevice);
    const gl::BlendStateGuard blend(*mDevice, 1, gl::Blending::Add);
    bindFrame(frame);
    gl.BindFramebuffer(GL_DRAW_FRAMEBUFFER, mOverdrawTarget.id());
    constexpr std::array<GLfloat, 4> kNone{};
    gl.ClearNamedFramebufferfv(mOverdrawTarget.id(), GL_COLOR, 0, kNone.data());
    drawVolumes(frame, extent);
    return mOverdraw.id();
}

std::uint64_t VolumePass::gpuBytes() const {
    return mDepthStencil.bytes() + mLight.bytes() + mOverdraw.bytes();
}

} // namespace lamina
