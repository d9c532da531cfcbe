#include <lamina/shadow_volumes/shadow_volumes.hpp>

#include "gl/fetch_sampler.hpp"
#include "gl/host_texture.hpp"
#include "gl/state_guard.hpp"
#include "shadow_volumes/layer_search.hpp"
#include "shadow_volumes/volume_pass.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>

namespace lamina {
namespace {

constexpr const char* kOperation = "shadow volumes";

Result<void> check(const ShadowVolumesDesc& desc) {
    const auto invalid = [](const std::string& text) {
        return Error{ErrorCode::InvalidArgument, std::string(kOperation) + ": expected " + text};
    };
    if (desc.search > LayerSearch::Queries)
        return invalid("a value of LayerSearch, found " +
                       std::to_string(static_cast<int>(desc.search)));
    if (desc.layers == 0 || desc.layers > LAMINA_SHADOW_MAX_LAYERS)
        return invalid("1 to 128 layers, found " + std::to_string(desc.layers));
    constexpr std::uint32_t kLeastTexels = 16;
    constexpr std::uint32_t kMostTexels = 8192;
    if (desc.lightMapTexels < kLeastTexels || desc.lightMapTexels > kMostTexels)
        return invalid("16 to 8192 light map texels, found " + std::to_string(desc.lightMapTexels));
    if (!std::isfinite(desc.depthBiasSlope) || !std::isfinite(desc.depthBiasUnits) ||
        desc.depthBiasSlope < 0.0f || desc.depthBiasUnits < 0.0f)
        return invalid("finite depth biases of at least 0, found slope " +
                       std::to_string(desc.depthBiasSlope) + ", units " +
                       std::to_string(desc.depthBiasUnits));
    return {};
}

bool isOcclusionQueryActive(const GladGLContext& gl) {
    for (const GLenum target :
         {GL_SAMPLES_PASSED, GL_ANY_SAMPLES_PASSED, GL_ANY_SAMPLES_PASSED_CONSERVATIVE}) {
        GLint query = 0;
        gl.GetQueryiv(target, GL_CURRENT_QUERY, &query);
        if (query != 0)
            return true;
    }
    return false;
}

} // namespace

struct ShadowVolumes::Impl {
    Impl(std::shared_ptr<gl::DeviceState> state, const ShadowVolumesDesc& settings)
        : device(state)
        , desc(settings)
        , casters(state)
        , finder(state, settings)
        , receivers(state)
        , pass(state, settings)
        , sampler(state)
        , frameBlock(gl::Buffer::create(state, "lamina shadow frame")) {}

    [[nodiscard]] Result<VolumeFrame> frame(std::string_view call) const;
    [[nodiscard]] double countFragments(GLuint overdraw) const;

