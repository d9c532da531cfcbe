#include "shadow_volumes/caster_draws.hpp"

#include "shadow_volumes/topology_impl.hpp"
#include "voxelize/mesh_view.hpp"

#include "lamina/shared/constants.glsl"

#include <glm/gtc/matrix_transform.hpp>

#include <array>
#include <cstring>
#include <string>

namespace lamina {
namespace {

constexpr const char* kWhat = "shadow volumes: caster";

Error invalid(std::size_t index, const std::string& text) {
    return {ErrorCode::InvalidArgument,
            std::string(kWhat) + " " + std::to_string(index) + ": " + text};
}

} // namespace

CasterDraws::CasterDraws(std::shared_ptr<gl::DeviceState> device)
    : mDevice(device)
    , mCapture(device, CaptureContent::Positions)
    , mVertexArray(gl::VertexArray::create(device, "lamina casters"))
    , mBlocks(gl::Buffer::create(device, "lamina caster draws")) {
    const GladGLContext& gl = mDevice->gl;
    gl.EnableVertexArrayAttrib(mVertexArray.id(), LAMINA_ATTRIBUTE_POSITION);
    gl.VertexArrayAttribFormat(mVertexArray.id(), LAMINA_ATTRIBUTE_POSITION, 3, GL_FLOAT, GL_FALSE,
                               0);
    gl.VertexArrayAttribBinding(mVertexArray.id(), LAMINA_ATTRIBUTE_POSITION, 0);
}

Result<CasterDraws::Caster> CasterDraws::resolve(const ShadowCaster& caster, std::size_t index) {
    Caster resolved{caster.topology, {}};
    if (const auto* view = std::get_if<MeshView>(&caster.source)) {
        resolved.view = *view;
        return resolved;
    }
    const auto& source = std::get<DrawSource>(caster.source);
    auto program = mCapture.program(source);
    if (!program)
        return program.error();
    auto triangles = mCapture.capture(index, source, *program);
    if (!triangles)
        return triangles.error();
    resolved.view.vertexBuffer = triangles->buffer;
    resolved.view.vertexCount = static_cast<std::uint32_t>(triangles->capacity * 3);
    if (auto valid = checkVertices(resolved, index); !valid)
        return valid.error();
    return resolved;
}

Result<void> CasterDraws::checkVertices(const Caster& caster, std::size_t index) {
    if (caster.view.vertexCount >= caster.topology->vertexCount())
        return {};
    return invalid(index, "expected the " + std::to_string(caster.topology->vertexCount()) +
                              " vertices of its topology, found " +
                              std::to_string(caster.view.vertexCount) +
                              "; make a topology for each mesh");
}

Result<void> CasterDraws::check(std::span<const ShadowCaster> casters) const {
    bool isCaptured = false;
    for (std::size_t i = 0; i < casters.size(); ++i) {
        const ShadowTopology* topology = casters[i].topology;
        if (!topology)
            return invalid(i, "expected a topology, found none");
        const auto* view = std::get_if<MeshView>(&casters[i].source);
        auto valid = view ? checkMeshView(*mDevice, *view, i, kWhat)
                          : checkDrawSource(std::get<DrawSource>(casters[i].source), i, kWhat);
        if (valid && view)
            valid = checkVertices({topology, *view}, i);
        if (!valid)
            return valid.error();
        isCaptured = isCaptured || !view;
    }
    if (isCaptured)
        return mCapture.checkHost();
    return {};
}

Result<void> CasterDraws::set(std::span<const ShadowCaster> casters, const glm::dvec3& origin,
                              bool clipsVolumes) {
    std::vector<Caster> resolved;
    for (std::size_t i = 0; i < casters.size(); ++i) {
        auto caster = resolve(casters[i], i);
        if (!caster)
            return caster.error();
        resolved.push_back(*caster);
    }
    mCasters = std::move(resolved);
    uploadBlocks(origin, clipsVolumes);
    return {};
}

std::vector<shared::LaminaShadowCaster> CasterDraws::emptyMasks() const {
    std::vector<shared::LaminaShadowCaster> masks;
    for (const Caster& caster : mCasters)
        masks.push_back(
            {glm::uvec4(0),
             {0, 4 * caster.topology->edgeCount(), 3 * caster.topology->triangleCount(), 0}});
    return masks;
}

void CasterDraws::uploadBlocks(const glm::dvec3& origin, bool clipsVolumes) {
    const std::size_t alignment = mDevice->limits.uniformBufferOffsetAlignment;
    mBlockStride = (sizeof(shared::LaminaShadowDraw) + alignment - 1) / alignment * alignment;
    std::vector<std::byte> bytes(mBlockStride * 2 * mCasters.size());
    for (std::uint32_t i = 0; i < mCasters.size(); ++i) {
        shared::LaminaShadowDraw block{};
        block.localToOrigin = glm::mat4(glm::translate(glm::dmat4(1.0), -origin) *
                                        glm::dmat4(mCasters[i].view.model));
        const bool isSheet = mCasters[i].topology->surface() == CasterSurface::Sheet;
        const std::uint32_t sheet = isSheet ? LAMINA_SHADOW_SHEET : 0u;
        block.draw = {i, sheet | (clipsVolumes ? LAMINA_SHADOW_CLIPPED : 0u), 0, 0};
        std::memcpy(bytes.data() + 2 * i * mBlockStride, &block, sizeof block);
        block.draw.y = sheet | LAMINA_SHADOW_WHOLE;
        std::memcpy(bytes.data() + (2 * i + 1) * mBlockStride, &block, sizeof block);
    }
    // New storage each time: draws of the last frame may still read the old.
    mDevice->gl.NamedBufferData(mBlocks.id(), static_cast<GLsizeiptr>(bytes.size()), bytes.data(),
                                GL_STREAM_DRAW);
}

void CasterDraws::bind() const {
    mDevice->gl.BindVertexArray(mVertexArray.id());
}

void CasterDraws::draw(std::uint32_t caster, CasterPart part, VolumeExtent extent,
                       std::optional<std::size_t> command) const {
    const GladGLContext& gl = mDevice->gl;
    const Caster& drawn = mCasters[caster];
    const ShadowTopology::Impl& topology = drawn.topology->impl();
    const GLuint blocks = mBlocks.id();
    const std::size_t block = 2 * std::size_t{caster} + (extent == VolumeExtent::Whole ? 1 : 0);
    const auto offset = static_cast<GLintptr>(block * mBlockStride);
    constexpr GLsizeiptr kBytes = sizeof(shared::LaminaShadowDraw);
    // Multi-bind leaves the host's generic uniform buffer binding alone.
    gl.BindBuffersRange(GL_UNIFORM_BUFFER, LAMINA_SHADOW_DRAW_BINDING, 1, &blocks, &offset,
                        &kBytes);
    gl.VertexArrayVertexBuffer(mVertexArray.id(), 0, drawn.view.vertexBuffer,
                               static_cast<GLintptr>(drawn.view.positionOffsetBytes),
                               static_cast<GLsizei>(drawn.view.vertexStrideBytes));
    const bool isEdges = part == CasterPart::Edges;
    gl.VertexArrayElementBuffer(mVertexArray.id(),
                                isEdges ? topology.edges.id() : topology.triangles.id());
    const GLenum mode = isEdges ? GL_LINES_ADJACENCY : GL_TRIANGLES;
    if (command)
        gl.DrawElementsIndirect(mode, GL_UNSIGNED_INT, reinterpret_cast<const void*>(*command));
    else
        gl.DrawElements(
            mode,
            static_cast<GLsizei>(isEdges ? 4 * topology.edgeCount : 3 * topology.triangleCount),
            GL_UNSIGNED_INT, nullptr);
}

} // namespace lamina
