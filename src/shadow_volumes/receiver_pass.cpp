#include "shadow_volumes/receiver_pass.hpp"

#include "gl/fragment_guards.hpp"
#include "gl/program_cache.hpp"
#include "gl/state_guard.hpp"
#include "voxelize/mesh_view.hpp"

#include "lamina/shared/constants.glsl"

#include <glm/gtc/matrix_transform.hpp>

#include <cstring>

namespace lamina {
namespace {

constexpr const char* kOperation = "shadow volumes";
constexpr const char* kWhat = "shadow volumes: receiver";

} // namespace

ReceiverPass::ReceiverPass(std::shared_ptr<gl::DeviceState> device)
    : mDevice(device)
    , mTarget(gl::Framebuffer::create(device, "lamina receivers"))
    , mVertexArray(gl::VertexArray::create(device, "lamina receivers"))
    , mBlocks(gl::Buffer::create(device, "lamina receiver draws")) {
    const GladGLContext& gl = mDevice->gl;
    gl.EnableVertexArrayAttrib(mVertexArray.id(), LAMINA_ATTRIBUTE_POSITION);
    gl.VertexArrayAttribFormat(mVertexArray.id(), LAMINA_ATTRIBUTE_POSITION, 3, GL_FLOAT, GL_FALSE,
                               0);
    gl.VertexArrayAttribBinding(mVertexArray.id(), LAMINA_ATTRIBUTE_POSITION, 0);
}

Result<ReceiverPass::Programs> ReceiverPass::build(const GeometrySource& source,
                                                   bool withSlicemap) const {
    const auto* draw = std::get_if<DrawSource>(&source);
    const gl::ProgramStage vertex{GL_VERTEX_SHADER,
                                  draw ? "shadow_volumes/receiver_main.glsl"
                                       : "shadow_volumes/receiver.vert",
                                  draw ? draw->vertexShader : std::string()};
    auto seen = gl::findOrBuildProgram(
        *mDevice,
        {kOperation, {vertex, {GL_FRAGMENT_SHADER, "shadow_volumes/receiver_seen.frag"}}, {}});
    if (!seen || !withSlicemap)
        return seen ? Result<Programs>(Programs{*seen, 0}) : Result<Programs>(seen.error());
    auto layers =
        gl::findOrBuildProgram(*mDevice, {kOperation,
                                          {vertex,
                                           {GL_GEOMETRY_SHADER, "shadow_volumes/receiver.geom"},
                                           {GL_FRAGMENT_SHADER, "shadow_volumes/receiver.frag"}},
                                          {}});
    if (!layers)
        return layers.error();
    return Programs{*seen, *layers};
}

Result<void> ReceiverPass::check(std::span<const GeometrySource> receivers) const {
    for (std::size_t i = 0; i < receivers.size(); ++i) {
        const auto* view = std::get_if<MeshView>(&receivers[i]);
        auto valid = view ? checkMeshView(*mDevice, *view, i, kWhat)
                          : checkDrawSource(std::get<DrawSource>(receivers[i]), i, kWhat);
        if (!valid)
            return valid.error();
    }
    return {};
}

Result<void> ReceiverPass::set(std::span<const GeometrySource> receivers, bool withSlicemap) {
    std::vector<Programs> programs;
    for (const GeometrySource& receiver : receivers) {
        auto built = build(receiver, withSlicemap);
        if (!built)
            return built.error();
        programs.push_back(*built);
    }
    const auto count = static_cast<std::uint32_t>(receivers.size());
    if (count > mCapacity) {
        auto flags = gl::createBuffer(mDevice, std::uint64_t{count} * sizeof(GLuint), nullptr,
                                      GL_DYNAMIC_STORAGE_BIT, kOperation, "lamina receivers seen");
        if (!flags)
            return flags.error();
        mFlags = std::move(*flags);
        mCapacity = count;
    }
    mPrograms = std::move(programs);
    mCount = count;
    mWithSlicemap = withSlicemap;
    return {};
}

void ReceiverPass::findSeen(const ShadowScene& scene, const glm::dvec3& origin,
                            const gl::SampledDepths& depths, gl::RasterStateGuard& guard) {
    const GladGLContext& gl = mDevice->gl;
    const std::size_t alignment = mDevice->limits.uniformBufferOffsetAlignment;
    mBlockStride = (sizeof(shared::LaminaShadowDraw) + alignment - 1) / alignment * alignment;
    std::vector<std::byte> bytes(mBlockStride * mCount);
    for (std::uint32_t i = 0; i < mCount; ++i) {
        const auto* view = std::get_if<MeshView>(&scene.receivers[i]);
        const glm::dmat4 toOrigin = glm::translate(glm::dmat4(1.0), -origin);
        shared::LaminaShadowDraw block{};
        block.localToOrigin = glm::mat4(view ? toOrigin * glm::dmat4(view->model) : toOrigin);
        block.draw = {i, 0, 0, 0};
        std::memcpy(bytes.data() + i * mBlockStride, &block, sizeof block);
    }
    // New storage each time: draws of the last frame may still read the old.
    gl.NamedBufferData(mBlocks.id(), static_cast<GLsizeiptr>(bytes.size()), bytes.data(),
                       GL_STREAM_DRAW);
    const std::vector<GLuint> unseen(mCount, 0);
    gl.NamedBufferSubData(mFlags.id(), 0, static_cast<GLsizeiptr>(unseen.size() * sizeof(GLuint)),
                          unseen.data());

    const View& view = scene.view;
    const auto width = static_cast<GLint>(view.size.x);
    const auto height = static_cast<GLint>(view.size.y);
    gl.NamedFramebufferParameteri(mTarget.id(), GL_FRAMEBUFFER_DEFAULT_WIDTH, width);
    gl.NamedFramebufferParameteri(mTarget.id(), GL_FRAMEBUFFER_DEFAULT_HEIGHT, height);
    const gl::DepthStateGuard depthGuard(*mDevice, GL_ALWAYS);
    gl.Disable(GL_DEPTH_CLAMP);
    gl.ClipControl(GL_LOWER_LEFT, view.clipDepth == ClipDepth::ZeroToOne ? GL_ZERO_TO_ONE
                                                                         : GL_NEGATIVE_ONE_TO_ONE);
    gl.DepthRangeIndexed(0, view.depthRange.x, view.depthRange.y);
    gl.BindFramebuffer(GL_DRAW_FRAMEBUFFER, mTarget.id());
    gl.ViewportIndexedf(0, 0.0f, 0.0f, static_cast<float>(width), static_cast<float>(height));
    depths.bind(gl, LAMINA_SHADOW_DEPTH_UNIT);
    draw(scene.receivers, false, 0, guard);
    gl.MemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT | GL_BUFFER_UPDATE_BARRIER_BIT);
}

