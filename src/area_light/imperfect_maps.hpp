#pragma once

#include "gl/device_state.hpp"

#include "area_light/hole_filler.hpp"
#include "area_light/point_samples.hpp"

#include <lamina/area_light/area_light.hpp>

#include <span>
#include <vector>

namespace lamina {

/// Imperfect shadow maps: point samples splatted into the maps of all virtual lights at once, and
/// their holes filled ([WD13] 3.1.2). The maps are the layers of one texture, not the tiles of one
/// layer as in the paper: all are written by one dispatch alike, maps of any size and number fit
/// the device's limits, and no disk can reach across a map's edge into its neighbour.
class LAMINA_API ImperfectMapMaker {
public:
    /// Errors: ShaderError.
    [[nodiscard]] static Result<ImperfectMapMaker> create(std::shared_ptr<gl::DeviceState> device,
                                                          const AreaLightDesc& desc);

    /// Can imperfect maps serve these lights? Lambertian and directional ones, all of one kind.
    [[nodiscard]] static bool canServe(std::span<const VirtualLight> lights);

    /// Checks the sources and makes room for this many maps, before any work.
    /// Errors: those of PointSamples::prepare(), DeviceLimit.
    [[nodiscard]] Result<void> prepare(std::span<const GeometrySource> sources, std::uint32_t maps);
    /// A map a light, for EpipolarVoxelizer; valid until the next call. After prepare() for them.
    /// transforms: of the lights' volumes. Errors: those of PointSamples::draw().
    [[nodiscard]] Result<std::vector<LightDepthMap>>
    make(std::span<const GeometrySource> sources, std::span<const VirtualLight> lights,
         std::span<const EpipolarTransform> transforms);

    [[nodiscard]] std::uint64_t bytes() const { return mSamples.bytes() + mMaps.bytes(); }

private:
    ImperfectMapMaker(std::shared_ptr<gl::DeviceState> device, const AreaLightDesc& desc,
                      PointSamples samples, HoleFiller filler);
    [[nodiscard]] Result<void> reserve(std::uint32_t maps);
    void clear(std::uint32_t maps);
    void splat(std::uint32_t maps, bool isDirectional);

    std::shared_ptr<gl::DeviceState> mDevice;
    AreaLightDesc mDesc;
    PointSamples mSamples;
    HoleFiller mFiller;
    GLuint mSplatPrograms[2] = {}; ///< Of hemispheres, of directional lights.
    gl::Buffer mConstants;
    gl::Buffer mFrames;
    gl::Texture mMaps;
    std::uint32_t mLayers = 0;
};

} // namespace lamina
