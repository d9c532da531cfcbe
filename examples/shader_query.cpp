// The light that leaves let through: the engine's own fragment shader includes <lamina/grid.glsl>
// and counts, for each pixel, the leaves between it and the sun ([ED06], section 3.1 of the
// slicemap paper). Leaves and wood are voxelized from the sun into two grids.
//
//   shader_query OUT.png

#include "support/check.hpp"
#include "support/engine_mesh.hpp"
#include "support/host_gl.hpp"
#include "support/target.hpp"
#include "support/tree.hpp"

#include <lamina/gl/shaders.hpp>
#include <lamina/grid/voxel_grid.hpp>
#include <lamina/headless/context.hpp>
#include <lamina/voxelize/voxelizer.hpp>

#include <glm/gtc/matrix_transform.hpp>
#include <glm/gtc/type_ptr.hpp>

#include <array>

namespace {

using example::check;
using example::EngineMesh;
using example::HostGl;

constexpr int kWidth = 1280, kHeight = 800;
const glm::vec3 kToSun = glm::normalize(glm::vec3(-0.45f, 1.0f, -0.62f));
const glm::vec3 kEye(-1.2f, 4.0f, 14.2f);

// Follows "#version 450" and lamina/grid.glsl with two grids.
constexpr const char* kFragmentShader = R"(
#line 1
layout(location = 4) uniform int surface; // 0 ground, 1 wood, 2 leaf, 3 sky
layout(location = 5) uniform vec3 eye;
layout(location = 6) uniform vec3 toSun;
in vec3 world;
out vec4 color;

const int kLeaves = 0;           // The grids' numbers, as given to VoxelGrid::bind().
const int kWood = 1;
const float kLeafShare = 0.42;   // Of the light that a leaf takes.
const vec3 kSun = vec3(2.5, 2.1, 1.55);
const vec3 kSky = vec3(0.30, 0.42, 0.62);

// The share of sunlight that reaches a point, averaged over a disc: the sun is not a point.
float sunlight(vec3 point) {
    const int kTaps = 32;
    vec3 side = normalize(cross(toSun, vec3(0.0, 0.0, 1.0)));
    vec3 other = cross(toSun, side);
    float sum = 0.0;
    for (int i = 0; i < kTaps; ++i) {
        float radius = 0.055 * sqrt((float(i) + 0.5) / float(kTaps));
        float angle = 2.39996 * float(i);
        vec3 tap = point + radius * (cos(angle) * side + sin(angle) * other);
        int leaves = laminaPointCountNearer(kLeaves, tap);
        int wood = laminaPointCountNearer(kWood, tap + 0.05 * toSun);
        sum += wood > 0 ? 0.0 : pow(1.0 - kLeafShare, float(leaves));
    }
    return sum / float(kTaps);
}

float hash(vec2 p) {
    return fract(sin(dot(p, vec2(12.9898, 78.233))) * 43758.5453);
}

// Flagstones: a colour for each, and the joints between them.
vec3 groundColor(vec2 p) {
    p = mat2(0.8, -0.6, 0.6, 0.8) * p / 0.85;
    float blur = max(max(fwidth(p.y), fwidth(p.x)), 1e-4);
    p.x += 0.5 * float(int(floor(p.y)) & 1);
    vec2 cell = floor(p);
    vec2 edge = 0.5 - abs(fract(p) - 0.5);
    float joint = smoothstep(0.015, 0.03 + blur, min(edge.x, edge.y));
    vec3 stone = mix(vec3(0.36, 0.32, 0.27), vec3(0.50, 0.45, 0.38), hash(cell));
    return mix(vec3(0.15, 0.16, 0.10), stone, mix(0.9, joint, clamp(0.06 / blur, 0.0, 1.0)));
}

vec3 background(vec3 direction) {
    return mix(vec3(0.86, 0.88, 0.86), vec3(0.36, 0.58, 0.86), smoothstep(0.0, 0.4, direction.y));
}

void main() {
    vec3 view = normalize(world - eye);
    if (surface == 3) {
        color = vec4(background(view), 1.0);
        return;
    }
    vec3 normal = normalize(cross(dFdx(world), dFdy(world)));
    float facing = dot(normal, toSun);
    float light = sunlight(world);
    float open = 0.45 + 0.55 * light; // Where the sun comes through, the sky does too.
    vec3 albedo = vec3(0.30, 0.22, 0.16);
    vec3 direct = vec3(max(facing, 0.0));
    if (surface == 0) {
        albedo = groundColor(world.xz);
    } else if (surface == 2) {
        albedo = mix(vec3(0.16, 0.30, 0.06), vec3(0.36, 0.46, 0.10), hash(floor(world.xz * 9.0)));
        // Seen from its shaded side a leaf glows with the light that passes it.
        direct = facing > 0.0 ? vec3(facing) : -facing * vec3(0.95, 1.05, 0.35);
    }
    vec3 shade = mix(0.55, 1.0, 0.5 + 0.5 * normal.y) * kSky * open;
    vec3 result = albedo * (direct * light * kSun + shade);
    result = pow(1.0 - exp(-1.25 * result), vec3(1.0 / 2.2));
    float haze = surface == 0 ? smoothstep(8.0, 45.0, length(world.xz)) : 0.0;
    color = vec4(mix(result, background(view), haze), 1.0);
}
)";

constexpr float kFar = 60.0f;

