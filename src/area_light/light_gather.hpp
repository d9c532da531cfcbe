#pragma once

#include "gl/device_state.hpp"
#include "gl/fetch_sampler.hpp"
#include "gl/screen_pass.hpp"

#include "area_light/stage_timers.hpp"

#include <lamina/area_light/area_light.hpp>

#include <array>
#include <span>

namespace lamina {

/// Sums the virtual lights' airlight and surface light over a view's pixels, and puts them over the
/// engine's colours.
class LightGather {
public:
    /// Errors: ShaderError.
    [[nodiscard]] static Result<std::unique_ptr<LightGather>>
    create(std::shared_ptr<gl::DeviceState> device, const AreaLightDesc& desc);

    /// What a frame's passes read.
    struct Frame {
        const View& view;
        const SurfaceTextures& surfaces;
        std::span<const EpipolarGrid> volumes; ///< One for all lights, or one a light.
        GLuint lights = 0;                     ///< LightBuffer.
        std::uint32_t lightCount = 0;
        double skyDistance = 0.0; ///< Finite.
    };
    /// target: of the view's size; 0: a texture of ours, made here. Returns the target.
    /// Errors: InvalidArgument, OutOfMemory; nothing is drawn then.
    [[nodiscard]] Result<GLuint> run(const Frame& frame, GLuint target, StageTimers& timers);

    [[nodiscard]] std::array<std::uint32_t, 2> sums() const {
        return {mSums[0].id(), mSums[1].id()};
    }
    [[nodiscard]] std::uint64_t bytes() const {
        return mSums[0].bytes() + mSums[1].bytes() + mPicture.bytes();
    }

private:
    LightGather(std::shared_ptr<gl::DeviceState> device, const AreaLightDesc& desc);
    [[nodiscard]] Result<void> reserve(const glm::uvec2& view, bool needsPicture);
    [[nodiscard]] Result<void> check(const Frame& frame, GLuint target) const;
    [[nodiscard]] Result<void> checkTexture(GLuint texture, const glm::uvec2& view,
                                            const char* what, bool isDrawnTo) const;
    void gather(const Frame& frame);
    void composite(const Frame& frame, GLuint target);
    void setConstants(const Frame& frame, const glm::uvec4& lights, bool adds);
    void bindInputs(const Frame& frame, bool isComposite) const;
    [[nodiscard]] glm::uvec2 sumsSize(const glm::uvec2& view) const;

    std::shared_ptr<gl::DeviceState> mDevice;
    AreaLightDesc mDesc;
    gl::ScreenPass mScreen;
    gl::Framebuffer mProbe; ///< Tells whether a host's target can be drawn to.
    gl::FetchSampler mSampler;
    GLuint mGatherProgram = 0;
    GLuint mCompositeProgram = 0;
    gl::Buffer mView;
    gl::Buffer mConstants;
    std::array<gl::Texture, 2> mSums;
    gl::Texture mPicture;
    glm::uvec2 mSumsSize{0};
    glm::uvec2 mPictureSize{0};
};

} // namespace lamina
