// Near and far depth of every column: in one pass by MIN blending, as local slicemaps find them,
// beside the two passes it saves.

#include "bench_case.hpp"
#include "gl_timing.hpp"

#include "gl/fragment_guards.hpp"
#include "gl/state_guard.hpp"
#include "grid/grid_constants.hpp"
#include "voxelize/slicemap_draw.hpp"

#include <glm/gtc/type_ptr.hpp>

namespace lamina::bench {
namespace {

constexpr std::uint32_t kColumns = 1024;

enum class Method {
    OnePass,        ///< Near and far at once.
    TwoPasses,      ///< The same exact depths, near and far by themselves.
    TwoDepthPasses, ///< The depth buffer's nearest and farthest samples: snapped, one a column.
};

struct Targets {
    gl::Framebuffer framebuffer;
    gl::Texture texture;
};

Result<Targets> makeTargets(const std::shared_ptr<gl::DeviceState>& device, Method method) {
    const bool isDepth = method == Method::TwoDepthPasses;
    auto texture = gl::createTexture2d(device, isDepth ? GL_DEPTH_COMPONENT32F : GL_RG32F,
                                       isDepth ? 4 : 8, kColumns, kColumns, "bench", "bench");
    if (!texture)
        return texture.error();
    Targets targets{gl::Framebuffer::create(device, "bench"), std::move(*texture)};
    device->gl.NamedFramebufferTexture(targets.framebuffer.id(),
                                       isDepth ? GL_DEPTH_ATTACHMENT : GL_COLOR_ATTACHMENT0,
                                       targets.texture.id(), 0);
    return targets;
}

/// The range pass of local slicemaps, once or for each end of the range.
void drawExact(gl::DeviceState& device, SlicemapDraw& draw, std::span<const SlicemapPass> passes,
               const GridTransform& transform, const Targets& targets) {
    const GladGLContext& gl = device.gl;
    gl::RasterStateGuard guard(device, 2);
    const gl::BlendStateGuard blend(device, 1, gl::Blending::Minimum);
    draw.upload(passes, transform);
    constexpr float kEmpty[] = {static_cast<float>(LAMINA_EMPTY_COLUMN),
                                static_cast<float>(LAMINA_EMPTY_COLUMN), 0.0f, 0.0f};
    gl.ClearNamedFramebufferfv(targets.framebuffer.id(), GL_COLOR, 0, kEmpty);
    gl.BindFramebuffer(GL_DRAW_FRAMEBUFFER, targets.framebuffer.id());
    gl.ViewportIndexedf(0, 0.0f, 0.0f, kColumns, kColumns);
    const bool both = passes.size() == 1;
    for (std::uint32_t pass = 0; pass < passes.size(); ++pass) {
        gl.ColorMaski(0, both || pass == 0, both || pass == 1, GL_FALSE, GL_FALSE);
        draw.draw(passes, pass, guard, [] {});
    }
}

constexpr const char* kDepthVertex = R"(#version 450 core
layout(location = 0) in vec3 position;
layout(location = 0) uniform mat4 worldToClip;
void main() { gl_Position = worldToClip * vec4(position, 1.0); }
)";

class DepthPasses {
public:
    DepthPasses(const GladGLContext& gl, const MeshView& mesh, const GridTransform& transform)
        : mGl(gl)
        , mProgram(gl.CreateShaderProgramv(GL_VERTEX_SHADER, 1, &kDepthVertex))
        , mIndexCount(static_cast<GLsizei>(mesh.indexCount)) {
        gl.CreateVertexArrays(1, &mVertexArray);
        gl.EnableVertexArrayAttrib(mVertexArray, 0);
        gl.VertexArrayAttribFormat(mVertexArray, 0, 3, GL_FLOAT, GL_FALSE, 0);
        gl.VertexArrayVertexBuffer(mVertexArray, 0, mesh.vertexBuffer,
                                   static_cast<GLintptr>(mesh.positionOffsetBytes),
                                   static_cast<GLsizei>(mesh.vertexStrideBytes));
        gl.VertexArrayElementBuffer(mVertexArray, mesh.indexBuffer);
        glm::dmat4 columnToClip(1.0);
        const glm::dvec3 size(transform.size().x, transform.size().y, transform.farDepth());
        for (int i = 0; i < 3; ++i) {
            columnToClip[i][i] = 2.0 / size[i];
            columnToClip[3][i] = -1.0;
        }
        mWorldToClip = glm::mat4(columnToClip * transform.worldToColumn());
    }
    ~DepthPasses() {
        mGl.DeleteVertexArrays(1, &mVertexArray);
        mGl.DeleteProgram(mProgram);
    }
    DepthPasses(const DepthPasses&) = delete;
    DepthPasses& operator=(const DepthPasses&) = delete;

