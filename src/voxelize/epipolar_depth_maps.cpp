#include "voxelize/epipolar_depth_maps.hpp"

#include "gl/fragment_guards.hpp"
#include "gl/program_cache.hpp"
#include "gl/state_guard.hpp"
#include "voxelize/mesh_view.hpp"

#include "lamina/shared/constants.glsl"

#include <cstring>
#include <string>

namespace lamina {

DepthMapRenderer::DepthMapRenderer(std::shared_ptr<gl::DeviceState> device, std::uint32_t texels)
    : mDevice(std::move(device))
    , mTexels(texels)
    , mFramebuffer(gl::Framebuffer::create(mDevice, "lamina light depths"))
    , mVertexArray(gl::VertexArray::create(mDevice, "lamina light depths"))
    , mMatrices(gl::Buffer::create(mDevice, "lamina light matrices")) {
    const GladGLContext& gl = mDevice->gl;
    gl.EnableVertexArrayAttrib(mVertexArray.id(), LAMINA_ATTRIBUTE_POSITION);
    gl.VertexArrayAttribFormat(mVertexArray.id(), LAMINA_ATTRIBUTE_POSITION, 3, GL_FLOAT, GL_FALSE,
                               0);
    gl.VertexArrayAttribBinding(mVertexArray.id(), LAMINA_ATTRIBUTE_POSITION, 0);
    gl.NamedFramebufferDrawBuffer(mFramebuffer.id(), GL_NONE);
}

Result<void> DepthMapRenderer::reserve(std::uint32_t layers) {
    if (layers <= mLayers)
        return {};
    auto depths =
        gl::createTextureArray(mDevice, GL_DEPTH_COMPONENT32F, sizeof(float), mTexels, mTexels,
                               layers, "light depth maps", "lamina light depths");
    if (!depths)
        return depths.error();
    mDepths = std::move(*depths);
    mLayers = layers;
    return {};
}

Result<GLuint> DepthMapRenderer::program(std::string shader, std::string hostSource) const {
    return gl::findOrBuildProgram(*mDevice,
                                  {"lamina light depths",
                                   {{GL_VERTEX_SHADER, std::move(shader), std::move(hostSource)}},
                                   {}});
}

Result<std::vector<GLuint>>
DepthMapRenderer::prepare(std::span<const GeometrySource> sources) const {
    std::vector<GLuint> programs;
    for (std::size_t i = 0; i < sources.size(); ++i) {
        Result<GLuint> built = Error{};
        if (const auto* view = std::get_if<MeshView>(&sources[i])) {
            if (auto valid = checkMeshView(*mDevice, *view, i); !valid)
                return valid.error();
            built = program("voxelize/epipolar_depth.vert", {});
        } else {
            const auto& source = std::get<DrawSource>(sources[i]);
            if (source.vertexShader.empty() || !source.draw)
                return Error{ErrorCode::InvalidArgument,
                             "voxelize: source " + std::to_string(i) +
                                 ": expected a DrawSource with a vertex stage and a draw callback, "
                                 "found one without"};
            built = program("voxelize/epipolar_depth_main.glsl", source.vertexShader);
        }
        if (!built)
            return built.error();
        programs.push_back(*built);
    }
    return programs;
}

void DepthMapRenderer::uploadMatrices(std::span<const GeometrySource> sources,
                                      std::span<const DepthMapFace> faces) {
    const std::size_t alignment = mDevice->limits.uniformBufferOffsetAlignment;
    mMatrixStride = (sizeof(glm::mat4) + alignment - 1) / alignment * alignment;
    mMatrixBytes.assign(mMatrixStride * sources.size() * faces.size(), std::byte{});
    std::size_t offset = 0;
    for (const DepthMapFace& face : faces)
        for (const GeometrySource& source : sources) {
            const auto* view = std::get_if<MeshView>(&source);
            const glm::mat4 matrix(view ? face.worldToClip * glm::dmat4(view->model)
                                        : face.worldToClip);
            std::memcpy(mMatrixBytes.data() + offset, &matrix, sizeof matrix);
            offset += mMatrixStride;
        }
    // New storage each time: draws of the last call may still read the old.
    mDevice->gl.NamedBufferData(mMatrices.id(), static_cast<GLsizeiptr>(mMatrixBytes.size()),
                                mMatrixBytes.data(), GL_STREAM_DRAW);
}

void DepthMapRenderer::draw(std::span<const GeometrySource> sources,
                            std::span<const GLuint> programs, std::span<const DepthMapFace> faces) {
    const gl::DebugGroup group(*mDevice, "lamina: light depths");
    const GladGLContext& gl = mDevice->gl;
    gl::RasterStateGuard guard(*mDevice, 1);
    const gl::DepthStateGuard depthGuard(*mDevice, GL_GREATER);
    uploadMatrices(sources, faces);
    gl.BindFramebuffer(GL_DRAW_FRAMEBUFFER, mFramebuffer.id());
    gl.ViewportIndexedf(0, 0.0f, 0.0f, static_cast<float>(mTexels), static_cast<float>(mTexels));
    for (std::size_t layer = 0; layer < faces.size(); ++layer) {
        gl.NamedFramebufferTextureLayer(mFramebuffer.id(), GL_DEPTH_ATTACHMENT, mDepths.id(), 0,
                                        static_cast<GLint>(layer));
        constexpr GLfloat kNothing = 0.0f;
        gl.ClearNamedFramebufferfv(mFramebuffer.id(), GL_DEPTH, 0, &kNothing);
        if (faces[layer].clampsDepth)
            gl.Enable(GL_DEPTH_CLAMP);
        else
            gl.Disable(GL_DEPTH_CLAMP);
        for (std::size_t i = 0; i < sources.size(); ++i) {
            // Multi-bind leaves the host's generic uniform buffer binding alone.
            const GLuint buffer = mMatrices.id();
            const auto offset = static_cast<GLintptr>((layer * sources.size() + i) * mMatrixStride);
            constexpr GLsizeiptr kBytes = sizeof(glm::mat4);
            gl.BindBuffersRange(GL_UNIFORM_BUFFER, LAMINA_DRAW_BLOCK_BINDING, 1, &buffer, &offset,
                                &kBytes);
            gl.UseProgram(programs[i]);
            if (const auto* view = std::get_if<MeshView>(&sources[i])) {
                guard.setHostPrimitiveRestart(false);
                gl.BindVertexArray(mVertexArray.id());
                drawMeshView(*mDevice, mVertexArray.id(), *view);
            } else {
                guard.setHostPrimitiveRestart(true);
                std::get<DrawSource>(sources[i])
                    .draw({programs[i], static_cast<std::uint32_t>(layer),
                           static_cast<std::uint32_t>(faces.size())});
            }
        }
    }
    gl.NamedFramebufferTexture(mFramebuffer.id(), GL_DEPTH_ATTACHMENT, 0, 0);
}

} // namespace lamina