void ReceiverPass::drawLayers(std::span<const GeometrySource> receivers,
                              gl::RasterStateGuard& guard) const {
    draw(receivers, true, 1, guard);
    mDevice->gl.MemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
}

void ReceiverPass::draw(std::span<const GeometrySource> receivers, bool isSlicemap, GLuint pass,
                        gl::RasterStateGuard& guard) const {
    const GladGLContext& gl = mDevice->gl;
    for (std::uint32_t i = 0; i < mCount; ++i) {
        const GLuint blocks = mBlocks.id();
        const auto offset = static_cast<GLintptr>(i * mBlockStride);
        constexpr GLsizeiptr kBytes = sizeof(shared::LaminaShadowDraw);
        gl.BindBuffersRange(GL_UNIFORM_BUFFER, LAMINA_SHADOW_DRAW_BINDING, 1, &blocks, &offset,
                            &kBytes);
        const GLuint program = isSlicemap ? mPrograms[i].layers : mPrograms[i].seen;
        gl.UseProgram(program);
        if (const auto* view = std::get_if<MeshView>(&receivers[i])) {
            guard.setHostPrimitiveRestart(false);
            gl.BindVertexArray(mVertexArray.id());
            drawMeshView(*mDevice, mVertexArray.id(), *view);
        } else {
            guard.setHostPrimitiveRestart(true);
            std::get<DrawSource>(receivers[i]).draw({program, pass, mWithSlicemap ? 2u : 1u});
        }
    }
}

} // namespace lamina
