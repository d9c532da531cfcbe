// Geometry that exists only on the GPU: a sea anemone whose arms bend by bone matrices in the
// engine's own vertex stage, voxelized anew for each frame. Writes the frames side by side.
//
//   skinned_source OUT.png

#include "support/check.hpp"
#include "support/host_gl.hpp"
#include "support/shapes.hpp"

#include <lamina/grid/voxel_grid.hpp>
#include <lamina/grid_io/image.hpp>
#include <lamina/grid_io/preview.hpp>
#include <lamina/headless/context.hpp>
#include <lamina/voxelize/voxelizer.hpp>

#include <glm/gtc/constants.hpp>
#include <glm/gtc/matrix_transform.hpp>

#include <algorithm>
#include <cmath>

namespace {

using example::check;
using example::HostGl;

constexpr unsigned kArms = 16;
constexpr unsigned kBones = 9; ///< An arm has this many, one above the other.
constexpr float kBoneLength = 0.19f;
constexpr unsigned kFrames = 4;
constexpr std::uint32_t kFrameWidth = 400, kFrameHeight = 320;

/// The engine's vertex stage as it is in the engine's own passes, but for its last line.
constexpr const char* kVertexStage = R"(
layout(location = 0) in vec3 position;
layout(location = 1) in float bone; // Between two bones: their mix.
layout(std430, binding = 0) readonly buffer Bones { mat4 bones[]; };

LaminaVertex laminaVertex() {
    int lower = int(bone);
    vec3 below = (bones[lower] * vec4(position, 1.0)).xyz;
    vec3 above = (bones[lower + 1] * vec4(position, 1.0)).xyz;
    return LaminaVertex(mix(below, above, fract(bone)), vec3(0.0), 0u);
}
)";

struct SkinnedVertex {
    glm::vec3 position; ///< Arm at rest: upright over the origin.
    float bone;
};

/// The body, which bone 0 leaves in its place, and the arms.
lamina::TriangleMesh makeRestPose(std::vector<float>& bones) {
    lamina::TriangleMesh mesh;
    example::addRevolved(mesh,
                         std::vector<glm::vec2>{{0.0f, -0.75f},
                                                {0.85f, -0.74f},
                                                {0.62f, -0.5f},
                                                {0.50f, -0.25f},
                                                {0.58f, 0.0f},
                                                {0.66f, 0.12f},
                                                {0.45f, 0.16f},
                                                {0.0f, 0.05f}},
                         64, [](const glm::vec3& p) { return p; });
    bones.assign(mesh.positions.size(), 0.0f);

    constexpr unsigned kRings = 26;
    constexpr float kLength = kBoneLength * (kBones - 1);
    std::vector<glm::vec3> path;
    std::vector<float> radii;
    for (unsigned i = 0; i <= kRings; ++i) {
        const float t = static_cast<float>(i) / kRings;
        path.push_back({0.0f, kLength * t, 0.0f});
        radii.push_back(0.115f * (1.0f - 0.55f * t) *
                        std::sqrt(std::min(1.0f, 12.0f * (1.01f - t))));
    }
    for (unsigned arm = 0; arm < kArms; ++arm) {
        example::addTube(mesh, path, radii, 11);
        for (std::size_t v = bones.size(); v < mesh.positions.size(); ++v) {
            const float along = std::clamp(mesh.positions[v].y / kBoneLength, 0.0f, kBones - 1.01f);
            bones.push_back(1.0f + static_cast<float>(arm * kBones) + along);
        }
    }
    return mesh;
}

/// Bone matrices at `time` in [0,1): each bone turns a little against the one below it.
std::vector<glm::mat4> pose(float time) {
    std::vector<glm::mat4> bones{glm::mat4(1.0f)};
    for (unsigned arm = 0; arm < kArms; ++arm) {
        const bool isInner = arm % 2 == 0;
        const float around = glm::two_pi<float>() * static_cast<float>(arm) / kArms;
        const float phase = glm::two_pi<float>() * time + 3.0f * around;
        glm::mat4 joint = glm::rotate(glm::mat4(1.0f), around, {0, 1, 0});
        joint = glm::translate(joint, {isInner ? 0.26f : 0.50f, 0.0f, 0.0f});
        joint = glm::rotate(joint, isInner ? -0.15f : -0.62f, {0, 0, 1});
        for (unsigned bone = 0; bone < kBones; ++bone) {
            const float height = static_cast<float>(bone);
            bones.push_back(glm::translate(joint, {0.0f, -kBoneLength * height, 0.0f}));
            joint = glm::translate(joint, {0.0f, kBoneLength, 0.0f});
            const float outward = -0.05f + 0.26f * std::sin(phase - 0.55f * height);
            const float sideways = 0.18f * std::cos(phase - 0.45f * height);
            joint = glm::rotate(joint, outward, {0, 0, 1});
            joint = glm::rotate(joint, sideways, {1, 0, 0});
        }
    }
    return bones;
}

