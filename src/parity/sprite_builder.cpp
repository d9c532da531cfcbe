#include "core/check_enumeration.hpp"
#include "gl/binding_guards.hpp"
#include "gl/fragment_guards.hpp"
#include "gl/program_cache.hpp"
#include "gl/state_guard.hpp"
#include "parity/depth_sprite_data.hpp"
#include "parity/parity_constants.hpp"
#include "parity/parity_errors.hpp"
#include "voxelize/slicemap_draw.hpp"

#include <lamina/parity/sprite_builder.hpp>

#include <algorithm>
#include <cstring>
#include <limits>
#include <string>
#include <vector>

namespace lamina {
namespace {

SlicemapStage stage(const char* pass) {
    return {"parity/sprite.frag",
            {{"LAMINA_COVERAGE", "LAMINA_COVERAGE_SAMPLED"}, {"LAMINA_PARITY_PASS", pass}}};
}

/// A pass that wants every crossing of a column's centre line, at any depth.
SlicemapPass allDepths(const SlicemapSources& sources) {
    SlicemapPass pass;
    pass.sources = &sources;
    pass.nearDepth = std::numeric_limits<double>::lowest();
    pass.farDepth = std::numeric_limits<double>::max();
    return pass;
}

SlicemapStage countStage() {
    return stage("LAMINA_PARITY_PASS_COUNT");
}
SlicemapStage layerStage(SpriteMethod method) {
    return stage(method == SpriteMethod::Peeling ? "LAMINA_PARITY_PASS_PEEL"
                                                 : "LAMINA_PARITY_PASS_GATHER");
}

/// An error of what the builder uses, in its words.
Error ownError(const Error& error) {
    return detail::inWordsOf("depth sprite", "use fewer columns", error);
}

Result<void> checkMethod(SpriteMethod method) {
    return checkEnumeration("depth sprite", "SpriteMethod", method, SpriteMethod::Peeling);
}

std::uint32_t evenLayers(std::uint32_t layers) {
    constexpr std::uint32_t kMost = std::numeric_limits<std::uint32_t>::max() - 1;
    return layers > kMost ? kMost : std::max(layers + (layers & 1u), 2u);
}

} // namespace

struct SpriteBuilder::Impl {
    using Sources = std::span<const GeometrySource>;
    using Passes = std::span<const SlicemapPass>;

    explicit Impl(std::shared_ptr<gl::DeviceState> state)
        : device(std::move(state))
        , columns(device)
        , framebuffer(gl::Framebuffer::create(device, "lamina depth sprite"))
        , peelBlocks(gl::Buffer::create(device, "lamina peel constants")) {}

    [[nodiscard]] Result<void> check(const GridTransform& transform) const;
    [[nodiscard]] Result<void> checkLayers(std::uint32_t layers) const;
    [[nodiscard]] Result<GLuint> resolveProgram(bool layered, bool sorted) const;
    [[nodiscard]] Result<void> reserveCounts(const GridTransform& transform);
    void beginDraws(const GridTransform& transform) const;
    void clearCounts() const;
    void draw(Passes passes, std::uint32_t pass, gl::RasterStateGuard& guard);
    void uploadPeelBlocks(std::uint32_t layers);
    void peel(Passes passes, const detail::DepthSpriteData& sprite, gl::RasterStateGuard& guard);
    void resolve(GLuint program, const gl::Buffer& report) const;
    [[nodiscard]] Result<SpriteReport> count(Sources sources, const GridTransform& transform);
    [[nodiscard]] Result<SpriteStats> build(Sources sources, const GridTransform& transform,
                                            std::uint32_t layers, detail::DepthSpriteData& sprite,
                                            SpriteMethod method);

