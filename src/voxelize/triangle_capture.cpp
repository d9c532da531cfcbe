#include "voxelize/triangle_capture.hpp"

#include "voxelize/mesh_view.hpp"
#include "voxelize/volume_mesh.hpp"

#include "lamina/shared/constants.glsl"

#include <algorithm>
#include <string>

namespace lamina {
namespace {

/// Of a source that does not say how many it draws.
constexpr std::uint64_t kFirstCapacity = 1u << 16u;
constexpr std::uint64_t kGrowth = 4;
/// A NaN that no arithmetic makes: marks what was not drawn.
constexpr GLuint kUnused = 0xffffffffu;

} // namespace

TriangleCapture::TriangleCapture(std::shared_ptr<gl::DeviceState> device, CaptureContent content)
    : mDevice(std::move(device))
    , mContent(content)
    , mFeedback(gl::TransformFeedback::create(mDevice, "lamina capture"))
    , mFramebuffer(gl::Framebuffer::create(mDevice, "lamina capture"))
    , mVertexArray(createAttributeArray(mDevice)) {
    const GladGLContext& gl = mDevice->gl;
    // A draw needs a complete framebuffer, even if it rasterizes nothing.
    gl.NamedFramebufferParameteri(mFramebuffer.id(), GL_FRAMEBUFFER_DEFAULT_WIDTH, 1);
    gl.NamedFramebufferParameteri(mFramebuffer.id(), GL_FRAMEBUFFER_DEFAULT_HEIGHT, 1);
}

std::uint64_t TriangleCapture::triangleBytes() const {
    return 3 * (keepsSurfaces() ? LAMINA_CAPTURE_SURFACE_BYTES : LAMINA_CAPTURE_POSITION_BYTES);
}

Result<GLuint> TriangleCapture::buildProgram(const gl::ProgramStage& stage) const {
    return gl::findOrBuildProgram(
        *mDevice,
        {"lamina capture", {stage}, {{"LAMINA_CAPTURE_SURFACE", keepsSurfaces() ? "1" : "0"}}});
}

Result<GLuint> TriangleCapture::program(const DrawSource& source) const {
    return buildProgram({GL_VERTEX_SHADER, "voxelize/capture_main.glsl", source.vertexShader});
}

Result<GLuint> TriangleCapture::meshProgram() const {
    return buildProgram({GL_VERTEX_SHADER, "voxelize/capture_mesh.vert"});
}

Result<void> TriangleCapture::checkHost() const {
    GLboolean active = GL_FALSE;
    mDevice->gl.GetBooleanv(GL_TRANSFORM_FEEDBACK_ACTIVE, &active);
    if (active)
        return Error{ErrorCode::InvalidArgument,
                     "voxelize: expected no active transform feedback for sources that a compute "
                     "backend captures, found one of the host; end it before the call"};
    return {};
}

Result<CapturedTriangles> TriangleCapture::capture(std::size_t slot, const DrawSource& source,
                                                   GLuint program) {
    const auto draw = [&](gl::RasterStateGuard& guard) {
        guard.setHostPrimitiveRestart(true);
        DrawContext context;
        context.program = program;
        source.draw(context);
    };
    std::uint64_t triangles = source.maxTriangles;
    const bool isCounted = triangles != 0;
    if (!isCounted)
        triangles = std::max(kFirstCapacity, capacity(slot));
    for (;; triangles *= kGrowth) {
        if (auto reserved = reserve(slot, triangles); !reserved)
            return reserved.error();
        run(slot, program, draw);
        if (isCounted || !isFull(slot))
            return CapturedTriangles{mBuffers[slot].id(), mContent,
                                     isCounted ? triangles : capacity(slot)};
    }
}

Result<CapturedTriangles> TriangleCapture::capture(std::size_t slot, const MeshView& view,
                                                   GLuint program) {
    const std::uint64_t triangles = triangleCount(view);
    if (auto reserved = reserve(slot, triangles); !reserved)
        return reserved.error();
    if (!mDefaultAttributes) {
        auto defaults = createDefaultAttributes(mDevice);
        if (!defaults)
            return defaults.error();
        mDefaultAttributes = std::move(*defaults);
    }
    MeshView drawn = view;
    if (!keepsSurfaces())
        drawn.normals = drawn.colors = {}; // they have not been checked
    run(slot, program, [&](gl::RasterStateGuard& guard) {
        guard.setHostPrimitiveRestart(false);
        mDevice->gl.BindVertexArray(mVertexArray.id());
        bindMeshAttributes(*mDevice, mVertexArray.id(), mDefaultAttributes.id(), drawn);
        drawMeshView(*mDevice, mVertexArray.id(), drawn);
    });
    return CapturedTriangles{mBuffers[slot].id(), mContent, triangles};
}

Result<void> TriangleCapture::reserve(std::size_t slot, std::uint64_t triangles) {
    if (mBuffers.size() <= slot)
        mBuffers.resize(slot + 1);
    if (capacity(slot) >= triangles)
        return {};
    auto buffer = gl::createBuffer(mDevice, triangles * triangleBytes(), nullptr, 0,
                                   "voxelize: source " + std::to_string(slot) + ", capture of " +
                                       std::to_string(triangles) + " triangles",
                                   "lamina capture");
    if (!buffer)
        return buffer.error();
    mBuffers[slot] = std::move(*buffer);
    return {};
}

std::uint64_t TriangleCapture::bytes() const {
    std::uint64_t sum = mDefaultAttributes.bytes();
    for (const gl::Buffer& buffer : mBuffers)
        sum += buffer.bytes();
    return sum;
}

void TriangleCapture::run(std::size_t slot, GLuint program, const Draw& draw) {
    const GladGLContext& gl = mDevice->gl;
    const gl::Buffer& buffer = mBuffers[slot];
    {
        const gl::PixelUnpackGuard unpack(*mDevice);
        gl.ClearNamedBufferData(buffer.id(), GL_R32UI, GL_RED_INTEGER, GL_UNSIGNED_INT, &kUnused);
    }
    gl::RasterStateGuard guard(*mDevice, 2);
    gl.Enable(GL_RASTERIZER_DISCARD);
    gl.BindFramebuffer(GL_DRAW_FRAMEBUFFER, mFramebuffer.id());
    gl.UseProgram(program);
    gl.TransformFeedbackBufferBase(mFeedback.id(), 0, buffer.id());
    gl.BindTransformFeedback(GL_TRANSFORM_FEEDBACK, mFeedback.id());
    gl.BeginTransformFeedback(GL_TRIANGLES);
    draw(guard);
    gl.EndTransformFeedback();
    gl.TransformFeedbackBufferBase(mFeedback.id(), 0, 0);
}

bool TriangleCapture::isFull(std::size_t slot) const {
    std::vector<GLuint> last(triangleBytes() / sizeof(GLuint));
    mDevice->gl.GetNamedBufferSubData(mBuffers[slot].id(),
                                      static_cast<GLintptr>((capacity(slot) - 1) * triangleBytes()),
                                      static_cast<GLsizeiptr>(triangleBytes()), last.data());
    return !std::ranges::all_of(last, [](GLuint word) { return word == kUnused; });
}

std::uint64_t TriangleCapture::capacity(std::size_t slot) const {
    return slot < mBuffers.size() ? mBuffers[slot].bytes() / triangleBytes() : 0;
}

} // namespace lamina