/// The engine's vertex array over its buffers.
GLuint makeVertexArray(const HostGl& gl, const lamina::TriangleMesh& mesh,
                       const std::vector<float>& bones) {
    std::vector<SkinnedVertex> vertices;
    for (std::size_t i = 0; i < bones.size(); ++i)
        vertices.push_back({mesh.positions[i], bones[i]});
    GLuint array = 0;
    gl.CreateVertexArrays(1, &array);
    gl.VertexArrayVertexBuffer(array, 0,
                               example::makeBuffer(gl, std::as_bytes(std::span(vertices))), 0,
                               sizeof(SkinnedVertex));
    gl.VertexArrayElementBuffer(array,
                                example::makeBuffer(gl, std::as_bytes(std::span(mesh.triangles))));
    gl.EnableVertexArrayAttrib(array, 0);
    gl.VertexArrayAttribFormat(array, 0, 3, GL_FLOAT, GL_FALSE, offsetof(SkinnedVertex, position));
    gl.VertexArrayAttribBinding(array, 0, 0);
    gl.EnableVertexArrayAttrib(array, 1);
    gl.VertexArrayAttribFormat(array, 1, 1, GL_FLOAT, GL_FALSE, offsetof(SkinnedVertex, bone));
    gl.VertexArrayAttribBinding(array, 1, 0);
    return array;
}

void paste(lamina::Image& strip, const lamina::Image& frame, std::uint32_t left) {
    for (std::uint32_t y = 0; y < frame.height; ++y)
        std::copy_n(frame.rgba.data() + std::size_t{4} * y * frame.width,
                    std::size_t{4} * frame.width,
                    strip.rgba.data() + std::size_t{4} * (y * strip.width + left));
}

void run(const char* file) {
    lamina::headless::Context context = check(lamina::headless::Context::create());
    const auto load = [&](const char* name) { return context.getProcAddress(name); };
    const HostGl gl(load);
    lamina::Device device = check(lamina::Device::fromCurrentContext(load));

    std::vector<float> boneOfVertex;
    const lamina::TriangleMesh mesh = makeRestPose(boneOfVertex);
    const GLuint vertexArray = makeVertexArray(gl, mesh, boneOfVertex);
    GLuint boneBuffer = 0;
    gl.CreateBuffers(1, &boneBuffer);

    const lamina::GeometrySource sources[] = {lamina::DrawSource{
        kVertexStage, [&](const lamina::DrawContext&) {
            gl.BindBufferBase(GL_SHADER_STORAGE_BUFFER, 0, boneBuffer);
            gl.BindVertexArray(vertexArray);
            gl.DrawElements(GL_TRIANGLES, static_cast<GLsizei>(3 * mesh.triangles.size()),
                            GL_UNSIGNED_INT, nullptr);
        }}};
    auto voxelizer =
        check(lamina::Voxelizer::create(device, {.coverage = lamina::Coverage::Filled}));
    lamina::VoxelGrid voxels = check(lamina::VoxelGrid::create(device));
    const auto place = check(lamina::GridTransform::box({{-1.6, -0.8, -1.6}, {1.6, 1.6, 1.6}},
                                                        {256, 192, 256}, lamina::Axis::Y));

    lamina::PreviewDesc look;
    look.width = kFrameWidth;
    look.height = kFrameHeight;
    look.viewDirection = {-0.25, -0.5, -1.0};
    look.margin = 0.0;
    look.lowColor = {0.20f, 0.10f, 0.38f};
    look.highColor = {1.0f, 0.55f, 0.42f};
    lamina::Image strip{kFrames * kFrameWidth, kFrameHeight, {}};
    strip.rgba.resize(std::size_t{4} * strip.width * strip.height);
    for (unsigned frame = 0; frame < kFrames; ++frame) {
        const auto bones = pose(static_cast<float>(frame) / kFrames);
        gl.NamedBufferData(boneBuffer, static_cast<GLsizeiptr>(bones.size() * sizeof(glm::mat4)),
                           bones.data(), GL_STREAM_DRAW);
        check(voxelizer->voxelize(sources, place, voxels));
        const lamina::BitGrid bits = check(voxels.download());
        paste(strip, check(lamina::renderPreview(bits, look)), frame * kFrameWidth);
        std::printf("frame %u: %llu voxels\n", frame,
                    static_cast<unsigned long long>(bits.count()));
    }
    check(lamina::writePng(file, strip));
}

} // namespace

int main(int argc, char** argv) {
    if (argc != 2) {
        std::fprintf(stderr, "usage: skinned_source OUT.png\n");
        return 2;
    }
    run(argv[1]);
    return 0;
}