    void draw(gl::DeviceState& device, const Targets& targets) const {
        const gl::RasterStateGuard guard(device, 0);
        mGl.BindFramebuffer(GL_DRAW_FRAMEBUFFER, targets.framebuffer.id());
        mGl.ViewportIndexedf(0, 0.0f, 0.0f, kColumns, kColumns);
        mGl.UseProgram(mProgram);
        mGl.ProgramUniformMatrix4fv(mProgram, 0, 1, GL_FALSE, glm::value_ptr(mWorldToClip));
        mGl.BindVertexArray(mVertexArray);
        mGl.Enable(GL_DEPTH_TEST);
        for (const bool isNear : {true, false}) {
            const float clear = isNear ? 1.0f : 0.0f;
            mGl.ClearNamedFramebufferfv(targets.framebuffer.id(), GL_DEPTH, 0, &clear);
            mGl.DepthFunc(isNear ? GL_LESS : GL_GREATER);
            mGl.DrawElements(GL_TRIANGLES, mIndexCount, GL_UNSIGNED_INT, nullptr);
        }
        mGl.Disable(GL_DEPTH_TEST);
        mGl.DepthFunc(GL_LESS);
    }

private:
    const GladGLContext& mGl;
    GLuint mProgram;
    GLuint mVertexArray = 0;
    GLsizei mIndexCount;
    glm::mat4 mWorldToClip{1.0f};
};

Result<void> run(benchmark::State& state, const Device& device, const TriangleMesh& mesh,
                 Coverage coverage, Method method) {
    const std::shared_ptr<gl::DeviceState>& gl = device.state();
    const auto transform = GridTransform::box(mesh.bounds(), {kColumns, kColumns, 128});
    if (!transform)
        return transform.error();
    auto buffers = MeshBuffers::upload(device, mesh);
    auto targets = makeTargets(gl, method);
    if (!buffers || !targets)
        return buffers ? targets.error() : buffers.error();
    const GeometrySource sources[] = {buffers->view()};
    SlicemapDraw draw(gl);
    auto prepared = draw.prepare(sources, *transform, slicemapRangeStage(coverage));
    if (!prepared)
        return prepared.error();
    SlicemapPass pass;
    pass.sources = &*prepared;
    pass.farDepth = transform->farDepth();
    const std::vector<SlicemapPass> passes(method == Method::OnePass ? 1 : 2, pass);
    const DepthPasses depthPasses(gl->gl, buffers->view(), *transform);
    auto measured = measure(state, device, [&]() -> Result<void> {
        if (method == Method::TwoDepthPasses)
            depthPasses.draw(*gl, *targets);
        else
            drawExact(*gl, draw, passes, *transform, *targets);
        return {};
    });
    if (measured)
        report(state, mesh, *transform, 0, targets->texture.bytes());
    return measured;
}

} // namespace

void registerRanges(const Device& device, const std::shared_ptr<NamedMesh>& mesh) {
    struct Row {
        const char* name;
        Coverage coverage;
        Method method;
    };
    for (const Row& row :
         {Row{"near and far, one pass", Coverage::Sampled, Method::OnePass},
          Row{"near and far, two passes", Coverage::Sampled, Method::TwoPasses},
          Row{"near and far, two depth passes", Coverage::Sampled, Method::TwoDepthPasses},
          Row{"near and far filled, one pass", Coverage::Filled, Method::OnePass},
          Row{"near and far filled, two passes", Coverage::Filled, Method::TwoPasses}}) {
        registerMethod(mesh->name + "/1024x1024 columns/" + row.name,
                       [=, &device](benchmark::State& state) -> Result<void> {
                           auto loaded = mesh->get();
                           if (!loaded)
                               return loaded.error();
                           return run(state, device, **loaded, row.coverage, row.method);
                       });
    }
}

} // namespace lamina::bench
