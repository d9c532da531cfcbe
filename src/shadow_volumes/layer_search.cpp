#include "shadow_volumes/layer_search.hpp"

#include "gl/binding_guards.hpp"
#include "gl/fragment_guards.hpp"
#include "gl/program_cache.hpp"
#include "gl/state_guard.hpp"

#include <algorithm>
#include <array>
#include <limits>

namespace lamina {
namespace {

constexpr const char* kOperation = "shadow volumes";
/// Farness where nothing was drawn: hides nothing.
constexpr GLfloat kNothing = 3.0e38f;

GLuint groups(std::uint32_t items, std::uint32_t size) {
    return (items + size - 1) / size;
}

} // namespace

LayerFinder::LayerFinder(std::shared_ptr<gl::DeviceState> device, const ShadowVolumesDesc& desc)
    : mDevice(device)
    , mDesc(desc)
    , mLightTarget(gl::Framebuffer::create(device, "lamina light map"))
    , mEdgeTarget(gl::Framebuffer::create(device, "lamina light edges"))
    , mNoTarget(gl::Framebuffer::create(device, "lamina caster layers")) {
    const GladGLContext& gl = device->gl;
    const auto side = static_cast<GLint>(desc.lightMapTexels);
    gl.NamedFramebufferParameteri(mNoTarget.id(), GL_FRAMEBUFFER_DEFAULT_WIDTH, side);
    gl.NamedFramebufferParameteri(mNoTarget.id(), GL_FRAMEBUFFER_DEFAULT_HEIGHT, side);
    constexpr GLint kMostFaces = 6;
    gl.NamedFramebufferParameteri(mNoTarget.id(), GL_FRAMEBUFFER_DEFAULT_LAYERS, kMostFaces);
}

Result<void> LayerFinder::build() {
    const auto compute = [this](GLuint& program, const char* shader) {
        auto built =
            gl::findOrBuildProgram(*mDevice, {kOperation, {{GL_COMPUTE_SHADER, shader}}, {}});
        program = built ? *built : 0;
        return built;
    };
    const auto raster = [this](GLuint& program, const char* geometry, const char* fragment,
                               std::vector<gl::ShaderDefine> defines) {
        auto built =
            gl::findOrBuildProgram(*mDevice, {kOperation,
                                              {{GL_VERTEX_SHADER, "shadow_volumes/caster.vert"},
                                               {GL_GEOMETRY_SHADER, geometry},
                                               {GL_FRAGMENT_SHADER, fragment}},
                                              std::move(defines)});
        program = built ? *built : 0;
        return built;
    };
    const char* query = mDesc.search == LayerSearch::Queries ? "1" : "0";
    const std::array built = {
        compute(mPrograms.bounds, "shadow_volumes/bounds.comp"),
        compute(mPrograms.litmap, "shadow_volumes/litmap.comp"),
        compute(mPrograms.masks, "shadow_volumes/masks.comp"),
        raster(mPrograms.blockers, "shadow_volumes/columns_triangles.geom",
               "shadow_volumes/blockers.frag", {}),
        raster(mPrograms.blockerEdges, "shadow_volumes/columns_edges.geom",
               "shadow_volumes/blockers_edges.frag", {}),
        raster(mPrograms.casterLayers, "shadow_volumes/columns_triangles.geom",
               "shadow_volumes/caster_layers.frag", {{"LAMINA_SHADOW_QUERY", query}}),
    };
    for (const auto& program : built)
        if (!program)
            return program.error();
    return {};
}

Result<void> LayerFinder::reserve(std::uint32_t faces, std::uint32_t casters) {
    const auto buffer = [this](std::uint64_t bytes, const char* label) {
        return gl::createBuffer(mDevice, bytes, nullptr, GL_DYNAMIC_STORAGE_BIT, kOperation, label);
    };
    if (faces > mFaces) {
        const std::uint64_t texels =
            std::uint64_t{faces} * mDesc.lightMapTexels * mDesc.lightMapTexels;
        const std::uint64_t bytes = texels * layerWords(mDesc.layers) * 4;
        if (bytes > mDevice->limits.maxStorageBlockBytes)
            return Error{ErrorCode::DeviceLimit,
                         std::string(kOperation) + ": needs a slicemap of " +
                             std::to_string(bytes) + " bytes, the device's storage blocks hold " +
                             std::to_string(mDevice->limits.maxStorageBlockBytes) +
                             "; use fewer layers or light map texels"};
        auto slicemap = buffer(bytes, "lamina receiver slicemap");
        if (!slicemap)
            return slicemap.error();
        auto bounds = buffer(std::uint64_t{faces} * sizeof(glm::uvec4), "lamina light bounds");
        if (!bounds)
            return bounds.error();
        const auto texture = [&](GLenum format, std::uint32_t texelBytes, const char* label) {
            return gl::createTextureArray(mDevice, format, texelBytes, mDesc.lightMapTexels,
                                          mDesc.lightMapTexels, faces, kOperation, label);
        };
        auto map = texture(GL_R32F, 4, "lamina light map");
        if (!map)
            return map.error();
        auto blockers = texture(GL_R32UI, 4, "lamina light blockers");
        if (!blockers)
            return blockers.error();
        auto depths = texture(GL_DEPTH_COMPONENT32F, 4, "lamina light depths");
        if (!depths)
            return depths.error();
        auto edges = texture(GL_R8, 1, "lamina light edges");
        if (!edges)
            return edges.error();
        mSlicemap = std::move(*slicemap);
        mBounds = std::move(*bounds);
        mLightMap = std::move(*map);
        mBlockers = std::move(*blockers);
        mLightDepths = std::move(*depths);
        mLightEdges = std::move(*edges);
        const GladGLContext& gl = mDevice->gl;
        gl.NamedFramebufferTexture(mLightTarget.id(), GL_COLOR_ATTACHMENT0, mLightMap.id(), 0);
        gl.NamedFramebufferTexture(mLightTarget.id(), GL_COLOR_ATTACHMENT1, mBlockers.id(), 0);
        gl.NamedFramebufferTexture(mLightTarget.id(), GL_DEPTH_ATTACHMENT, mLightDepths.id(), 0);
        constexpr std::array<GLenum, 2> kOutputs{GL_COLOR_ATTACHMENT0, GL_COLOR_ATTACHMENT1};
        gl.NamedFramebufferDrawBuffers(mLightTarget.id(), 2, kOutputs.data());
        gl.NamedFramebufferTexture(mEdgeTarget.id(), GL_COLOR_ATTACHMENT0, mLightEdges.id(), 0);
        mFaces = faces;
    }
    if (casters <= mCasterCapacity && mMasks)
        return {};
    const std::uint64_t capacity = std::max(casters, 1u);
    auto masks = buffer(capacity * sizeof(shared::LaminaShadowCaster), "lamina caster layers");
    if (!masks)
        return masks.error();
    auto commands =
        buffer(capacity * 2 * sizeof(shared::LaminaShadowCommand), "lamina volume commands");
    if (!commands)
        return commands.error();
    const bool isQueried = mDesc.search == LayerSearch::Queries;
    const std::uint64_t queries = isQueried ? capacity * (mDesc.layers + 1) : 1;
    auto results = buffer(queries * sizeof(GLuint), "lamina caster queries");
    if (!results)
        return results.error();
    while (isQueried && mQueries.size() < queries)
        mQueries.push_back(
            gl::Query::create(mDevice, "lamina caster query", GL_ANY_SAMPLES_PASSED));
    mMasks = std::move(*masks);
    mCommands = std::move(*commands);
    mQueryResults = std::move(*results);
    mCasterCapacity = casters;
    return {};
}

void LayerFinder::find(GLuint frame, const ShadowFrame& shadowFrame,
                       const gl::SampledDepths& depths, const ShadowScene& scene,
                       const CasterDraws& casters, ReceiverPass& receivers) {
    clear(casters);
    overVisiblePoints(frame, shadowFrame, depths);
    {
        gl::RasterStateGuard guard(*mDevice, 2);
        const gl::DrawBufferGuard buffers(*mDevice, LAMINA_SHADOW_STORAGE_BINDINGS);
        const gl::TextureUnitGuard textures(*mDevice, 0, LAMINA_SHADOW_TEXTURE_UNITS);
        mDevice->gl.BindBuffersBase(GL_UNIFORM_BUFFER, LAMINA_SHADOW_FRAME_BINDING, 1, &frame);
        bindStorage(receivers.flags());
        if (receivers.size() > 0)
            drawReceivers(shadowFrame, depths, scene, receivers, guard);
        guard.setHostPrimitiveRestart(false);
        drawBlockers(casters);
        search(casters);
    }
    settle(frame, casters.size());
}

void LayerFinder::clear(const CasterDraws& casters) {
    const GladGLContext& gl = mDevice->gl;
    const gl::PixelUnpackGuard unpack(*mDevice);
    constexpr GLuint kNone = 0;
    gl.ClearNamedBufferData(mSlicemap.id(), GL_R32UI, GL_RED_INTEGER, GL_UNSIGNED_INT, &kNone);
    constexpr GLuint kMost = std::numeric_limits<GLuint>::max();
    const std::vector<glm::uvec4> empty(mFaces, glm::uvec4(kMost, kMost, 0, 0));
    gl.NamedBufferSubData(mBounds.id(), 0, static_cast<GLsizeiptr>(empty.size() * sizeof empty[0]),
                          empty.data());
    const std::vector<shared::LaminaShadowCaster> masks = casters.emptyMasks();
    gl.NamedBufferSubData(mMasks.id(), 0, static_cast<GLsizeiptr>(masks.size() * sizeof masks[0]),
                          masks.data());
}

void LayerFinder::bindStorage(GLuint receivers) const {
    std::array<GLuint, LAMINA_SHADOW_STORAGE_BINDINGS> buffers{};
    buffers[LAMINA_SHADOW_BOUNDS_BINDING] = mBounds.id();
    buffers[LAMINA_SHADOW_SLICEMAP_BINDING] = mSlicemap.id();
    buffers[LAMINA_SHADOW_CASTER_BINDING] = mMasks.id();
    buffers[LAMINA_SHADOW_COMMAND_BINDING] = mCommands.id();
    buffers[LAMINA_SHADOW_RECEIVER_BINDING] = receivers;
    buffers[LAMINA_SHADOW_QUERY_BINDING] = mQueryResults.id();
    mDevice->gl.BindBuffersBase(GL_SHADER_STORAGE_BUFFER, 0, LAMINA_SHADOW_STORAGE_BINDINGS,
                                buffers.data());
}

void LayerFinder::overVisiblePoints(GLuint frame, const ShadowFrame& shadowFrame,
                                    const gl::SampledDepths& depths) {
    const gl::DebugGroup group(*mDevice, "lamina: visible points");
    const GladGLContext& gl = mDevice->gl;
    const gl::ComputeStateGuard guard(*mDevice, 1, LAMINA_SHADOW_STORAGE_BINDINGS);
    const gl::TextureUnitGuard textures(*mDevice, LAMINA_SHADOW_DEPTH_UNIT, 1);
    depths.bind(gl, LAMINA_SHADOW_DEPTH_UNIT);
    gl.BindBuffersBase(GL_UNIFORM_BUFFER, LAMINA_SHADOW_FRAME_BINDING, 1, &frame);
    bindStorage(0);
    const GLuint x = groups(shadowFrame.constants.size.x, LAMINA_SHADOW_GROUP);
    const GLuint y = groups(shadowFrame.constants.size.y, LAMINA_SHADOW_GROUP);
    gl.UseProgram(mPrograms.bounds);
    gl.DispatchCompute(x, y, 1);
    gl.MemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
    if (!mDesc.litmap)
        return;
    gl.UseProgram(mPrograms.litmap);
    gl.DispatchCompute(x, y, 1);
    gl.MemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
}

void LayerFinder::drawReceivers(const ShadowFrame& shadowFrame, const gl::SampledDepths& depths,
                                const ShadowScene& scene, ReceiverPass& receivers,
                                gl::RasterStateGuard& guard) {
    const gl::DebugGroup group(*mDevice, "lamina: receivers");
    receivers.findSeen(scene, shadowFrame.origin, depths, guard);
    if (mDesc.litmap)
        return;
    const auto side = static_cast<GLfloat>(mDesc.lightMapTexels);
    mDevice->gl.BindFramebuffer(GL_DRAW_FRAMEBUFFER, mNoTarget.id());
    mDevice->gl.ViewportIndexedf(0, 0.0f, 0.0f, side, side);
    receivers.drawLayers(scene.receivers, guard);
}

void LayerFinder::drawBlockers(const CasterDraws& casters) {
    const gl::DebugGroup group(*mDevice, "lamina: casters seen from the light");
    const GladGLContext& gl = mDevice->gl;
    const auto side = static_cast<GLfloat>(mDesc.lightMapTexels);
    casters.bind();
    gl.BindFramebuffer(GL_DRAW_FRAMEBUFFER, mLightTarget.id());
    gl.ViewportIndexedf(0, 0.0f, 0.0f, side, side);
    const gl::BlendStateGuard blend(*mDevice, 2, gl::Blending::Off);
    {
        const gl::DepthStateGuard depthGuard(*mDevice, GL_LESS);
        constexpr GLfloat kFarthest = 1.0f;
        constexpr std::array<GLuint, 4> kNoCaster{LAMINA_SHADOW_NO_CASTER, 0, 0, 0};
        gl.ClearNamedFramebufferfv(mLightTarget.id(), GL_COLOR, 0,
                                   std::array{kNothing, 0.0f, 0.0f, 0.0f}.data());
        gl.ClearNamedFramebufferuiv(mLightTarget.id(), GL_COLOR, 1, kNoCaster.data());
        gl.ClearNamedFramebufferfv(mLightTarget.id(), GL_DEPTH, 0, &kFarthest);
        gl.UseProgram(mPrograms.blockers);
        for (std::uint32_t i = 0; i < casters.size(); ++i)
            casters.draw(i, CasterPart::Triangles, VolumeExtent::Whole, {});
    }
    gl.BindTextureUnit(LAMINA_SHADOW_BLOCKER_UNIT, mBlockers.id());
    gl.BindSampler(LAMINA_SHADOW_BLOCKER_UNIT, 0);
    gl.BindTextureUnit(LAMINA_SHADOW_LIGHT_UNIT, mLightMap.id());
    gl.BindSampler(LAMINA_SHADOW_LIGHT_UNIT, 0);
    gl.BindTextureUnit(LAMINA_SHADOW_EDGE_UNIT, mLightEdges.id());
    gl.BindSampler(LAMINA_SHADOW_EDGE_UNIT, 0);
    gl.BindFramebuffer(GL_DRAW_FRAMEBUFFER, mEdgeTarget.id());
    constexpr std::array<GLfloat, 4> kNone{};
    gl.ClearNamedFramebufferfv(mEdgeTarget.id(), GL_COLOR, 0, kNone.data());
    gl.UseProgram(mPrograms.blockerEdges);
    for (std::uint32_t i = 0; i < casters.size(); ++i)
        casters.draw(i, CasterPart::Edges, VolumeExtent::Whole, {});
}

void LayerFinder::search(const CasterDraws& casters) {
    const gl::DebugGroup group(*mDevice, "lamina: caster layers");
    mDevice->gl.BindFramebuffer(GL_DRAW_FRAMEBUFFER, mNoTarget.id());
    if (mDesc.search == LayerSearch::Queries)
        searchByQueries(casters);
    else
        searchByReduction(casters);
}

void LayerFinder::searchByReduction(const CasterDraws& casters) {
    const GladGLContext& gl = mDevice->gl;
    gl.UseProgram(mPrograms.casterLayers);
    for (std::uint32_t i = 0; i < casters.size(); ++i)
        casters.draw(i, CasterPart::Triangles, VolumeExtent::Whole, {});
    gl.MemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
}

void LayerFinder::searchByQueries(const CasterDraws& casters) {
    const GladGLContext& gl = mDevice->gl;
    gl.UseProgram(mPrograms.casterLayers);
    std::size_t query = 0;
    for (std::uint32_t i = 0; i < casters.size(); ++i)
        for (std::uint32_t layer = 0; layer <= mDesc.layers; ++layer, ++query) {
            gl.ProgramUniform1ui(mPrograms.casterLayers, LAMINA_SHADOW_QUERIED_LAYER,
                                 layer < mDesc.layers ? layer : LAMINA_SHADOW_ANY_LAYER);
            gl.BeginQuery(GL_ANY_SAMPLES_PASSED, mQueries[query].id());
            casters.draw(i, CasterPart::Triangles, VolumeExtent::Whole, {});
            gl.EndQuery(GL_ANY_SAMPLES_PASSED);
        }
    // After all draws, so that none waits for the result of one before.
    for (std::size_t i = 0; i < query; ++i)
        gl.GetQueryBufferObjectuiv(mQueries[i].id(), mQueryResults.id(), GL_QUERY_RESULT,
                                   static_cast<GLintptr>(i * sizeof(GLuint)));
    gl.MemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT | GL_QUERY_BUFFER_BARRIER_BIT);
}

void LayerFinder::settle(GLuint frame, std::uint32_t casters) {
    const gl::DebugGroup group(*mDevice, "lamina: volume commands");
    const GladGLContext& gl = mDevice->gl;
    const gl::ComputeStateGuard guard(*mDevice, 1, LAMINA_SHADOW_STORAGE_BINDINGS);
    gl.BindBuffersBase(GL_UNIFORM_BUFFER, LAMINA_SHADOW_FRAME_BINDING, 1, &frame);
    bindStorage(0);
    gl.UseProgram(mPrograms.masks);
    gl.DispatchCompute(groups(casters, LAMINA_SHADOW_CASTER_GROUP), 1, 1);
    gl.MemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT | GL_COMMAND_BARRIER_BIT |
                     GL_BUFFER_UPDATE_BARRIER_BIT);
}

std::uint64_t LayerFinder::gpuBytes() const {
    return mBounds.bytes() + mSlicemap.bytes() + mMasks.bytes() + mCommands.bytes() +
           mQueryResults.bytes() + mLightMap.bytes() + mBlockers.bytes() + mLightDepths.bytes() +
           mLightEdges.bytes();
}

} // namespace lamina
