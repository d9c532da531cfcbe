#include "gl/support/shadow_scene.hpp"

#include <reference/shapes.hpp>

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>

namespace lamina::test {
namespace {

constexpr const char* kVertex = R"(#version 450 core
layout(location = 0) in vec3 position;
layout(location = 0) uniform dmat4 worldToClip;
void main() { gl_Position = vec4(worldToClip * dvec4(position, 1.0lf)); }
)";
constexpr const char* kFragment = "#version 450 core\nvoid main() {}\n";

GLuint build(const GladGLContext& gl) {
    const GLuint program = gl.CreateProgram();
    for (const auto& [stage, text] :
         {std::pair{GL_VERTEX_SHADER, kVertex}, std::pair{GL_FRAGMENT_SHADER, kFragment}}) {
        const GLuint shader = gl.CreateShader(static_cast<GLenum>(stage));
        gl.ShaderSource(shader, 1, &text, nullptr);
        gl.CompileShader(shader);
        gl.AttachShader(program, shader);
        gl.DeleteShader(shader);
    }
    gl.LinkProgram(program);
    return program;
}

} // namespace

SceneHost::SceneHost(const Device& device, std::vector<ScenePart> parts)
    : mGl(device.state()->gl)
    , mDevice(device.state())
    , mParts(std::move(parts))
    , mProgram(build(mGl))
    , mVertexArray(gl::VertexArray::create(mDevice, "scene"))
    , mFramebuffer(gl::Framebuffer::create(mDevice, "scene")) {
    mGl.EnableVertexArrayAttrib(mVertexArray.id(), 0);
    mGl.VertexArrayAttribFormat(mVertexArray.id(), 0, 3, GL_FLOAT, GL_FALSE, 0);
    mGl.VertexArrayAttribBinding(mVertexArray.id(), 0, 0);
    mTopologies.reserve(mParts.size());
    for (const ScenePart& part : mParts) {
        mBuffers.push_back(MeshBuffers::upload(device, part.mesh).value());
        mSources.emplace_back(mBuffers.back().view());
        if (!part.casts)
            continue;
        auto topology = ShadowTopology::create(device, mSources.back(), part.surface);
        EXPECT_TRUE(topology) << topology.error().text;
        mTopologies.push_back(std::move(*topology));
        mCasters.push_back({&mTopologies.back(), mSources.back()});
    }
}

SceneHost::~SceneHost() {
    mGl.DeleteProgram(mProgram);
}

std::uint32_t SceneHost::drawDepth(const View& view) {
    mDepths = gl::Texture::create(mDevice, "scene depth", GL_TEXTURE_2D);
    const auto width = static_cast<GLsizei>(view.size.x);
    const auto height = static_cast<GLsizei>(view.size.y);
    mGl.TextureStorage2D(mDepths.id(), 1, GL_DEPTH_COMPONENT32F, width, height);
    mGl.NamedFramebufferTexture(mFramebuffer.id(), GL_DEPTH_ATTACHMENT, mDepths.id(), 0);
    GLint before = 0;
    mGl.GetIntegerv(GL_DRAW_FRAMEBUFFER_BINDING, &before);
    mGl.BindFramebuffer(GL_DRAW_FRAMEBUFFER, mFramebuffer.id());
    mGl.ClearNamedFramebufferfv(mFramebuffer.id(), GL_DEPTH, 0, &view.backgroundDepth);
    mGl.Viewport(0, 0, width, height);
    mGl.DepthRange(view.depthRange.x, view.depthRange.y);
    mGl.ClipControl(GL_LOWER_LEFT, view.clipDepth == ClipDepth::ZeroToOne ? GL_ZERO_TO_ONE
                                                                          : GL_NEGATIVE_ONE_TO_ONE);
    mGl.Enable(GL_DEPTH_TEST);
    mGl.DepthFunc(view.backgroundDepth > 0.5f ? GL_LESS : GL_GREATER);
    mGl.UseProgram(mProgram);
    mGl.ProgramUniformMatrix4dv(mProgram, 0, 1, GL_FALSE, &view.worldToClip[0][0]);
    mGl.BindVertexArray(mVertexArray.id());
    for (const GeometrySource& source : mSources) {
        const auto& mesh = std::get<MeshView>(source);
        mGl.VertexArrayVertexBuffer(mVertexArray.id(), 0, mesh.vertexBuffer,
                                    static_cast<GLintptr>(mesh.positionOffsetBytes),
                                    static_cast<GLsizei>(mesh.vertexStrideBytes));
        mGl.VertexArrayElementBuffer(mVertexArray.id(), mesh.indexBuffer);
        mGl.DrawElements(GL_TRIANGLES, static_cast<GLsizei>(mesh.indexCount), GL_UNSIGNED_INT,
                         reinterpret_cast<const void*>(mesh.indexOffsetBytes));
    }
    mGl.Disable(GL_DEPTH_TEST);
    mGl.DepthFunc(GL_LESS);
    mGl.DepthRange(0.0, 1.0);
    mGl.ClipControl(GL_LOWER_LEFT, GL_NEGATIVE_ONE_TO_ONE);
    mGl.UseProgram(0);
    mGl.BindVertexArray(0);
    mGl.BindFramebuffer(GL_DRAW_FRAMEBUFFER, static_cast<GLuint>(before));
    return mDepths.id();
}

TriangleMesh SceneHost::casterMesh() const {
    TriangleMesh mesh;
    for (const ScenePart& part : mParts)
        if (part.casts)
            mesh = reference::merged(mesh, part.mesh);
    return mesh;
}

TriangleMesh SceneHost::wholeMesh() const {
    TriangleMesh mesh;
    for (const ScenePart& part : mParts)
        mesh = reference::merged(mesh, part.mesh);
    return mesh;
}

View lookAt(const glm::dvec3& eye, const glm::dvec3& target, const glm::uvec2& size, double near,
            double far) {
    View view;
    view.size = size;
    const double aspect = static_cast<double>(size.x) / size.y;
    view.worldToClip =
        glm::perspectiveNO(0.9, aspect, near, far) * glm::lookAt(eye, target, glm::dvec3(0, 1, 0));
    return view;
}

std::vector<float> readRed(const GladGLContext& gl, std::uint32_t texture, const glm::uvec2& size) {
    std::vector<float> values(std::size_t{size.x} * size.y);
    gl.GetTextureImage(texture, 0, GL_RED, GL_FLOAT, static_cast<GLsizei>(values.size() * 4),
                       values.data());
    return values;
}

void savePicture(const std::string& name, const std::vector<float>& values, const glm::uvec2& size,
                 float white) {
    const char* folder = std::getenv("LAMINA_TEST_PICTURES");
    if (!folder)
        return;
    std::ofstream out(std::string(folder) + "/" + name + ".pgm", std::ios::binary);
    out << "P5 " << size.x << " " << size.y << " 255\n";
    for (std::uint32_t y = size.y; y-- > 0;)
        for (std::uint32_t x = 0; x < size.x; ++x)
            out.put(static_cast<char>(
                255.0f * std::clamp(values[std::size_t{y} * size.x + x] / white, 0.0f, 1.0f)));
}

} // namespace lamina::test