    std::shared_ptr<gl::DeviceState> device;
    ShadowVolumesDesc desc;
    CasterDraws casters;
    LayerFinder finder;
    ReceiverPass receivers;
    VolumePass pass;
    gl::FetchSampler sampler;
    gl::Buffer frameBlock;
    View view;
    GLuint depthTexture = 0; ///< 0: nothing is prepared.
};

Result<ShadowVolumes> ShadowVolumes::create(const Device& device, const ShadowVolumesDesc& desc) {
    if (auto valid = check(desc); !valid)
        return valid.error();
    auto impl = std::make_unique<Impl>(device.state(), desc);
    if (auto built = impl->finder.build(); !built)
        return built.error();
    if (auto built = impl->pass.build(); !built)
        return built.error();
    return ShadowVolumes(std::move(impl));
}

ShadowVolumes::ShadowVolumes(std::unique_ptr<Impl> impl)
    : mImpl(std::move(impl)) {}
ShadowVolumes::ShadowVolumes(ShadowVolumes&&) noexcept = default;
ShadowVolumes& ShadowVolumes::operator=(ShadowVolumes&&) noexcept = default;
ShadowVolumes::~ShadowVolumes() = default;

Result<void> ShadowVolumes::prepare(const ShadowScene& scene) {
    Impl& impl = *mImpl;
    const GladGLContext& gl = impl.device->gl;
    const auto depthStep =
        gl::depthStep(*impl.device, scene.depthTexture, scene.view.size, kOperation);
    if (!depthStep)
        return depthStep.error();
    const auto frame = makeShadowFrame(scene, impl.desc, *depthStep);
    if (!frame)
        return frame.error();
    if (impl.desc.search == LayerSearch::Queries && isOcclusionQueryActive(gl))
        return Error{ErrorCode::InvalidArgument,
                     std::string(kOperation) +
                         ": expected no active occlusion query for LayerSearch::Queries, found one "
                         "of the host; end it before the call or use LayerSearch::Reduction"};
    if (!impl.desc.litmap && scene.receivers.empty())
        return Error{
            ErrorCode::InvalidArgument,
            std::string(kOperation) +
                ": expected receivers, for a ShadowVolumesDesc without litmap, found none"};
    if (auto valid = impl.casters.check(scene.casters); !valid)
        return valid;
    if (auto valid = impl.receivers.check(scene.receivers); !valid)
        return valid;
    const gl::DebugGroup group(*impl.device, "lamina: shadow volumes, prepare");
    impl.depthTexture = 0; // From here on the frame before is lost.
    const auto faces = frame->constants.size.w;
    const auto casterCount = static_cast<std::uint32_t>(scene.casters.size());
    if (auto reserved = impl.finder.reserve(faces, casterCount); !reserved)
        return reserved.error();
    if (auto resized = impl.pass.resize(scene.view.size); !resized)
        return resized.error();
    if (auto set = impl.receivers.set(scene.receivers, !impl.desc.litmap); !set)
        return set.error();
    if (auto set = impl.casters.set(scene.casters, frame->origin, impl.desc.clipVolumes); !set)
        return set.error();
    gl.NamedBufferData(impl.frameBlock.id(), sizeof frame->constants, &frame->constants,
                       GL_STREAM_DRAW);
    impl.finder.find(impl.frameBlock.id(), *frame, {scene.depthTexture, impl.sampler.id()}, scene,
                     impl.casters, impl.receivers);
    impl.view = scene.view;
    impl.depthTexture = scene.depthTexture;
    return {};
}

Result<VolumeFrame> ShadowVolumes::Impl::frame(std::string_view call) const {
    if (depthTexture == 0)
        return Error{ErrorCode::InvalidArgument,
                     std::string(kOperation) + ": expected prepare() before " + std::string(call) +
                         ", found none that succeeded"};
    return VolumeFrame{
        &view,   {depthTexture, sampler.id()}, frameBlock.id(), finder.masks(), finder.commands(),
        &casters};
}

Result<std::uint32_t> ShadowVolumes::apply(VolumeExtent extent) {
    const auto frame = mImpl->frame("apply()");
    if (!frame)
        return frame.error();
    return mImpl->pass.light(*frame, extent);
}

Result<std::uint32_t> ShadowVolumes::overdraw(VolumeExtent extent) {
    const auto frame = mImpl->frame("overdraw()");
    if (!frame)
        return frame.error();
    return mImpl->pass.overdraw(*frame, extent);
}

double ShadowVolumes::Impl::countFragments(GLuint overdraw) const {
    const gl::PixelPackGuard pack(*device);
    std::vector<float> counts(std::size_t{view.size.x} * view.size.y);
    device->gl.GetTextureImage(overdraw, 0, GL_RED, GL_FLOAT,
                               static_cast<GLsizei>(counts.size() * sizeof(float)), counts.data());
    return std::accumulate(counts.begin(), counts.end(), 0.0);
}

Result<ShadowVolumesReport> ShadowVolumes::downloadReport() {
    Impl& impl = *mImpl;
    const auto frame = impl.frame("downloadReport()");
    if (!frame)
        return frame.error();
    ShadowVolumesReport report;
    for (const VolumeExtent extent : {VolumeExtent::Kept, VolumeExtent::Whole}) {
        const auto drawn = impl.pass.overdraw(*frame, extent);
        if (!drawn)
            return drawn.error();
        const auto fragments = static_cast<std::uint64_t>(impl.countFragments(*drawn));
        (extent == VolumeExtent::Kept ? report.stencilFragments : report.stencilFragmentsWhole) =
            fragments;
    }
    report.casters = impl.casters.size();
    report.layers = impl.desc.layers;
    report.receivers = impl.receivers.size();
    std::vector<GLuint> seen(report.receivers);
    if (!seen.empty())
        impl.device->gl.GetNamedBufferSubData(impl.receivers.flags(), 0,
                                              static_cast<GLsizeiptr>(seen.size() * sizeof(GLuint)),
                                              seen.data());
    report.receiversCulled = static_cast<std::uint32_t>(std::ranges::count(seen, 0u));
    std::vector<shared::LaminaShadowCaster> masks(report.casters);
    if (!masks.empty())
        impl.device->gl.GetNamedBufferSubData(
            impl.finder.masks(), 0, static_cast<GLsizeiptr>(masks.size() * sizeof masks[0]),
            masks.data());
    for (const shared::LaminaShadowCaster& mask : masks) {
        std::bitset<128> layers;
        for (int word = 3; word >= 0; --word)
            layers = (layers << 32) | std::bitset<128>(mask.layers[word]);
        report.castersCulled += layers.none() ? 1 : 0;
        report.castersShadowed += mask.state.x == 0 ? 1 : 0;
        report.layersKept += layers.count();
        report.keptLayers.push_back(layers);
    }
    return report;
}

std::uint64_t ShadowVolumes::gpuBytes() const {
    return mImpl->finder.gpuBytes() + mImpl->pass.gpuBytes();
}

} // namespace lamina
