#include "gl/support/fog_trial.hpp"

#include <lamina/voxelize/geometry_source.hpp>

#include <algorithm>
#include <stdexcept>

namespace lamina::test {

using reference::FogErrors;

FogTrial::FogTrial(const Device& device, const GladGLContext& gl, const reference::FogStudy& study,
                   const glm::uvec2& pixels, std::uint32_t virtualLights, std::uint32_t steps)
    : mDevice(device)
    , mGl(gl)
    , mStudy(study)
    , mScene(gl, study.mesh, study.camera, pixels)
    , mBuffers(MeshBuffers::upload(device, study.mesh).value())
    , mSteps(steps)
    , mLights(sampleVirtualLights(study.light, virtualLights).value()) {
    // The parts of few lights are the largest.
    constexpr std::uint32_t kFew = 64;
    const auto few = sampleVirtualLights(study.light, std::min(virtualLights, kFew)).value();
    for (std::size_t i = 0; i < mScene.pixelCount(); ++i)
        if (!mScene.isSky(i) && !reference::passesLight(mScene.eye(), mScene.point(i), few))
            mPixels.push_back(i);
    mFactored.resize(mPixels.size());
    mUnshadowed.resize(mPixels.size());
    mTruth = reference::forEach(mPixels.size(), [&](std::size_t i) {
        const reference::FogRay ray = reference::marchFog(
            &mScene.rays(), mLights, study.medium, mScene.eye(), mScene.point(mPixels[i]), steps);
        mFactored[i] = ray.factored();
        mUnshadowed[i] = ray.unshadowed;
        return ray.airlight;
    });
}

FogTrial::~FogTrial() = default;

FogTrial::Errors FogTrial::gather(const AreaLightDesc& desc, bool hasNormals) {
    AreaLight effect = AreaLight::create(mDevice, desc).value();
    const GeometrySource source = mBuffers.view();
    SurfaceTextures surfaces = mScene.surfaces();
    surfaces.normal = hasNormals ? surfaces.normal : 0;
    Errors errors;
    errors.times.fill(1e30);
    for (int frame = 0; frame < (desc.measure ? 4 : 1); ++frame) {
        const auto stats = effect.prepare(mScene.view(), mStudy.light, mStudy.medium, {&source, 1});
        if (!stats)
            throw std::runtime_error(stats.error().text);
        const auto picture = effect.apply(mScene.view(), surfaces);
        if (!picture)
            throw std::runtime_error(picture.error().text);
        mGl.Finish();
        const AreaLightTimes times = effect.times();
        for (std::size_t i = 0; frame > 0 && i < times.size(); ++i)
            errors.times[i] = std::min(errors.times[i], times[i]);
    }
    const auto sums = mScene.read(effect.sums()[0]);
    const double scattering =
        static_cast<double>(mStudy.medium.albedo.x * mStudy.medium.extinction);
    mFound.clear();
    for (const std::size_t pixel : mPixels)
        mFound.push_back(static_cast<double>(sums[pixel].x) / scattering);
    errors.truth = reference::fogErrors(mFound, mTruth, mUnshadowed);
    errors.factored = reference::relativeRmse(mFound, mFactored);
    const auto transforms = effect.volumes().front().transforms();
    mVolumes.assign(transforms.begin(), transforms.end());
    const auto lights = effect.virtualLights();
    mVolumeLights.assign(lights.begin(), lights.end());
    return errors;
}

std::vector<double> FogTrial::perfectAirlight(const reference::VoxelSteps& voxels) const {
    return reference::forEach(mPixels.size(), [&](std::size_t i) {
        double sum = 0.0;
        for (std::size_t light = 0; light < mVolumes.size(); ++light)
            sum += static_cast<double>(mVolumeLights[light].intensity.x) *
                   reference::marchVoxels(mScene.rays(), mVolumeLights[light], mVolumes[light],
                                          mStudy.medium, mScene.point(mPixels[i]), mSteps, voxels);
        return sum;
    });
}

FogErrors FogTrial::perfect(const reference::VoxelSteps& voxels) const {
    return reference::fogErrors(perfectAirlight(voxels), mTruth, mUnshadowed);
}

FogErrors FogTrial::factoring() const {
    return reference::fogErrors(mFactored, mTruth, mUnshadowed);
}

} // namespace lamina::test
