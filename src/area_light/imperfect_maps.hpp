#pragma once

#include "gl/device_state.hpp"

#include "area_light/point_samples.hpp"

#include <lamina/area_light/area_light.hpp>

#include <span>
#include <vector>

namespace lamina {

/// Imperfect shadow maps: point samples splatted into the maps of all virtual lights at once, and
/// their holes filled ([WD13] 3.1.2). The maps are the layers of one texture.
class LAMINA_API ImperfectMapMaker {
public:
    /// Errors: ShaderError.
    [[nodiscard]] static Result<ImperfectMapMaker> create(std::shared_ptr<gl::DeviceState> device,
                                                          const AreaLightDesc& desc);

    /// Can imperfect maps serve these lights? Lambertian and directional ones, all of one kind.
    [[nodiscard]] static bool canServe(std::span<const VirtualLight> lights);

    /// A map a light, for EpipolarVoxelizer; valid until the next call.
    /// transforms: of the lights' volumes. Errors: those of PointSamples::draw(), DeviceLimit.
    [[nodiscard]] Result<std::vector<LightDepthMap>>
    make(std::span<const GeometrySource> sources, std::span<const VirtualLight> lights,
         std::span<const EpipolarTransform> transforms);

    [[nodiscard]] std::uint64_t bytes() const { return mSamples.bytes() + mMaps.bytes(); }

private:
    ImperfectMapMaker(std::shared_ptr<gl::DeviceState> device, const AreaLightDesc& desc,
                      PointSamples samples);
    [[nodiscard]] Result<void> reserve(std::uint32_t maps);
    void clear();
    void splat(std::uint32_t maps, bool isDirectional);
    void fillHoles(std::uint32_t maps);

    std::shared_ptr<gl::DeviceState> mDevice;
    AreaLightDesc mDesc;
    PointSamples mSamples;
    GLuint mSplatPrograms[2] = {}; ///< Of hemispheres, of directional lights.
    GLuint mPullProgram = 0, mPushProgram = 0;
    gl::Buffer mConstants;
    gl::Buffer mFrames;
    gl::Texture mMaps;
    std::uint32_t mLayers = 0;
    /// A level of the pyramid beside the maps.
    struct Level {
        std::uint32_t side = 0;
        glm::uvec2 first{0};
    };
    std::vector<Level> mLevels;
};

} // namespace lamina
