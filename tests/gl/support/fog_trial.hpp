#pragma once

#include "gl/support/fog_scene.hpp"

#include <reference/fog_errors.hpp>
#include <reference/fog_scenes.hpp>
#include <reference/fog_voxels.hpp>

#include <vector>

namespace lamina::test {

/// What AreaLight makes of a scene in fog, against ray casting. Pixels of the sky and of eye rays
/// that pass within the light's own parts are left out.
class FogTrial {
public:
    /// study: kept by reference. virtualLights: of which ray casting takes the airlight, in `steps`
    /// a ray and light.
    FogTrial(const Device& device, const GladGLContext& gl, const reference::FogStudy& study,
             const glm::uvec2& pixels, std::uint32_t virtualLights, std::uint32_t steps);
    ~FogTrial();
    FogTrial(const FogTrial&) = delete;
    FogTrial& operator=(const FogTrial&) = delete;

    struct Errors {
        reference::FogErrors truth; ///< Against the integral.
        double factored =
            0.0; ///< RMSE against mean visibility times unshadowed airlight, relative.
        AreaLightTimes times{}; ///< If the desc asks for them: the least of three frames.
    };
    /// hasNormals: surfaces have a normal texture.
    [[nodiscard]] Errors gather(const AreaLightDesc& desc, bool hasNormals = true);
    /// Airlight of the pixels that count through perfect volumes where the last gather's were.
    [[nodiscard]] std::vector<double> perfectAirlight(const reference::VoxelSteps& voxels) const;
    [[nodiscard]] reference::FogErrors perfect(const reference::VoxelSteps& voxels) const;
    /// Of mean visibility times unshadowed airlight by ray casting.
    [[nodiscard]] reference::FogErrors factoring() const;

    [[nodiscard]] const FogScene& scene() const { return mScene; }
    /// Airlight of the last gather, of the pixels that count; and by ray casting.
    [[nodiscard]] const std::vector<double>& found() const { return mFound; }
    [[nodiscard]] const std::vector<double>& truth() const { return mTruth; }
    [[nodiscard]] const std::vector<double>& unshadowed() const { return mUnshadowed; }
    [[nodiscard]] const std::vector<std::size_t>& pixels() const { return mPixels; }

private:
    const Device& mDevice;
    const GladGLContext& mGl;
    const reference::FogStudy& mStudy;
    FogScene mScene;
    MeshBuffers mBuffers;
    std::uint32_t mSteps;
    std::vector<VirtualLight> mLights;
    std::vector<std::size_t> mPixels;
    std::vector<double> mTruth, mFactored, mUnshadowed, mFound;
    std::vector<EpipolarTransform> mVolumes;
    std::vector<VirtualLight> mVolumeLights;
};

} // namespace lamina::test
