#include "area_light/imperfect_maps.hpp"
#include "area_light/light_buffer.hpp"
#include "area_light/light_gather.hpp"
#include "area_light/stage_timers.hpp"
#include "area_light/volume_plan.hpp"
#include "core/check_enumeration.hpp"
#include "voxelize/epipolar_constants.hpp"

#include <lamina/area_light/area_light.hpp>
#include <lamina/voxelize/epipolar_voxelizer.hpp>

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <variant>

namespace lamina {
namespace {

Error invalid(const std::string& text) {
    return {ErrorCode::InvalidArgument, "area light: " + text};
}

template<class Value>
Error outOfRange(const char* what, const char* range, Value found) {
    return invalid("expected " + std::string(what) + " in " + range + ", found " +
                   std::to_string(found));
}

Result<void> checkChoices(const AreaLightDesc& desc) {
    for (const auto& known :
         {checkEnumeration("area light", "ShadowMaps", desc.maps, ShadowMaps::Imperfect),
          checkEnumeration("area light", "ShadowVolumeLayout", desc.layout,
                           ShadowVolumeLayout::Separate),
          checkEnumeration("area light", "AirlightForm", desc.airlight, AirlightForm::Factored),
          checkEnumeration("area light", "GatherMode", desc.gather, GatherMode::Quarter)})
        if (!known)
            return known;
    return {};
}

/// Of a single volume: how many fit a device is known in prepare().
Result<void> checkVoxels(const AreaLightDesc& desc) {
    const glm::uvec3 most(LAMINA_EPIPOLAR_MAX_ALPHA, 1u << 14u, 1u << 16u);
    for (int axis = 0; axis < 3; ++axis)
        if (desc.voxels[axis] == 0 || desc.voxels[axis] > most[axis])
            return invalid("expected voxels in [1, " + std::to_string(most.x) + "] x [1, " +
                           std::to_string(most.y) + "] x [1, " + std::to_string(most.z) +
                           "], found " + std::to_string(desc.voxels.x) + " x " +
                           std::to_string(desc.voxels.y) + " x " + std::to_string(desc.voxels.z));
    return {};
}

Result<void> checkDesc(const AreaLightDesc& desc) {
    constexpr std::uint32_t kMostLights = 1024;
    if (desc.virtualLights == 0 || desc.virtualLights > kMostLights)
        return outOfRange("virtualLights", "[1, 1024]", desc.virtualLights);
    constexpr std::uint32_t kLeastPoints = 1024;
    constexpr std::uint32_t kMostPoints = 1u << 24u;
    const ImperfectMaps& maps = desc.imperfect;
    if (maps.points < kLeastPoints || maps.points > kMostPoints)
        return outOfRange("imperfect.points", "[1024, 2^24]", maps.points);
    if (maps.pointsPerMap == 0 || maps.pointsPerMap > maps.points)
        return outOfRange("imperfect.pointsPerMap", "[1, imperfect.points]", maps.pointsPerMap);
    constexpr std::uint32_t kLeastTexels = 4;
    constexpr std::uint32_t kMostTexels = 8192;
    if (desc.mapTexels < kLeastTexels || desc.mapTexels > kMostTexels)
        return outOfRange("mapTexels", "[4, 8192]", desc.mapTexels);
    const auto isDistance = [](double value) { return std::isfinite(value) && value >= 0.0; };
    if (!isDistance(desc.farDistance) || !isDistance(desc.skyDistance))
        return invalid("expected finite distances of at least 0, found farDistance " +
                       std::to_string(desc.farDistance) + ", skyDistance " +
                       std::to_string(desc.skyDistance));
    if (!isDistance(desc.specularExponent))
        return outOfRange("specularExponent", "[0, infinity)", desc.specularExponent);
    if (!isDistance(desc.specularStrength))
        return outOfRange("specularStrength", "[0, infinity)", desc.specularStrength);
    constexpr std::uint32_t kMostHoleLevels = 13;
    if (maps.holeLevels > kMostHoleLevels)
        return outOfRange("imperfect.holeLevels", "[0, 13]", maps.holeLevels);
    if (auto known = checkChoices(desc); !known)
        return known;
    return checkVoxels(desc);
}

Result<void> checkMedium(const Medium& medium) {
    if (!(medium.extinction >= 0.0f) || !std::isfinite(medium.extinction))
        return outOfRange("a medium's extinction", "[0, infinity)", medium.extinction);
    for (int i = 0; i < 3; ++i)
        if (!(medium.albedo[i] >= 0.0f && medium.albedo[i] <= 1.0f))
            return outOfRange("a medium's albedo", "[0, 1]", medium.albedo[i]);
    if (!(std::abs(medium.anisotropy) < 1.0f))
        return outOfRange("a medium's anisotropy", "(-1, 1)", medium.anisotropy);
    return {};
}

std::uint32_t textureOf(const LightSource& light) {
    if (const auto* rectangle = std::get_if<RectangleLight>(&light))
        return rectangle->emission.texture;
    if (const auto* environment = std::get_if<EnvironmentLight>(&light))
        return environment->emission.texture;
    return 0;
}

} // namespace

std::string_view name(AreaLightStage stage) {
    constexpr std::string_view kNames[kAreaLightStageCount] = {"lights", "maps",   "voxelize",
                                                               "scan",   "gather", "composite"};
    return kNames[static_cast<std::size_t>(stage)];
}

struct AreaLight::Impl {
    Impl(const Device& onDevice, const AreaLightDesc& wanted, LightBuffer buffer,
         std::unique_ptr<LightGather> gatherer, EpipolarVoxelizer volumeMaker,
         ImperfectMapMaker imperfectMaps)
        : device(onDevice.state())
        , desc(wanted)
        , lights(std::move(buffer))
        , gather(std::move(gatherer))
        , voxelizer(std::move(volumeMaker))
        , maps(std::move(imperfectMaps))
        , timers(device, wanted.measure) {}

