#include <lamina/voxelize/volume_voxelizer.hpp>

#include "gl/binding_guards.hpp"
#include "gl/fragment_guards.hpp"
#include "gl/program_cache.hpp"
#include "gl/state_guard.hpp"
#include "voxelize/mesh_view.hpp"
#include "voxelize/volume_constants.hpp"
#include "voxelize/volume_draw.hpp"
#include "voxelize/volume_formats.hpp"
#include "voxelize/volume_mesh.hpp"
#include "voxelize/volume_resolver.hpp"

#include <algorithm>
#include <cstring>
#include <vector>

namespace lamina {
namespace {

/// Fragment outputs 0 to 4 of volume.frag are the payloads in their order.
constexpr GLuint kTargetCount = kVolumePayloadCount;

/// One source: its programs for the first and for later passes, and its draw constants.
struct PreparedSource {
    std::array<GLuint, 2> programs{};
    bool listsTall = false; ///< Later passes draw the list of tall triangles.
    shared::LaminaVolumeDrawConstants constants{};
};

} // namespace

struct VolumeVoxelizer::Impl {
    Impl(std::shared_ptr<gl::DeviceState> state, const VolumeVoxelizerDesc& voxelizerDesc)
        : device(std::move(state))
        , desc(voxelizerDesc)
        , resolver(device)
        , framebuffer(gl::Framebuffer::create(device, "lamina volume"))
        , vertexArray(createAttributeArray(device))
        , drawBlocks(gl::Buffer::create(device, "lamina volume draw constants"))
        , materialBlock(gl::Buffer::create(device, "lamina materials")) {}

    [[nodiscard]] Result<std::array<GLuint, 2>> programs(const gl::ProgramStage& vertexStage,
                                                         Projection projection,
                                                         const VolumeLayout& layout,
                                                         bool listsTall) const;
    [[nodiscard]] Result<void> checkLimits(const GridTransform& transform) const;
    [[nodiscard]] Result<std::vector<PreparedSource>>
    prepare(std::span<const GeometrySource> sources, std::size_t materialCount,
            const GridTransform& transform, const VolumeLayout& layout, VolumeStats& stats) const;
    /// Makes room for the list of tall triangles of the largest mesh.
    [[nodiscard]] Result<void> reserveTallTriangles(std::span<const GeometrySource> sources,
                                                    std::uint32_t passCount);
    void uploadMaterials(std::span<const Material> materials);
    void uploadDrawBlocks(std::span<const PreparedSource> sources, std::uint32_t passCount);
    void attach(const VolumeGrid& volume);
    void detach();
    void clear(const VolumeGrid& volume) const;
    void bindDrawBlock(std::size_t index) const;
    /// Empties the list of tall triangles and binds it for the first pass over a mesh.
    void beginTallTriangles() const;
    void drawTallTriangles() const;
    /// All passes over a source; firstBlock: of its draw constants.
    void drawMesh(const MeshView& view, const PreparedSource& prepared, std::size_t firstBlock,
                  std::uint32_t passCount) const;
    void drawHost(const DrawSource& source, const PreparedSource& prepared, std::size_t firstBlock,
                  std::uint32_t passCount) const;

