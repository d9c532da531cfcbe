// The README's lines of engine code, with a small engine around them: a torus in the engine's own
// buffers, voxelized, and asked about by a compute shader of the engine.

#include "support/check.hpp"
#include "support/host_gl.hpp"

#include <lamina/gl/device.hpp>
#include <lamina/gl/shaders.hpp>
#include <lamina/grid/grid_transform.hpp>
#include <lamina/grid/voxel_grid.hpp>
#include <lamina/headless/context.hpp>
#include <lamina/voxelize/voxelizer.hpp>

#include <glm/gtc/constants.hpp>
#include <glm/vec4.hpp>

#include <array>
#include <cmath>
#include <vector>

namespace {

using example::check;
using example::HostGl;

struct Vertex {
    glm::vec3 position;
    glm::vec3 normal;
};

struct EngineMesh {
    GLuint vertexBuffer = 0;
    GLuint indexBuffer = 0;
    std::uint32_t vertexCount = 0;
    std::uint32_t indexCount = 0;
};

/// A torus around y: radius 0.7 to the middle of a tube 0.2 wide.
EngineMesh makeTorus(const HostGl& gl) {
    constexpr unsigned kAround = 96, kTube = 48;
    std::vector<Vertex> vertices;
    std::vector<std::uint16_t> indices;
    for (unsigned i = 0; i < kAround; ++i)
        for (unsigned j = 0; j < kTube; ++j) {
            const float u = glm::two_pi<float>() * static_cast<float>(i) / kAround;
            const float v = glm::two_pi<float>() * static_cast<float>(j) / kTube;
            const glm::vec3 outward(std::cos(u), 0.0f, std::sin(u));
            const glm::vec3 normal = std::cos(v) * outward + glm::vec3(0.0f, std::sin(v), 0.0f);
            vertices.push_back({0.7f * outward + 0.2f * normal, normal});
            const auto index = [](unsigned a, unsigned b) {
                return static_cast<std::uint16_t>(a % kAround * kTube + b % kTube);
            };
            indices.insert(indices.end(), {index(i, j), index(i, j + 1), index(i + 1, j),
                                           index(i + 1, j), index(i, j + 1), index(i + 1, j + 1)});
        }
    return {example::makeBuffer(gl, std::as_bytes(std::span(vertices))),
            example::makeBuffer(gl, std::as_bytes(std::span(indices))),
            static_cast<std::uint32_t>(vertices.size()),
            static_cast<std::uint32_t>(indices.size())};
}

constexpr const char* kQuery = R"(
layout(local_size_x = 1) in;
layout(std430, binding = 0) buffer Points { vec4 points[]; };
void main() {
    uint i = gl_WorkGroupID.x;
    points[i].w = laminaPointSet(0, points[i].xyz) ? 1.0 : 0.0;
}
)";

/// The engine's shader reads the voxels; true if its answers are right.
bool ask(const HostGl& gl) {
    struct Question {
        const char* text;
        glm::vec4 point; ///< w becomes the answer.
        bool expected;
    };
    const std::array questions{
        Question{"on the torus", {0.7f, 0.2f, 0.0f, 0.0f}, true},
        Question{"on its other side", {0.0f, -0.2f, -0.7f, 0.0f}, true},
        Question{"inside its tube", {0.7f, 0.0f, 0.0f, 0.0f}, false},
        Question{"in its hole", {0.0f, 0.0f, 0.0f, 0.0f}, false},
        Question{"beyond the grid", {5.0f, 0.0f, 0.0f, 0.0f}, false},
    };
    std::array<glm::vec4, questions.size()> points;
    for (std::size_t i = 0; i < points.size(); ++i)
        points[i] = questions[i].point;

    const std::string shader =
        "#version 450\n" + check(lamina::shaderSource("lamina/grid.glsl")) + kQuery;
    const GLuint buffer = example::makeBuffer(gl, std::as_bytes(std::span(points)));
    gl.UseProgram(example::makeProgram(gl, {{GL_COMPUTE_SHADER, shader}}));
    gl.BindBufferBase(GL_SHADER_STORAGE_BUFFER, 0, buffer);
    gl.DispatchCompute(static_cast<GLuint>(points.size()), 1, 1);
    gl.MemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
    gl.GetNamedBufferSubData(buffer, 0, sizeof points, points.data());

    bool right = true;
    for (std::size_t i = 0; i < points.size(); ++i) {
        const bool answer = points[i].w != 0.0f;
        std::printf("%-18s %s\n", questions[i].text, answer ? "set" : "not set");
        right = right && answer == questions[i].expected;
    }
    return right;
}

bool run() {
    lamina::headless::Context context = check(lamina::headless::Context::create());
    const auto load = [&](const char* name) { return context.getProcAddress(name); };
    const HostGl gl(load);
    const EngineMesh torus = makeTorus(gl);
    const glm::mat4 model(1.0f);

    // README begin
    using lamina::Axis, lamina::Box3, lamina::Coverage, lamina::Device;
    using lamina::GeometrySource, lamina::GridTransform, lamina::IndexType;
    using lamina::MeshView, lamina::VoxelGrid, lamina::Voxelizer;
    // Once. The engine's context is current, `load` is its getProcAddress.
    Device device = check(Device::fromCurrentContext(load));
    auto voxelizer = check(Voxelizer::create(device, {.coverage = Coverage::Filled}));
    VoxelGrid voxels = check(VoxelGrid::create(device));
    const Box3 box{{-1, -1, -1}, {1, 1, 1}};
    const auto place = check(GridTransform::box(box, {256, 256, 256}, Axis::Y));

    // Every frame. The engine's own buffers in, a texture of bits out; nothing waits for the GPU.
    const GeometrySource sources[] = {MeshView{.vertexBuffer = torus.vertexBuffer,
                                               .vertexStrideBytes = sizeof(Vertex),
                                               .vertexCount = torus.vertexCount,
                                               .indexBuffer = torus.indexBuffer,
                                               .indexType = IndexType::UInt16,
                                               .indexCount = torus.indexCount,
                                               .model = model}};
    check(voxelizer->voxelize(sources, place, voxels));
    voxels.bind(); // for engine shaders that include <lamina/grid.glsl>
    // README end

    return ask(gl);
}

} // namespace

int main() {
    return run() ? 0 : 1;
}