    /// A frame's lights and where their volumes are, before GL work begins.
    struct Plan {
        std::vector<VirtualLight> lights;
        std::vector<EpipolarTransform> transforms;
        double skyDistance = 0.0;
    };
    using Sources = std::variant<std::span<const GeometrySource>, std::span<const LightDepthMap>>;

    [[nodiscard]] Result<Plan> plan(const View& view, const LightSource& light,
                                    const Medium& medium) const;
    [[nodiscard]] bool usesImperfectMaps(const Plan& plan) const;
    [[nodiscard]] Result<AreaLightStats> prepare(Plan plan, const LightSource& light,
                                                 const Medium& medium, Sources sources);
    /// Grids that a plan's volumes take.
    [[nodiscard]] std::size_t gridCount(const Plan& plan) const {
        return desc.layout == ShadowVolumeLayout::Separate ? plan.transforms.size() : 1;
    }
    [[nodiscard]] Result<std::vector<LightDepthMap>>
    makeImperfectMaps(const Plan& plan, std::span<const GeometrySource> sources);
    [[nodiscard]] Result<void> makeVolumes(const Plan& plan, const Sources& sources,
                                           AreaLightStats& stats);
    [[nodiscard]] Result<std::uint32_t> apply(const View& view, const SurfaceTextures& surfaces,
                                              std::uint32_t target);