    std::shared_ptr<gl::DeviceState> device;
    SlicemapDraw columns;
    gl::Framebuffer framebuffer;
    gl::Buffer peelBlocks;
    std::size_t peelStride = 0;
    gl::Texture counts; ///< Crossings of each column, or tickets of a peeling pass.
    glm::uvec2 countSize{0};
    gl::Buffer report; ///< Of count().
};

Result<void> SpriteBuilder::Impl::check(const GridTransform& transform) const {
    if (transform.projection() != Projection::Orthographic)
        return Error{ErrorCode::InvalidArgument,
                     "depth sprite: expected an orthographic transform, found " +
                         transform.describe() + "; see fitSprite()"};
    const DeviceLimits& limits = device->limits;
    const std::uint32_t most =
        std::min({limits.maxTextureSize, limits.maxViewportWidth, limits.maxViewportHeight});
    const glm::uvec3 size = transform.size();
    if (size.x > most || size.y > most)
        return Error{ErrorCode::DeviceLimit,
                     "depth sprite: expected at most " + std::to_string(most) + " x " +
                         std::to_string(most) + " columns, found " + std::to_string(size.x) +
                         " x " + std::to_string(size.y) + "; use fewer"};
    return {};
}

Result<void> SpriteBuilder::Impl::checkLayers(std::uint32_t layers) const {
    // One layer more holds the ranges of blocks.
    const std::uint32_t most = (device->limits.maxArrayTextureLayers - 1) & ~1u;
    if (layers > most)
        return Error{ErrorCode::DeviceLimit, "depth sprite: expected at most " +
                                                 std::to_string(most) + " layers, found " +
                                                 std::to_string(layers) +
                                                 " layers; too many crossings, take another "
                                                 "direction or clip the box"};
    return {};
}

Result<GLuint> SpriteBuilder::Impl::resolveProgram(bool layered, bool sorted) const {
    return gl::findOrBuildProgram(*device, {"lamina depth sprite resolve",
                                            {{GL_COMPUTE_SHADER, "parity/resolve.comp"}},
                                            {{"LAMINA_PARITY_LAYERED", layered ? "1" : "0"},
                                             {"LAMINA_PARITY_SORTED", sorted ? "1" : "0"}}});
}

Result<void> SpriteBuilder::Impl::reserveCounts(const GridTransform& transform) {
    const glm::uvec2 size(transform.size());
    if (size == countSize)
        return {};
    auto created = gl::createTextureArray(device, GL_R32UI, sizeof(GLuint), size.x, size.y, 1,
                                          "depth sprite: crossings of columns", "lamina crossings");
    if (!created)
        return created.error();
    counts = std::move(*created);
    countSize = size;
    return {};
}

void SpriteBuilder::Impl::beginDraws(const GridTransform& transform) const {
    const GladGLContext& gl = device->gl;
    const glm::uvec3 size = transform.size();
    // Passes without a target take the framebuffer's default size.
    gl.NamedFramebufferParameteri(framebuffer.id(), GL_FRAMEBUFFER_DEFAULT_WIDTH,
                                  static_cast<GLint>(size.x));
    gl.NamedFramebufferParameteri(framebuffer.id(), GL_FRAMEBUFFER_DEFAULT_HEIGHT,
                                  static_cast<GLint>(size.y));
    gl.BindFramebuffer(GL_DRAW_FRAMEBUFFER, framebuffer.id());
    gl.ViewportIndexedf(0, 0.0f, 0.0f, static_cast<float>(size.x), static_cast<float>(size.y));
    gl.BindImageTexture(LAMINA_PARITY_COUNT_IMAGE, counts.id(), 0, GL_FALSE, 0, GL_READ_WRITE,
                        GL_R32UI);
}

void SpriteBuilder::Impl::clearCounts() const {
    device->gl.MemoryBarrier(GL_TEXTURE_UPDATE_BARRIER_BIT);
    device->gl.ClearTexImage(counts.id(), 0, GL_RED_INTEGER, GL_UNSIGNED_INT, nullptr);
}

void SpriteBuilder::Impl::draw(Passes passes, std::uint32_t pass, gl::RasterStateGuard& guard) {
    columns.draw(passes, pass, guard, [] {});
    device->gl.MemoryBarrier(GL_SHADER_IMAGE_ACCESS_BARRIER_BIT);
}

void SpriteBuilder::Impl::uploadPeelBlocks(std::uint32_t layers) {
    const std::size_t alignment = device->limits.uniformBufferOffsetAlignment;
    peelStride = (sizeof(glm::uvec4) + alignment - 1) / alignment * alignment;
    std::vector<std::byte> bytes(peelStride * layers);
    for (std::uint32_t layer = 0; layer < layers; ++layer) {
        const glm::uvec4 block(layer, 0, 0, 0);
        std::memcpy(bytes.data() + layer * peelStride, &block, sizeof block);
    }
    device->gl.NamedBufferData(peelBlocks.id(), static_cast<GLsizeiptr>(bytes.size()), bytes.data(),
                               GL_STREAM_DRAW);
}

void SpriteBuilder::Impl::peel(Passes passes, const detail::DepthSpriteData& sprite,
                               gl::RasterStateGuard& guard) {
    const GladGLContext& gl = device->gl;
    const gl::BlendStateGuard blend(*device, 1, gl::Blending::Minimum);
    uploadPeelBlocks(sprite.layers);
    for (std::uint32_t layer = 0; layer < sprite.layers; ++layer) {
        gl.NamedFramebufferTextureLayer(framebuffer.id(), GL_COLOR_ATTACHMENT0, sprite.texture.id(),
                                        0, static_cast<GLint>(layer));
        constexpr GLfloat kNothing[] = {LAMINA_PARITY_NO_LAYER, 0.0f, 0.0f, 0.0f};
        gl.ClearNamedFramebufferfv(framebuffer.id(), GL_COLOR, 0, kNothing);
        clearCounts();
        const GLuint buffer = peelBlocks.id();
        const auto offset = static_cast<GLintptr>(layer * peelStride);
        constexpr GLsizeiptr kBytes = sizeof(glm::uvec4);
        gl.BindBuffersRange(GL_UNIFORM_BUFFER, LAMINA_PARITY_PASS_BLOCK_BINDING, 1, &buffer,
                            &offset, &kBytes);
        draw(passes, layer, guard);
    }
    gl.NamedFramebufferTexture(framebuffer.id(), GL_COLOR_ATTACHMENT0, 0, 0);
}

void SpriteBuilder::Impl::resolve(GLuint program, const gl::Buffer& target) const {
    const GladGLContext& gl = device->gl;
    const gl::ComputeStateGuard guard(*device, 0, 1);
    {
        const gl::PixelUnpackGuard unpack(*device);
        gl.ClearNamedBufferData(target.id(), GL_R32UI, GL_RED_INTEGER, GL_UNSIGNED_INT, nullptr);
    }
    const GLuint buffer = target.id();
    gl.BindBuffersBase(GL_SHADER_STORAGE_BUFFER, LAMINA_PARITY_REPORT_BINDING, 1, &buffer);
    gl.UseProgram(program);
    constexpr GLuint kGroup = LAMINA_PARITY_RESOLVE_GROUP;
    gl.DispatchCompute((countSize.x + kGroup - 1) / kGroup, (countSize.y + kGroup - 1) / kGroup, 1);
    gl.MemoryBarrier(GL_TEXTURE_FETCH_BARRIER_BIT | GL_TEXTURE_UPDATE_BARRIER_BIT |
                     GL_SHADER_IMAGE_ACCESS_BARRIER_BIT | GL_FRAMEBUFFER_BARRIER_BIT |
                     GL_BUFFER_UPDATE_BARRIER_BIT);
}

Result<SpriteReport> SpriteBuilder::Impl::count(Sources sources, const GridTransform& transform) {
    if (auto valid = check(transform); !valid)
        return valid.error();
    auto prepared = columns.prepare(sources, transform, countStage());
    if (!prepared)
        return ownError(prepared.error());
    auto program = resolveProgram(false, false);
    if (!program)
        return program.error();
    if (auto reserved = reserveCounts(transform); !reserved)
        return ownError(reserved.error());
    const gl::DebugGroup group(*device, "lamina: count crossings");
    const SlicemapPass pass = allDepths(*prepared);
    columns.upload({&pass, 1}, transform);
    const gl::ImageUnitGuard images(*device, 2);
    {
        gl::RasterStateGuard guard(*device, 2);
        beginDraws(transform);
        clearCounts();
        draw({&pass, 1}, 0, guard);
    }
    resolve(*program, report);
    return detail::downloadReport(*device, report);
}

Result<SpriteStats> SpriteBuilder::Impl::build(Sources sources, const GridTransform& transform,
                                               std::uint32_t layers,
                                               detail::DepthSpriteData& sprite,
                                               SpriteMethod method) {
    if (auto valid = check(transform); !valid)
        return valid.error();
    if (auto fits = checkLayers(layers); !fits)
        return fits.error();
    const bool peels = method == SpriteMethod::Peeling;
    auto prepared = columns.prepare(sources, transform, layerStage(method));
    if (!prepared)
        return ownError(prepared.error());
    auto counting = columns.prepare(sources, transform, countStage());
    if (!counting)
        return ownError(counting.error());
    auto program = resolveProgram(true, peels);
    if (!program)
        return program.error();
    if (auto reserved = reserveCounts(transform); !reserved)
        return ownError(reserved.error());
    auto texture = sprite.allocate(transform, layers);
    if (!texture)
        return ownError(texture.error());
    if (*texture)
        sprite.texture = std::move(*texture);
    if (!sprite.placement || sprite.layers != layers || sprite.transform != transform)
        sprite.placement = std::make_shared<const char>();
    sprite.transform = transform;
    sprite.layers = layers;

    const gl::DebugGroup group(*device, peels ? "lamina: depth sprite (peeling)"
                                              : "lamina: depth sprite (single pass)");
    const GladGLContext& gl = device->gl;
    // Peeling: a pass for each layer, then one that counts.
    std::vector<SlicemapPass> passes(peels ? layers : 1, allDepths(*prepared));
    if (peels)
        passes.push_back(allDepths(*counting));
    columns.upload(passes, transform);
    const gl::ImageUnitGuard images(*device, 2);
    gl.BindImageTexture(LAMINA_PARITY_LAYER_IMAGE, sprite.texture.id(), 0, GL_TRUE, 0,
                        GL_READ_WRITE, GL_R32F);
    {
        gl::RasterStateGuard guard(*device, 2);
        beginDraws(transform);
        if (peels)
            peel(passes, sprite, guard);
        clearCounts();
        draw(passes, static_cast<std::uint32_t>(passes.size() - 1), guard);
    }
    resolve(*program, sprite.report);
    return SpriteStats{peels ? layers + 1 : 1, sprite.texture.bytes() + sprite.report.bytes(),
                       counts.bytes()};
}

SpriteBuilder::SpriteBuilder(std::unique_ptr<Impl> impl)
    : mImpl(std::move(impl)) {}
SpriteBuilder::SpriteBuilder(SpriteBuilder&&) noexcept = default;
SpriteBuilder& SpriteBuilder::operator=(SpriteBuilder&&) noexcept = default;
SpriteBuilder::~SpriteBuilder() = default;

Result<SpriteBuilder> SpriteBuilder::create(const Device& device) {
    auto impl = std::make_unique<Impl>(device.state());
    auto report = detail::createReportBuffer(impl->device);
    if (!report)
        return report.error();
    impl->report = std::move(*report);
    for (const SlicemapStage& stage : {countStage(), layerStage(SpriteMethod::SinglePass)})
        if (auto program = impl->columns.meshProgram(stage); !program)
            return program.error();
    if (auto program = impl->resolveProgram(true, false); !program)
        return program.error();
    return SpriteBuilder(std::move(impl));
}

Result<SpriteStats> SpriteBuilder::build(std::span<const GeometrySource> sources,
                                         const GridTransform& transform, std::uint32_t layers,
                                         DepthSprite& out, SpriteMethod method) {
    if (auto valid = checkMethod(method); !valid)
        return valid.error();
    if (layers == 0)
        return Error{ErrorCode::InvalidArgument,
                     "depth sprite: expected at least 1 layer, found 0; buildAndWait() finds how "
                     "many the shape needs"};
    return mImpl->build(sources, transform, evenLayers(layers), out.data(), method);
}

Result<SpriteReport> SpriteBuilder::buildAndWait(std::span<const GeometrySource> sources,
                                                 const GridTransform& transform, DepthSprite& out,
                                                 SpriteMethod method) {
    if (auto valid = checkMethod(method); !valid)
        return valid.error();
    const auto buildWith = [&](std::uint32_t layers) -> Result<SpriteReport> {
        if (auto built = build(sources, transform, layers, out, method); !built)
            return built.error();
        return out.downloadReport();
    };
    const GridTransform* present = out.transform();
    if (method == SpriteMethod::SinglePass && present &&
        glm::uvec2(present->size()) == glm::uvec2(transform.size())) {
        auto found = buildWith(out.layers());
        if (!found || found->overflowColumns == 0)
            return found;
    }
    auto needed = mImpl->count(sources, transform);
    if (!needed)
        return needed;
    return buildWith(evenLayers(needed->layers));
}

Result<SpriteReport> SpriteBuilder::downloadReport(std::span<const GeometrySource> sources,
                                                   const GridTransform& transform) {
    return mImpl->count(sources, transform);
}

Result<SpriteDirection>
SpriteBuilder::downloadBestDirection(std::span<const GeometrySource> sources, const Box3& bounds,
                                     std::span<const glm::dvec3> directions,
                                     std::uint32_t resolution) {
    if (directions.empty())
        return Error{ErrorCode::InvalidArgument,
                     "best direction of a depth sprite: expected directions, found none"};
    SpriteDirection best;
    for (std::size_t i = 0; i < directions.size(); ++i) {
        auto transform = fitSprite(bounds, directions[i], resolution);
        if (!transform)
            return transform.error();
        auto report = mImpl->count(sources, *transform);
        if (!report)
            return report.error();
        const bool isBetter =
            report->layers < best.report.layers ||
            (report->layers == best.report.layers && report->crossings < best.report.crossings);
        if (i == 0 || isBetter)
            best = {directions[i], *report};
    }
    return best;
}

} // namespace lamina
