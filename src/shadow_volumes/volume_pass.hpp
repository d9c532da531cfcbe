#pragma once

#include "gl/host_texture.hpp"
#include "gl/screen_pass.hpp"
#include "shadow_volumes/caster_draws.hpp"

namespace lamina {

/// What a pass over the shadow volumes needs of the frame.
struct VolumeFrame {
    const View* view = nullptr;
    gl::SampledDepths depths;
    GLuint constants = 0; ///< LaminaShadowFrame.
    GLuint masks = 0;     ///< LaminaShadowCaster, one a caster.
    GLuint commands = 0;  ///< LaminaShadowCommand, two a caster.
    const CasterDraws* casters = nullptr;
};

/// Draws shadow volumes into a stencil buffer over the engine's depths, and into a map of overdraw.
class VolumePass {
public:
    VolumePass(std::shared_ptr<gl::DeviceState> device, const ShadowVolumesDesc& desc);

    /// Builds the programs. Errors: ShaderError.
    [[nodiscard]] Result<void> build();
    /// Makes textures of a view's size. Errors: OutOfMemory, DeviceLimit; what it had is kept.
    [[nodiscard]] Result<void> resize(const glm::uvec2& size);

    /// R8: 1 lit, 0 in shadow.
    [[nodiscard]] GLuint light(const VolumeFrame& frame, VolumeExtent extent);
    /// R32F: stencil fragments of each pixel. Errors: OutOfMemory.
    [[nodiscard]] Result<GLuint> overdraw(const VolumeFrame& frame, VolumeExtent extent);
    [[nodiscard]] std::uint64_t gpuBytes() const;

private:
    void bindFrame(const VolumeFrame& frame) const;
    void copyDepth();
    void drawVolumes(const VolumeFrame& frame, VolumeExtent extent);
    void drawPart(const VolumeFrame& frame, VolumeExtent extent, CasterPart part);

    std::shared_ptr<gl::DeviceState> mDevice;
    ShadowVolumesDesc mDesc;
    gl::ScreenPass mScreen;
    gl::VertexArray mVertexArray;
    gl::Framebuffer mStencilTarget;
    gl::Framebuffer mOverdrawTarget;
    gl::Texture mDepthStencil, mLight, mOverdraw;
    glm::uvec2 mSize{0};
    GLuint mCopy = 0, mSides = 0, mCaps = 0, mLit = 0;
};

} // namespace lamina