    std::shared_ptr<gl::DeviceState> device;
    AreaLightDesc desc;
    LightBuffer lights;
    std::unique_ptr<LightGather> gather;
    EpipolarVoxelizer voxelizer;
    ImperfectMapMaker maps;
    StageTimers timers;
    std::vector<EpipolarGrid> grids;
    Plan current;
};

Result<AreaLight::Impl::Plan> AreaLight::Impl::plan(const View& view, const LightSource& light,
                                                    const Medium& medium) const {
    if (auto sound = checkMedium(medium); !sound)
        return sound.error();
    const auto eye = makeEyeCamera(view, desc.farDistance);
    if (!eye)
        return eye.error();
    auto sampled = sampleVirtualLights(light, desc.virtualLights);
    if (!sampled)
        return sampled.error();
    auto transforms = planVolumes(*eye, *sampled, desc);
    if (!transforms)
        return transforms.error();
    // Far enough that the rest of an infinite ray adds nothing to single precision.
    constexpr double kInfinitelyFar = 1e4;
    double sky = eye->far;
    for (const EpipolarTransform& transform : *transforms)
        sky = std::max(sky, transform.lightDistance());
    sky = desc.skyDistance > 0.0 ? std::max(desc.skyDistance, eye->far) : kInfinitelyFar * sky;
    return Plan{std::move(*sampled), std::move(*transforms), sky};
}

bool AreaLight::Impl::usesImperfectMaps(const Plan& plan) const {
    constexpr std::size_t kMostRendered = 16;
    const bool isWanted =
        desc.maps == ShadowMaps::Imperfect ||
        (desc.maps == ShadowMaps::Automatic && plan.lights.size() > kMostRendered);
    return isWanted && ImperfectMapMaker::canServe(plan.lights);
}

Result<void> AreaLight::Impl::makeVolumes(const Plan& plan, const Sources& sources,
                                          AreaLightStats& stats) {
    const std::span<const EpipolarTransform> transforms = plan.transforms;
    const std::size_t perGrid = transforms.size() / gridCount(plan);
    const auto rectify = [&](std::size_t grid) {
        const auto own = transforms.subspan(grid * perGrid, perGrid);
        if (const auto* hostMaps = std::get_if<std::span<const LightDepthMap>>(&sources))
            return voxelizer.rectify(hostMaps->subspan(grid * perGrid, perGrid), own, grids[grid]);
        return voxelizer.rectify(std::get<std::span<const GeometrySource>>(sources), own,
                                 grids[grid]);
    };
    {
        const StageTimers::Scope scope(timers, AreaLightStage::Voxelize);
        for (std::size_t i = 0; i < gridCount(plan); ++i) {
            const auto done = rectify(i);
            if (!done)
                return done.error();
            // From here on the volumes of the last frame are being replaced.
            current = Plan{};
            stats.shadowMaps += done->depthMaps;
            stats.volumeBytes += done->gridBytes;
            stats.mapBytes = std::max(stats.mapBytes, done->depthBytes);
        }
    }
    const StageTimers::Scope scope(timers, AreaLightStage::Scan);
    for (std::size_t i = 0; i < gridCount(plan); ++i)
        if (auto done = voxelizer.scan(grids[i]); !done)
            return done;
    return {};
}

Result<std::vector<LightDepthMap>>
AreaLight::Impl::makeImperfectMaps(const Plan& plan, std::span<const GeometrySource> sources) {
    const auto count = static_cast<std::uint32_t>(plan.lights.size());
    if (auto ready = maps.prepare(sources, count); !ready)
        return ready.error();
    // Room for the volumes, too, before any work. Those of the last frame are lost to it only where
    // it takes other memory.
    const std::span<const EpipolarTransform> transforms = plan.transforms;
    const std::size_t perGrid = transforms.size() / gridCount(plan);
    for (std::size_t i = 0; i < gridCount(plan); ++i) {
        if (grids[i].transforms().size() >= perGrid)
            continue;
        if (auto room = grids[i].resize(transforms.subspan(i * perGrid, perGrid)); !room)
            return room.error();
        current = Plan{};
    }
    const StageTimers::Scope scope(timers, AreaLightStage::Maps);
    return maps.make(sources, plan.lights, plan.transforms);
}

Result<AreaLightStats> AreaLight::Impl::prepare(Plan plan, const LightSource& light,
                                                const Medium& medium, Sources sources) {
    const gl::DebugGroup group(*device, "lamina: prepare area light");
    if (auto sound = lights.check(textureOf(light)); !sound)
        return sound.error();
    timers.beginFrame();
    AreaLightStats stats;
    stats.virtualLights = static_cast<std::uint32_t>(plan.lights.size());
    std::vector<LightDepthMap> imperfect;
    const auto* geometry = std::get_if<std::span<const GeometrySource>>(&sources);
    const bool isImperfect = geometry && usesImperfectMaps(plan);
    if (isImperfect) {
        auto made = makeImperfectMaps(plan, *geometry);
        if (!made)
            return made.error();
        imperfect = std::move(*made);
        sources = std::span<const LightDepthMap>(imperfect);
    }
    if (auto done = makeVolumes(plan, sources, stats); !done)
        return done.error();
    {
        const StageTimers::Scope scope(timers, AreaLightStage::Lights);
        lights.upload(plan.lights, medium, desc, textureOf(light));
    }
    if (isImperfect) {
        stats.shadowMaps = stats.virtualLights;
        stats.mapBytes = maps.bytes();
    }
    stats.targetBytes = gather->bytes();
    current = std::move(plan);
    return stats;
}

Result<std::uint32_t> AreaLight::Impl::apply(const View& view, const SurfaceTextures& surfaces,
                                             std::uint32_t target) {
    if (current.lights.empty())
        return invalid("apply: expected a prepare() before, found none that succeeded");
    const auto eye = viewpoint(view);
    if (!eye)
        return eye.error();
    const glm::dvec3 prepared = current.transforms.front().eye();
    constexpr double kTolerance = 1e-6;
    const double scale = std::max(glm::length(prepared), current.skyDistance * 1e-4);
    if (eye->w == 0.0 || glm::distance(glm::dvec3(*eye), prepared) > kTolerance * scale)
        return invalid("apply: expected a view from the viewpoint of prepare(), found another; "
                       "prepare the volumes for each viewpoint");
    const LightGather::Frame frame{view,
                                   surfaces,
                                   {grids.data(), gridCount(current)},
                                   lights.id(),
                                   static_cast<std::uint32_t>(current.lights.size()),
                                   current.skyDistance};
    return gather->run(frame, target, timers);
}

AreaLight::AreaLight(std::unique_ptr<Impl> impl)
    : mImpl(std::move(impl)) {}
AreaLight::AreaLight(AreaLight&&) noexcept = default;
AreaLight& AreaLight::operator=(AreaLight&&) noexcept = default;
AreaLight::~AreaLight() = default;

Result<AreaLight> AreaLight::create(const Device& device, const AreaLightDesc& desc) {
    if (auto sound = checkDesc(desc); !sound)
        return sound.error();
    EpipolarVoxelizerDesc volumes;
    volumes.depthMapTexels = desc.mapTexels;
    auto voxelizer = EpipolarVoxelizer::create(device, volumes);
    if (!voxelizer)
        return voxelizer.error();
    auto lights = LightBuffer::create(device.state());
    if (!lights)
        return lights.error();
    auto maps = ImperfectMapMaker::create(device.state(), desc);
    if (!maps)
        return maps.error();
    auto gather = LightGather::create(device.state(), desc);
    if (!gather)
        return gather.error();
    auto impl = std::make_unique<Impl>(device, desc, std::move(*lights), std::move(*gather),
                                       std::move(*voxelizer), std::move(*maps));
    const EpipolarLayout layout{desc.bitsPerTexel, desc.alphaBias, desc.phiBias,
                                desc.epipoleVoxels};
    const bool isSeparate = desc.layout == ShadowVolumeLayout::Separate;
    for (std::uint32_t i = 0; i < (isSeparate ? desc.virtualLights : 1); ++i) {
        auto grid = EpipolarGrid::create(device, layout);
        if (!grid)
            return grid.error();
        impl->grids.push_back(std::move(*grid));
    }
    return AreaLight(std::move(impl));
}

Result<AreaLightStats> AreaLight::prepare(const View& view, const LightSource& light,
                                          const Medium& medium,
                                          std::span<const GeometrySource> sources) {
    auto plan = mImpl->plan(view, light, medium);
    if (!plan)
        return plan.error();
    return mImpl->prepare(std::move(*plan), light, medium, sources);
}

Result<AreaLightStats> AreaLight::prepare(const View& view, const LightSource& light,
                                          const Medium& medium,
                                          std::span<const LightDepthMap> maps) {
    auto plan = mImpl->plan(view, light, medium);
    if (!plan)
        return plan.error();
    if (maps.size() != plan->lights.size())
        return invalid("prepare: expected a shadow map for each of " +
                       std::to_string(plan->lights.size()) + " virtual lights, found " +
                       std::to_string(maps.size()));
    return mImpl->prepare(std::move(*plan), light, medium, maps);
}

Result<std::uint32_t> AreaLight::apply(const View& view, const SurfaceTextures& surfaces) {
    return mImpl->apply(view, surfaces, 0);
}

Result<void> AreaLight::apply(const View& view, const SurfaceTextures& surfaces,
                              std::uint32_t target) {
    if (target == 0)
        return invalid("apply: expected the name of a texture as target, found 0");
    const auto done = mImpl->apply(view, surfaces, target);
    return done ? Result<void>() : Result<void>(done.error());
}

void AreaLight::bind(std::uint32_t volumeBinding, std::uint32_t volumeUnit,
                     std::uint32_t lightBinding) const {
    if (mImpl->current.lights.empty() || mImpl->desc.layout == ShadowVolumeLayout::Separate)
        return;
    mImpl->grids.front().bind(volumeBinding, volumeUnit);
    const GLuint lights = mImpl->lights.id();
    mImpl->device->gl.BindBuffersBase(GL_SHADER_STORAGE_BUFFER, lightBinding, 1, &lights);
}

std::span<const VirtualLight> AreaLight::virtualLights() const {
    return mImpl->current.lights;
}
std::span<const EpipolarGrid> AreaLight::volumes() const {
    const bool isSeparate = mImpl->desc.layout == ShadowVolumeLayout::Separate;
    return {mImpl->grids.data(), isSeparate ? mImpl->current.lights.size() : 1};
}
AreaLightTimes AreaLight::times() {
    return mImpl->timers.latest();
}
std::array<std::uint32_t, 2> AreaLight::sums() const {
    return mImpl->gather->sums();
}
std::uint64_t AreaLight::gpuBytes() const {
    std::uint64_t bytes =
        mImpl->gather->bytes() + mImpl->maps.bytes() + mImpl->voxelizer.gpuBytes();
    for (const EpipolarGrid& grid : mImpl->grids)
        bytes += grid.gpuBytes();
    return bytes;
}

} // namespace lamina