    std::shared_ptr<gl::DeviceState> device;
    VolumeVoxelizerDesc desc;
    VolumeResolver resolver;
    gl::Framebuffer framebuffer;
    gl::VertexArray vertexArray;
    gl::Buffer defaultAttributes;
    gl::Buffer drawBlocks;
    gl::Buffer materialBlock;
    gl::Buffer tallTriangles; ///< LaminaTallTriangles and its list; none: later passes draw all.
    std::vector<std::byte> drawBlockBytes;
    std::size_t drawBlockStride = 0;
};

Result<std::array<GLuint, 2>> VolumeVoxelizer::Impl::programs(const gl::ProgramStage& vertexStage,
                                                              Projection projection,
                                                              const VolumeLayout& layout,
                                                              bool listsTall) const {
    const char* perspective = projection == Projection::Perspective ? "1" : "0";
    const bool recordsSurface =
        layout.normal != VolumeFormat::None || layout.color != VolumeFormat::None;
    std::array<GLuint, 2> built{};
    const std::array passes = {listsTall ? "LAMINA_VOLUME_PASS_FIRST_LISTING"
                                         : "LAMINA_VOLUME_PASS_FIRST",
                               "LAMINA_VOLUME_PASS_LATER"};
    for (std::size_t i = 0; i < built.size(); ++i) {
        const auto program = gl::findOrBuildProgram(
            *device, {"lamina volume",
                      {vertexStage,
                       {GL_GEOMETRY_SHADER, "voxelize/volume.geom"},
                       {GL_FRAGMENT_SHADER, "voxelize/volume.frag"}},
                      {{"LAMINA_VOLUME_PASS", passes[i]},
                       {"LAMINA_VOLUME_PERSPECTIVE", perspective},
                       {"LAMINA_VOLUME_SURFACE", recordsSurface ? "1" : "0"}}});
        if (!program)
            return program.error();
        built[i] = *program;
    }
    return built;
}

Result<void> VolumeVoxelizer::Impl::checkLimits(const GridTransform& transform) const {
    const glm::uvec3 size = transform.size();
    GLint layers = 0;
    device->gl.GetIntegerv(GL_MAX_FRAMEBUFFER_LAYERS, &layers);
    const DeviceLimits& limits = device->limits;
    if (size.x > limits.maxViewportWidth || size.y > limits.maxViewportHeight ||
        size.z > static_cast<std::uint32_t>(layers))
        return Error{ErrorCode::DeviceLimit, "voxelize: volume " + transform.describe() +
                                                 ", the device's limit is " +
                                                 std::to_string(limits.maxViewportWidth) + " x " +
                                                 std::to_string(limits.maxViewportHeight) + " x " +
                                                 std::to_string(layers) + "; use a smaller grid"};
    return {};
}

Result<std::vector<PreparedSource>>
VolumeVoxelizer::Impl::prepare(std::span<const GeometrySource> sources, std::size_t materialCount,
                               const GridTransform& transform, const VolumeLayout& layout,
                               VolumeStats& stats) const {
    std::vector<PreparedSource> prepared;
    prepared.reserve(sources.size());
    const shared::LaminaVolumeDrawConstants common =
        volumeDrawConstants(transform, layout, desc, materialCount, device->limits.subpixelBits);
    for (std::size_t i = 0; i < sources.size(); ++i) {
        PreparedSource entry;
        entry.constants = common;
        glm::dmat4 localToWorld(1.0);
        Result<std::array<GLuint, 2>> built = Error{};
        const std::string name = "voxelize: source " + std::to_string(i) + ": ";
        if (const auto* view = std::get_if<MeshView>(&sources[i])) {
            if (auto valid = checkMeshView(*device, *view, i); !valid)
                return valid.error();
            if (auto valid = checkMeshAttributes(*device, *view, i); !valid)
                return valid.error();
            if (view->materialId >= materialCount)
                return Error{ErrorCode::InvalidArgument, name + "expected a material id below " +
                                                             std::to_string(materialCount) +
                                                             ", found " +
                                                             std::to_string(view->materialId)};
            localToWorld = glm::dmat4(view->model);
            entry.constants.pass.y = view->materialId;
            stats.meshTriangles += triangleCount(*view);
            entry.listsTall = tallTriangles.bytes() != 0;
            built = programs({GL_VERTEX_SHADER, "voxelize/volume_mesh.vert"},
                             transform.projection(), layout, entry.listsTall);
        } else {
            const auto& source = std::get<DrawSource>(sources[i]);
            if (source.vertexShader.empty() || !source.draw)
                return Error{ErrorCode::InvalidArgument,
                             name + "expected a DrawSource with a vertex stage and a draw "
                                    "callback, found one without"};
            stats.mayReachCeiling = true;
            built = programs({GL_VERTEX_SHADER, "voxelize/volume_vertex.glsl", source.vertexShader},
                             transform.projection(), layout, false);
        }
        if (!built)
            return built.error();
        entry.programs = *built;
        setTransform(entry.constants, transform, localToWorld);
        prepared.push_back(entry);
    }
    stats.mayReachCeiling = stats.mayReachCeiling || stats.meshTriangles > hitCeiling(layout);
    return prepared;
}

Result<void> VolumeVoxelizer::Impl::reserveTallTriangles(std::span<const GeometrySource> sources,
                                                         std::uint32_t passCount) {
    std::uint64_t triangles = 0;
    for (const GeometrySource& source : sources)
        if (const auto* view = std::get_if<MeshView>(&source))
            triangles = std::max(triangles, triangleCount(*view));
    const std::uint64_t bytes =
        sizeof(shared::LaminaTallTriangles) + triangles * 3 * sizeof(std::uint32_t);
    GLint64 blockLimit = 0;
    GLint blocks = 0;
    device->gl.GetInteger64v(GL_MAX_SHADER_STORAGE_BLOCK_SIZE, &blockLimit);
    device->gl.GetIntegerv(GL_MAX_GEOMETRY_SHADER_STORAGE_BLOCKS, &blocks);
    const bool canList = blocks > 0 && bytes <= static_cast<std::uint64_t>(blockLimit);
    if (!canList)
        tallTriangles = gl::Buffer();
    if (!canList || passCount == 1 || bytes <= tallTriangles.bytes())
        return {};
    auto buffer = gl::createBuffer(device, bytes, nullptr, GL_DYNAMIC_STORAGE_BIT,
                                   "voxelize: list of tall triangles", "lamina tall triangles");
    if (!buffer)
        return buffer.error();
    tallTriangles = std::move(*buffer);
    return {};
}

void VolumeVoxelizer::Impl::uploadMaterials(std::span<const Material> materials) {
    std::vector<shared::LaminaMaterialConstants> table(LAMINA_MAX_MATERIALS);
    std::ranges::transform(materials, table.begin(), materialConstants);
    device->gl.NamedBufferData(materialBlock.id(),
                               static_cast<GLsizeiptr>(std::span(table).size_bytes()), table.data(),
                               GL_STREAM_DRAW);
}

void VolumeVoxelizer::Impl::uploadDrawBlocks(std::span<const PreparedSource> sources,
                                             std::uint32_t passCount) {
    const std::size_t alignment = device->limits.uniformBufferOffsetAlignment;
    drawBlockStride =
        (sizeof(shared::LaminaVolumeDrawConstants) + alignment - 1) / alignment * alignment;
    drawBlockBytes.assign(drawBlockStride * sources.size() * passCount, std::byte{});
    std::size_t offset = 0;
    for (const PreparedSource& source : sources)
        for (std::uint32_t pass = 0; pass < passCount; ++pass) {
            shared::LaminaVolumeDrawConstants constants = source.constants;
            constants.pass.x = firstLayerOf(pass);
            std::memcpy(drawBlockBytes.data() + offset, &constants, sizeof constants);
            offset += drawBlockStride;
        }
    // New storage each time: draws of the last call may still read the old.
    device->gl.NamedBufferData(drawBlocks.id(), static_cast<GLsizeiptr>(drawBlockBytes.size()),
                               drawBlockBytes.data(), GL_STREAM_DRAW);
}

void VolumeVoxelizer::Impl::attach(const VolumeGrid& volume) {
    const GladGLContext& gl = device->gl;
    const glm::uvec3 size = volume.transform()->size();
    std::array<GLenum, kTargetCount> buffers{};
    bool hasTarget = false;
    for (const VolumePayload payload : kVolumePayloads) {
        const auto attachment = GL_COLOR_ATTACHMENT0 + static_cast<GLenum>(indexOf(payload));
        const VolumeFormat format = volume.layout().format(payload);
        const bool isTarget = format != VolumeFormat::None && format != VolumeFormat::R32UI;
        buffers[indexOf(payload)] = isTarget ? attachment : GL_NONE;
        if (isTarget)
            gl.NamedFramebufferTexture(framebuffer.id(), attachment,
                                       resolver.target(payload, volume), 0);
        hasTarget = hasTarget || isTarget;
    }
    gl.NamedFramebufferDrawBuffers(framebuffer.id(), kTargetCount, buffers.data());
    // Without a target, where counts alone are asked for, these give the size.
    const std::array<std::pair<GLenum, std::uint32_t>, 3> sizes = {
        {{GL_FRAMEBUFFER_DEFAULT_WIDTH, size.x},
         {GL_FRAMEBUFFER_DEFAULT_HEIGHT, size.y},
         {GL_FRAMEBUFFER_DEFAULT_LAYERS, size.z}}};
    for (const auto& [name, value] : sizes)
        gl.NamedFramebufferParameteri(framebuffer.id(), name,
                                      hasTarget ? 0 : static_cast<GLint>(value));
}

void VolumeVoxelizer::Impl::detach() {
    for (GLuint i = 0; i < kTargetCount; ++i)
        device->gl.NamedFramebufferTexture(framebuffer.id(), GL_COLOR_ATTACHMENT0 + i, 0, 0);
}

void VolumeVoxelizer::Impl::clear(const VolumeGrid& volume) const {
    for (const VolumePayload payload : kVolumePayloads) {
        const VolumeFormat format = volume.layout().format(payload);
        if (format == VolumeFormat::None)
            continue;
        const bool isInteger = format == VolumeFormat::R32UI;
        device->gl.ClearTexImage(resolver.target(payload, volume), 0,
                                 isInteger ? GL_RED_INTEGER : GL_RGBA,
                                 isInteger ? GL_UNSIGNED_INT : GL_FLOAT, nullptr);
    }
}

void VolumeVoxelizer::Impl::bindDrawBlock(std::size_t index) const {
    // Multi-bind leaves the host's generic uniform buffer binding alone.
    const GLuint buffer = drawBlocks.id();
    const auto offset = static_cast<GLintptr>(index * drawBlockStride);
    constexpr GLsizeiptr kBlockBytes = sizeof(shared::LaminaVolumeDrawConstants);
    device->gl.BindBuffersRange(GL_UNIFORM_BUFFER, LAMINA_DRAW_BLOCK_BINDING, 1, &buffer, &offset,
                                &kBlockBytes);
}

void VolumeVoxelizer::Impl::beginTallTriangles() const {
    const GladGLContext& gl = device->gl;
    constexpr std::uint32_t kFirstIndex =
        sizeof(shared::LaminaTallTriangles) / sizeof(std::uint32_t);
    const shared::LaminaTallTriangles none{0, 1, kFirstIndex, 0, 0};
    // The list of the source before was written by a shader.
    gl.MemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
    gl.NamedBufferSubData(tallTriangles.id(), 0, sizeof none, &none);
    const GLuint buffer = tallTriangles.id();
    gl.BindBuffersBase(GL_SHADER_STORAGE_BUFFER, LAMINA_VOLUME_TALL_BLOCK_BINDING, 1, &buffer);
}

void VolumeVoxelizer::Impl::drawTallTriangles() const {
    const GladGLContext& gl = device->gl;
    gl.MemoryBarrier(GL_COMMAND_BARRIER_BIT | GL_ELEMENT_ARRAY_BARRIER_BIT);
    gl.VertexArrayElementBuffer(vertexArray.id(), tallTriangles.id());
    gl.BindBuffer(GL_DRAW_INDIRECT_BUFFER, tallTriangles.id());
    gl.DrawElementsIndirect(GL_TRIANGLES, GL_UNSIGNED_INT, nullptr);
}

void VolumeVoxelizer::Impl::drawMesh(const MeshView& view, const PreparedSource& prepared,
                                     std::size_t firstBlock, std::uint32_t passCount) const {
    const GladGLContext& gl = device->gl;
    gl.BindVertexArray(vertexArray.id());
    bindMeshAttributes(*device, vertexArray.id(), defaultAttributes.id(), view);
    for (std::uint32_t pass = 0; pass < passCount; ++pass) {
        bindDrawBlock(firstBlock + pass);
        gl.UseProgram(prepared.programs[pass == 0 ? 0 : 1]);
        if (prepared.listsTall && pass == 0)
            beginTallTriangles();
        if (prepared.listsTall && pass > 0)
            drawTallTriangles();
        else
            drawMeshView(*device, vertexArray.id(), view);
    }
}

void VolumeVoxelizer::Impl::drawHost(const DrawSource& source, const PreparedSource& prepared,
                                     std::size_t firstBlock, std::uint32_t passCount) const {
    for (std::uint32_t pass = 0; pass < passCount; ++pass) {
        DrawContext context;
        context.program = prepared.programs[pass == 0 ? 0 : 1];
        context.pass = pass;
        context.passCount = passCount;
        bindDrawBlock(firstBlock + pass);
        device->gl.UseProgram(context.program);
        source.draw(context);
    }
}

VolumeVoxelizer::VolumeVoxelizer(std::unique_ptr<Impl> impl)
    : mImpl(std::move(impl)) {}
VolumeVoxelizer::VolumeVoxelizer(VolumeVoxelizer&&) noexcept = default;
VolumeVoxelizer& VolumeVoxelizer::operator=(VolumeVoxelizer&&) noexcept = default;
VolumeVoxelizer::~VolumeVoxelizer() = default;

Result<VolumeVoxelizer> VolumeVoxelizer::create(const Device& device,
                                                const VolumeVoxelizerDesc& desc) {
    if (!(desc.slabOverlap >= 0.0f && desc.slabOverlap <= 1.0f))
        return Error{ErrorCode::InvalidArgument,
                     "volume voxelizer: expected a slab overlap in [0,1] slices, found " +
                         std::to_string(desc.slabOverlap)};
    auto impl = std::make_unique<Impl>(device.state(), desc);
    auto defaults = createDefaultAttributes(impl->device);
    if (!defaults)
        return defaults.error();
    impl->defaultAttributes = std::move(*defaults);
    if (auto built = impl->programs({GL_VERTEX_SHADER, "voxelize/volume_mesh.vert"},
                                    Projection::Orthographic, {}, true);
        !built)
        return built.error();
    return VolumeVoxelizer(std::move(impl));
}

Result<VolumeStats> VolumeVoxelizer::voxelize(std::span<const GeometrySource> sources,
                                              std::span<const Material> materials,
                                              const GridTransform& transform, VolumeGrid& out) {
    Impl& impl = *mImpl;
    const Material defaultMaterial;
    if (materials.empty())
        materials = {&defaultMaterial, 1};
    if (auto valid = checkMaterials(materials); !valid)
        return valid.error();
    if (auto own =
            gl::checkSameDevice(*impl.device, out.deviceState(), "volume voxelizer", "a volume");
        !own)
        return own.error();
    if (auto fits = impl.checkLimits(transform); !fits)
        return fits.error();
    const gl::DebugGroup group(*impl.device, "lamina: voxelize (volume)");
    VolumeStats stats;
    stats.sources = static_cast<std::uint32_t>(sources.size());
    const std::uint32_t passCount = volumePassCount(transform);
    if (auto reserved = impl.reserveTallTriangles(sources, passCount); !reserved)
        return reserved.error();
    auto prepared = impl.prepare(sources, materials.size(), transform, out.layout(), stats);
    if (!prepared)
        return prepared.error();
    if (auto ready = impl.resolver.prepare(out.layout(), transform); !ready)
        return ready.error();
    if (auto resized = out.resize(transform); !resized)
        return resized.error();

    const GladGLContext& gl = impl.device->gl;
    gl::RasterStateGuard guard(*impl.device, LAMINA_VOLUME_MATERIAL_BLOCK_BINDING + 1);
    const gl::BlendStateGuard blendGuard(*impl.device, kTargetCount, gl::Blending::Add);
    const gl::ImageUnitGuard imageGuard(*impl.device, 2);
    const gl::DrawBufferGuard bufferGuard(*impl.device, 1);
    impl.uploadMaterials(materials);
    impl.uploadDrawBlocks(*prepared, passCount);
    const std::array<GLuint, 2> blocks = {out.uniformBuffer(), impl.materialBlock.id()};
    gl.BindBuffersBase(GL_UNIFORM_BUFFER, LAMINA_PASS_GRID_BLOCK_BINDING, 2, blocks.data());
    impl.attach(out);
    gl.BindFramebuffer(GL_DRAW_FRAMEBUFFER, impl.framebuffer.id());
    gl.ViewportIndexedf(0, 0.0f, 0.0f, static_cast<float>(transform.size().x),
                        static_cast<float>(transform.size().y));
    impl.clear(out);
    if (out.layout().count == VolumeFormat::R32UI)
        gl.BindImageTexture(LAMINA_VOLUME_COUNT_IMAGE, out.texture(VolumePayload::Count), 0,
                            GL_TRUE, 0, GL_READ_WRITE, GL_R32UI);
    for (std::size_t i = 0; i < sources.size(); ++i) {
        const auto* view = std::get_if<MeshView>(&sources[i]);
        guard.setHostPrimitiveRestart(view == nullptr);
        if (view)
            impl.drawMesh(*view, (*prepared)[i], i * passCount, passCount);
        else
            impl.drawHost(std::get<DrawSource>(sources[i]), (*prepared)[i], i * passCount,
                          passCount);
    }
    impl.detach();
    impl.resolver.resolve(out);
    // Counts and resolved payloads are written by shaders: for sampling, images, read-back, the
    // next clear.
    gl.MemoryBarrier(GL_TEXTURE_FETCH_BARRIER_BIT | GL_SHADER_IMAGE_ACCESS_BARRIER_BIT |
                     GL_TEXTURE_UPDATE_BARRIER_BIT);
    stats.passes = passCount;
    stats.volumeBytes = out.gpuBytes();
    stats.scratchBytes = impl.resolver.gpuBytes() + impl.tallTriangles.bytes();
    return stats;
}

} // namespace lamina