lamina::TriangleMesh makeGround() {
    lamina::TriangleMesh ground;
    ground.positions = {{-kFar, 0, -kFar}, {kFar, 0, -kFar}, {kFar, 0, kFar}, {-kFar, 0, kFar}};
    ground.triangles = {{0, 2, 1}, {0, 3, 2}};
    return ground;
}

lamina::TriangleMesh makeSky() {
    lamina::TriangleMesh sky;
    sky.positions = {
        {-kFar, 0, -kFar}, {kFar, 0, -kFar}, {kFar, kFar, -kFar}, {-kFar, kFar, -kFar}};
    sky.triangles = {{0, 1, 2}, {0, 2, 3}};
    return sky;
}

/// A grid whose columns are sun rays, around all that casts shadows.
lamina::GridTransform sunGrid(const lamina::Box3& casters, const glm::uvec3& size) {
    const glm::dvec3 center = casters.center();
    const glm::dmat4 worldToEye =
        glm::lookAt(center + glm::dvec3(kToSun), center, glm::dvec3(0, 0, 1));
    lamina::Box3 inEye;
    for (unsigned corner = 0; corner < 8; ++corner)
        inEye.extend(worldToEye * glm::dvec4((corner & 1u) != 0 ? casters.max.x : casters.min.x,
                                             (corner & 2u) != 0 ? casters.max.y : casters.min.y,
                                             (corner & 4u) != 0 ? casters.max.z : casters.min.z,
                                             1.0));
    lamina::GridCamera camera;
    camera.worldToEye = worldToEye;
    camera.left = inEye.min.x;
    camera.right = inEye.max.x;
    camera.bottom = inEye.min.y;
    camera.top = inEye.max.y;
    camera.near = -inEye.max.z;
    camera.far = -inEye.min.z;
    return check(lamina::GridTransform::camera(camera, size));
}

GLuint makeEngineProgram(const HostGl& gl) {
    const std::string fragment = "#version 450\n#define LAMINA_GRID_COUNT 2\n" +
                                 check(lamina::shaderSource("lamina/grid.glsl")) + kFragmentShader;
    const GLuint program = example::makeProgram(
        gl, {{GL_VERTEX_SHADER, example::kWorldVertexShader}, {GL_FRAGMENT_SHADER, fragment}});
    const glm::mat4 camera =
        glm::perspective(glm::radians(37.0f), static_cast<float>(kWidth) / kHeight, 0.5f, 120.0f) *
        glm::lookAt(kEye, glm::vec3(0.5f, 2.55f, 0.0f), glm::vec3(0, 1, 0));
    gl.ProgramUniformMatrix4fv(program, 0, 1, GL_FALSE, glm::value_ptr(camera));
    gl.ProgramUniform3fv(program, 5, 1, glm::value_ptr(kEye));
    gl.ProgramUniform3fv(program, 6, 1, glm::value_ptr(kToSun));
    return program;
}

void draw(const HostGl& gl, GLuint program, const example::Target& target,
          std::span<const EngineMesh> meshes) {
    example::beginFrame(gl, target);
    gl.UseProgram(program);
    for (std::size_t i = 0; i < meshes.size(); ++i) {
        gl.ProgramUniform1i(program, 4, static_cast<GLint>(i));
        example::draw(gl, meshes[i]);
    }
}

void run(const char* file) {
    lamina::headless::Context context = check(lamina::headless::Context::create());
    const auto load = [&](const char* name) { return context.getProcAddress(name); };
    const HostGl gl(load);
    lamina::Device device = check(lamina::Device::fromCurrentContext(load));

    const example::Tree tree = example::makeTree(5);
    const EngineMesh ground = upload(gl, makeGround());
    const EngineMesh wood = upload(gl, tree.wood);
    const EngineMesh leaves = upload(gl, tree.leaves);

    // A leaf is one voxel of a column wherever its plane runs: the number of leaves is what counts.
    auto leafVoxelizer =
        check(lamina::Voxelizer::create(device, {.coverage = lamina::Coverage::Sampled}));
    auto woodVoxelizer =
        check(lamina::Voxelizer::create(device, {.coverage = lamina::Coverage::Filled}));
    lamina::VoxelGrid leafGrid = check(lamina::VoxelGrid::create(device));
    lamina::VoxelGrid woodGrid = check(lamina::VoxelGrid::create(device));
    const lamina::GeometrySource leafSource[] = {leaves.view};
    const lamina::GeometrySource woodSource[] = {wood.view};
    check(leafVoxelizer->voxelize(leafSource, sunGrid(tree.leaves.bounds(), {512, 512, 128}),
                                  leafGrid));
    check(woodVoxelizer->voxelize(woodSource, sunGrid(tree.wood.bounds(), {512, 512, 128}),
                                  woodGrid));

    const GLuint program = makeEngineProgram(gl);
    const example::Target target = example::makeTarget(gl, kWidth, kHeight);
    leafGrid.bind(0, 0, 0);
    woodGrid.bind(0, 0, 1);
    draw(gl, program, target, std::array{ground, wood, leaves, upload(gl, makeSky())});
    check(lamina::writePng(file, example::readBack(gl, target)));
    std::printf("%s: %zu leaf and %zu wood triangles\n", file, tree.leaves.triangles.size(),
                tree.wood.triangles.size());
}

} // namespace

int main(int argc, char** argv) {
    if (argc != 2) {
        std::fprintf(stderr, "usage: shader_query OUT.png\n");
        return 2;
    }
    run(argv[1]);
    return 0;
}
