// A host engine with a shader of its own that includes <lamina/transmittance.glsl>: three leaves,
// and points before, between and behind them.
#include "installed_shader.hpp"

#include <lamina/headless/context.hpp>
#include <lamina/transmittance/transmittance.hpp>

#include <GL/glcorearb.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>

namespace {

template<class T>
T checked(lamina::Result<T> result) {
    if (!result) {
        std::fprintf(stderr, "transmittance_program: %s\n", result.error().text.c_str());
        std::exit(1);
    }
    return std::move(*result);
}

template<class Function>
Function load(const lamina::headless::Context& context, const char* name) {
    return reinterpret_cast<Function>(context.getProcAddress(name));
}

lamina::TriangleMesh threeLeaves() {
    lamina::TriangleMesh mesh;
    for (std::uint32_t i = 0; i < 3; ++i) {
        const float y = 3.0f - static_cast<float>(i);
        mesh.positions.insert(mesh.positions.end(),
                              {{-1, y, -1}, {1, y, -1}, {1, y, 1}, {-1, y, 1}});
        mesh.triangles.insert(mesh.triangles.end(),
                              {{4 * i, 4 * i + 1, 4 * i + 2}, {4 * i, 4 * i + 2, 4 * i + 3}});
    }
    return mesh;
}

constexpr const char* kShader = R"(#include <lamina/transmittance.glsl>
layout(local_size_x = 1) in;
layout(std430, binding = 0) buffer Answers { float answers[4]; };
void main() {
    for (int i = 0; i < 4; ++i)
        answers[i] = laminaTransmittance(vec3(0.25, 3.5 - float(i), 0.25), vec3(0.0)).g;
}
)";

} // namespace

int main() {
    const auto context = checked(lamina::headless::Context::create());
    const lamina::Device device = checked(lamina::Device::fromCurrentContext(
        [&](const char* name) { return context.getProcAddress(name); }));
    const auto leaves = checked(lamina::MeshBuffers::upload(device, threeLeaves()));
    const lamina::GeometrySource sources[] = {leaves.view()};
    lamina::Transmittance transmittance =
        checked(lamina::Transmittance::create(device, {.size = {64, 64, 128}}));
    lamina::TransmittanceCasters casters;
    casters.leaves = sources;
    casters.bounds = {{-1.0, 0.0, -1.0}, {1.0, 4.0, 1.0}};
    checked(transmittance.prepare({}, casters)); // The default light shines down.

    const std::string source = "#version 450\n" + transmittance.shaderDefines(3, 5) +
                               installedShader(HOST_SHADER_DIR, kShader);
    const char* text = source.c_str();
    const GLuint program = load<PFNGLCREATESHADERPROGRAMVPROC>(context, "glCreateShaderProgramv")(
        GL_COMPUTE_SHADER, 1, &text);
    GLuint buffer = 0;
    load<PFNGLCREATEBUFFERSPROC>(context, "glCreateBuffers")(1, &buffer);
    load<PFNGLNAMEDBUFFERDATAPROC>(context, "glNamedBufferData")(buffer, 16, nullptr,
                                                                 GL_STATIC_READ);
    load<PFNGLBINDBUFFERBASEPROC>(context, "glBindBufferBase")(GL_SHADER_STORAGE_BUFFER, 0, buffer);
    transmittance.bind(3, 5);
    load<PFNGLUSEPROGRAMPROC>(context, "glUseProgram")(program);
    load<PFNGLDISPATCHCOMPUTEPROC>(context, "glDispatchCompute")(1, 1, 1);
    load<PFNGLMEMORYBARRIERPROC>(context, "glMemoryBarrier")(GL_BUFFER_UPDATE_BARRIER_BIT);
    std::array<float, 4> answers{};
    load<PFNGLGETNAMEDBUFFERSUBDATAPROC>(context, "glGetNamedBufferSubData")(
        buffer, 0, sizeof answers, answers.data());
    for (std::size_t i = 0; i < 4; ++i)
        if (std::abs(answers[i] - std::pow(0.9f, static_cast<float>(i))) > 1e-5f) {
            std::fprintf(stderr, "expected 0.9^%zu behind %zu leaves, found %g\n", i, i,
                         answers[i]);
            return 1;
        }
    std::printf("0.9^n behind n leaves\n");
    return 0;
}
