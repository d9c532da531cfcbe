#pragma once

#include "gl/host_texture.hpp"
#include "gl/state_guard.hpp"
#include "shadow_volumes/caster_draws.hpp"
#include "shadow_volumes/receiver_pass.hpp"

namespace lamina {

/// Finds which layers of which casters are drawn: the slicemap of receivers, the light's shadow
/// map, and the casters' masks and draw commands, all on the GPU.
class LayerFinder {
public:
    LayerFinder(std::shared_ptr<gl::DeviceState> device, const ShadowVolumesDesc& desc);

    /// Builds the programs. Errors: ShaderError.
    [[nodiscard]] Result<void> build();
    /// Makes room for a light of `faces` faces and `casters` casters. On errors what it had is
    /// kept. Errors: OutOfMemory, DeviceLimit.
    [[nodiscard]] Result<void> reserve(std::uint32_t faces, std::uint32_t casters);
    /// frame: a LaminaShadowFrame, of `shadowFrame`. depths: of the scene's view. receivers: of the
    /// scene.
    void find(GLuint frame, const ShadowFrame& shadowFrame, const gl::SampledDepths& depths,
              const ShadowScene& scene, const CasterDraws& casters, ReceiverPass& receivers);

    /// LaminaShadowCaster, one a caster.
    [[nodiscard]] GLuint masks() const { return mMasks.id(); }
    /// LaminaShadowCommand, two a caster: edges, triangles.
    [[nodiscard]] GLuint commands() const { return mCommands.id(); }
    [[nodiscard]] std::uint64_t gpuBytes() const;

private:
    struct Programs {
        GLuint bounds = 0, litmap = 0, blockers = 0, blockerEdges = 0, casterLayers = 0, masks = 0;
    };

    void clear(const CasterDraws& casters);
    void overVisiblePoints(GLuint frame, const ShadowFrame& shadowFrame,
                           const gl::SampledDepths& depths);
    void drawReceivers(const ShadowFrame& shadowFrame, const gl::SampledDepths& depths,
                       const ShadowScene& scene, ReceiverPass& receivers,
                       gl::RasterStateGuard& guard);
    void drawBlockers(const CasterDraws& casters);
    void search(const CasterDraws& casters);
    void searchByReduction(const CasterDraws& casters);
    void searchByQueries(const CasterDraws& casters);
    void settle(GLuint frame, std::uint32_t casters);
    void bindStorage(GLuint receivers) const;

    std::shared_ptr<gl::DeviceState> mDevice;
    ShadowVolumesDesc mDesc;
    Programs mPrograms;
    gl::Buffer mBounds, mSlicemap, mMasks, mCommands, mQueryResults;
    gl::Texture mLightMap, mBlockers, mLightDepths, mLightEdges;
    gl::Framebuffer mLightTarget, mEdgeTarget; ///< The textures.
    gl::Framebuffer mNoTarget;                 ///< As large, nothing attached.
    std::vector<gl::Query> mQueries;
    std::uint32_t mFaces = 0;
    std::uint32_t mCasterCapacity = 0;
};

} // namespace lamina
