// A host engine in one file: its own EGL context, function pointers, vertex buffer and compute
// shader. It hands them to Lamina and checks each voxel and the answers of the GLSL queries.
#include "installed_shader.hpp"

#include <lamina/gl/device.hpp>
#include <lamina/grid/voxel_grid.hpp>
#include <lamina/voxelize/voxelizer.hpp>

#define EGL_NO_X11 // X11 headers define macros such as None.
#include <EGL/egl.h>
#include <EGL/eglext.h>
#include <GL/glcorearb.h>

#include <array>
#include <cstddef>
#include <cstdio>
#include <cstdlib>
#include <string>

namespace {

[[noreturn]] void fail(const std::string& text) {
    std::fprintf(stderr, "host_program: %s\n", text.c_str());
    std::exit(1);
}

void expect(bool condition, const std::string& what) {
    if (!condition)
        fail("expected " + what);
}

template<class T>
T checked(lamina::Result<T> result) {
    if (!result)
        fail(result.error().text);
    return std::move(*result);
}

template<class Function>
Function load(const char* name) {
    return reinterpret_cast<Function>(eglGetProcAddress(name));
}

EGLDisplay surfacelessDisplay() {
    const auto getDisplay = load<PFNEGLGETPLATFORMDISPLAYEXTPROC>("eglGetPlatformDisplayEXT");
    return getDisplay ? getDisplay(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, nullptr)
                      : EGL_NO_DISPLAY;
}

EGLDisplay firstDeviceDisplay() {
    const auto getDisplay = load<PFNEGLGETPLATFORMDISPLAYEXTPROC>("eglGetPlatformDisplayEXT");
    const auto queryDevices = load<PFNEGLQUERYDEVICESEXTPROC>("eglQueryDevicesEXT");
    EGLDeviceEXT device = nullptr;
    EGLint count = 0;
    if (!getDisplay || !queryDevices || !queryDevices(1, &device, &count) || count == 0)
        return EGL_NO_DISPLAY;
    return getDisplay(EGL_PLATFORM_DEVICE_EXT, device, nullptr);
}

bool makeContext(EGLDisplay display) {
    if (display == EGL_NO_DISPLAY || !eglInitialize(display, nullptr, nullptr) ||
        !eglBindAPI(EGL_OPENGL_API))
        return false;
    constexpr std::array<EGLint, 7> kAttributes{EGL_CONTEXT_MAJOR_VERSION,
                                                4,
                                                EGL_CONTEXT_MINOR_VERSION,
                                                5,
                                                EGL_CONTEXT_OPENGL_PROFILE_MASK,
                                                EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT,
                                                EGL_NONE};
    EGLContext context =
        eglCreateContext(display, EGL_NO_CONFIG_KHR, EGL_NO_CONTEXT, kAttributes.data());
    return context != EGL_NO_CONTEXT &&
           eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, context);
}

/// The engine's own function table.
struct Gl {
    PFNGLCREATEBUFFERSPROC createBuffers = load<PFNGLCREATEBUFFERSPROC>("glCreateBuffers");
    PFNGLNAMEDBUFFERSTORAGEPROC bufferStorage =
        load<PFNGLNAMEDBUFFERSTORAGEPROC>("glNamedBufferStorage");
    PFNGLGETNAMEDBUFFERSUBDATAPROC bufferData =
        load<PFNGLGETNAMEDBUFFERSUBDATAPROC>("glGetNamedBufferSubData");
    PFNGLBINDBUFFERBASEPROC bindBufferBase = load<PFNGLBINDBUFFERBASEPROC>("glBindBufferBase");
    PFNGLCREATESHADERPROGRAMVPROC createProgram =
        load<PFNGLCREATESHADERPROGRAMVPROC>("glCreateShaderProgramv");
    PFNGLGETPROGRAMIVPROC programValue = load<PFNGLGETPROGRAMIVPROC>("glGetProgramiv");
    PFNGLGETPROGRAMINFOLOGPROC programLog = load<PFNGLGETPROGRAMINFOLOGPROC>("glGetProgramInfoLog");
    PFNGLUSEPROGRAMPROC useProgram = load<PFNGLUSEPROGRAMPROC>("glUseProgram");
    PFNGLDISPATCHCOMPUTEPROC dispatch = load<PFNGLDISPATCHCOMPUTEPROC>("glDispatchCompute");
    PFNGLMEMORYBARRIERPROC barrier = load<PFNGLMEMORYBARRIERPROC>("glMemoryBarrier");
    PFNGLGETERRORPROC error = load<PFNGLGETERRORPROC>("glGetError");

    [[nodiscard]] GLuint buffer(const void* data, std::size_t bytes) const {
        GLuint name = 0;
        createBuffers(1, &name);
        bufferStorage(name, static_cast<GLsizeiptr>(bytes), data, 0);
        return name;
    }
};

struct Vertex {
    float textureCoordinates[2];
    float position[3];
    float weight;
};

/// Triangles of the rectangle [2,10] x [3,7] at z = 5.5.
lamina::MeshView rectangle(const Gl& gl) {
    constexpr std::array<Vertex, 4> kVertices{{{{0, 0}, {2, 3, 5.5f}, 1},
                                               {{1, 0}, {10, 3, 5.5f}, 1},
                                               {{1, 1}, {10, 7, 5.5f}, 1},
                                               {{0, 1}, {2, 7, 5.5f}, 1}}};
    constexpr std::array<std::uint16_t, 6> kIndices{0, 1, 2, 0, 2, 3};
    lamina::MeshView view;
    view.vertexBuffer = gl.buffer(kVertices.data(), sizeof(kVertices));
    view.positionOffsetBytes = offsetof(Vertex, position);
    view.vertexStrideBytes = sizeof(Vertex);
    view.vertexCount = kVertices.size();
    view.indexBuffer = gl.buffer(kIndices.data(), sizeof(kIndices));
    view.indexType = lamina::IndexType::UInt16;
    view.indexCount = kIndices.size();
    return view;
}

void checkVoxels(const lamina::BitGrid& grid) {
    std::uint64_t count = 0;
    grid.forEachSet([&](const glm::uvec3& voxel) {
        expect(voxel.x >= 2 && voxel.x < 10 && voxel.y >= 3 && voxel.y < 7 && voxel.z == 5,
               "voxels inside the rectangle only");
        ++count;
    });
    expect(count == 8 * 4 && grid.count() == count, "32 voxels, found " + std::to_string(count));
}

GLuint queryProgram(const Gl& gl) {
    const std::string source = installedShader(HOST_SHADER_DIR, R"(#version 450
#define LAMINA_GRID_BLOCK_BINDING 3
#define LAMINA_GRID_TEXTURE_UNIT 5
#include <lamina/grid.glsl>
layout(local_size_x = 1) in;
layout(std430, binding = 0) buffer Answers { int answers[4]; };
void main() {
    answers[0] = int(laminaPointSet(0, vec3(4.5, 4.5, 5.5)));
    answers[1] = int(laminaPointSet(0, vec3(4.5, 4.5, 6.5)));
    answers[2] = laminaPointCountNearer(0, vec3(4.5, 4.5, 9.5));
    answers[3] = laminaPointCountNearer(0, vec3(4.5, 4.5, 2.5));
}
)");
    const char* text = source.c_str();
    const GLuint program = gl.createProgram(GL_COMPUTE_SHADER, 1, &text);
    GLint linked = 0;
    gl.programValue(program, GL_LINK_STATUS, &linked);
    std::string log(4096, '\0');
    gl.programLog(program, static_cast<GLsizei>(log.size()), nullptr, log.data());
    expect(linked != 0, "a program that links: " + log);
    return program;
}

void checkQueries(const Gl& gl, const lamina::VoxelGrid& grid) {
    const std::array<GLint, 4> kUnset{-1, -1, -1, -1};
    const GLuint answers = gl.buffer(kUnset.data(), sizeof(kUnset));
    gl.useProgram(queryProgram(gl));
    gl.bindBufferBase(GL_SHADER_STORAGE_BUFFER, 0, answers);
    grid.bind(3, 5);
    gl.dispatch(1, 1, 1);
    gl.barrier(GL_BUFFER_UPDATE_BARRIER_BIT);
    std::array<GLint, 4> found{};
    gl.bufferData(answers, 0, sizeof(found), found.data());
    expect((found == std::array<GLint, 4>{1, 0, 1, 0}), "the queries to answer 1 0 1 0");
}

} // namespace

int main() {
    expect(makeContext(surfacelessDisplay()) || makeContext(firstDeviceDisplay()),
           "an OpenGL 4.5 context");
    const Gl gl;

    {
        const lamina::Device device =
            checked(lamina::Device::fromCurrentContext(eglGetProcAddress));
        const auto voxelizer = checked(lamina::Voxelizer::create(device));
        lamina::VoxelGrid grid = checked(lamina::VoxelGrid::create(device));
        const lamina::GridTransform transform = checked(
            lamina::GridTransform::box({glm::dvec3(0.0), glm::dvec3(16.0)}, glm::uvec3(16)));
        const std::array<lamina::GeometrySource, 1> sources{rectangle(gl)};
        checked(voxelizer->voxelize(sources, transform, grid));
        checkVoxels(checked(grid.download()));
        checkQueries(gl, grid);
    }
    expect(gl.error() == GL_NO_ERROR, "no GL error");
    std::printf("32 voxels on %s\n", eglQueryString(eglGetCurrentDisplay(), EGL_VENDOR));
    return 0;
}
