// Shadow volumes culled and clamped ([Eisemann & Decoret 2006], Figure 7): a court with dozens of
// casters under a low sun. Writes four pictures in one: the court with its shadows, and how often
// each pixel's stencil is touched by plain, by culled and by culled and clamped shadow volumes.
//
//   shadow_volume_clamping OUT.png [WIDTH HEIGHT]      size of each of the four; 480 x 320

#include "support/check.hpp"
#include "support/host_gl.hpp"
#include "support/shapes.hpp"

#include <lamina/grid_io/image.hpp>
#include <lamina/headless/context.hpp>
#include <lamina/shadow_volumes/shadow_volumes.hpp>

#include <glm/gtc/constants.hpp>
#include <glm/gtc/matrix_transform.hpp>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstring>

namespace {

using example::check;
using example::HostGl;
using lamina::TriangleMesh;

const glm::dvec3 kToSun = glm::normalize(glm::dvec3(-1.0, 0.62, 0.18));

// The engine's own pass: what the sun gives each pixel if it is not in shadow, and what the sky
// does.
constexpr const char* kVertex = R"(#version 450 core
layout(location = 0) in vec3 position;
layout(location = 0) uniform mat4 worldToClip;
out vec3 world;
void main() {
    world = position;
    gl_Position = worldToClip * vec4(position, 1.0);
}
)";
constexpr const char* kFragment = R"(#version 450 core
layout(location = 1) uniform vec3 albedo;
layout(location = 2) uniform vec3 toSun;
in vec3 world;
layout(location = 0) out vec4 sun;
layout(location = 1) out vec4 sky;
void main() {
    vec3 normal = normalize(cross(dFdx(world), dFdy(world)));
    vec2 tile = abs(fract(world.xz) - 0.5);
    float joint = world.y < 1e-3 && max(tile.x, tile.y) > 0.48 ? 0.8 : 1.0;
    vec3 color = albedo * joint;
    sun = vec4(color * vec3(1.00, 0.86, 0.64) * max(dot(normal, toSun), 0.0), 1.0);
    sky = vec4(color * vec3(0.30, 0.36, 0.48) * (0.7 + 0.3 * normal.y), 1.0);
}
)";

struct Thing {
    TriangleMesh mesh;
    glm::vec3 albedo;
    bool casts = true;
};

void addBox(TriangleMesh& mesh, const glm::vec3& low, const glm::vec3& high) {
    const auto first = static_cast<std::uint32_t>(mesh.positions.size());
    for (unsigned i = 0; i < 8; ++i)
        mesh.positions.emplace_back((i & 1u) ? high.x : low.x, (i & 2u) ? high.y : low.y,
                                    (i & 4u) ? high.z : low.z);
    for (const glm::uvec3& t : std::initializer_list<glm::uvec3>{{0, 2, 1},
                                                                 {1, 2, 3},
                                                                 {4, 5, 6},
                                                                 {5, 7, 6},
                                                                 {0, 4, 2},
                                                                 {2, 4, 6},
                                                                 {1, 3, 5},
                                                                 {3, 7, 5},
                                                                 {0, 1, 4},
                                                                 {1, 5, 4},
                                                                 {2, 6, 3},
                                                                 {3, 6, 7}})
        mesh.triangles.push_back(t + first);
}

Thing vase(const glm::vec3& at, float size, const glm::vec3& albedo) {
    Thing thing{{}, albedo};
    const std::vector<glm::vec2> profile{{0.0f, 0.0f},  {0.28f, 0.0f}, {0.22f, 0.08f},
                                         {0.42f, 0.5f}, {0.40f, 0.7f}, {0.16f, 0.95f},
                                         {0.24f, 1.1f}, {0.0f, 1.05f}};
    example::addRevolved(thing.mesh, profile, 24,
                         [&](const glm::vec3& p) { return at + size * p; });
    return thing;
}

Thing ball(const glm::vec3& at, float size, const glm::vec3& albedo) {
    Thing thing{{}, albedo};
    example::addRevolved(thing.mesh, example::ballProfile(1.0f, 12), 24,
                         [&](const glm::vec3& p) { return at + size * p; });
    return thing;
}

/// A court, walled towards the sun: what stands in the wall's shadow casts nothing new.
std::vector<Thing> makeScene() {
    std::vector<Thing> things;
    Thing court{{}, {0.72f, 0.66f, 0.56f}, false};
    addBox(court.mesh, {-9.0f, -0.5f, -7.0f}, {9.0f, 0.0f, 7.0f});
    things.push_back(court);
    Thing wall{{}, {0.62f, 0.52f, 0.44f}};
    addBox(wall.mesh, {-9.0f, 0.0f, -6.5f}, {-8.6f, 3.6f, 2.0f});
    things.push_back(wall);
    example::Random random(11);
    constexpr std::array<glm::vec3, 3> kClay{glm::vec3(0.70f, 0.36f, 0.22f),
                                             glm::vec3(0.46f, 0.50f, 0.52f),
                                             glm::vec3(0.68f, 0.60f, 0.30f)};
    for (int row = 0; row < 8; ++row)
        for (int column = 0; column < 9; ++column) {
            const float x = -7.6f + 1.9f * static_cast<float>(column) + random(-0.3f, 0.3f);
            const float z = -6.0f + 1.6f * static_cast<float>(row) + random(-0.3f, 0.3f);
            const glm::vec3& clay = kClay[static_cast<std::size_t>(row + column) % kClay.size()];
            const float size = random(0.5f, 0.9f);
            if ((row + column) % 2 == 0)
                things.push_back(vase({x, 0.0f, z}, size, clay));
            else
                things.push_back(ball({x, 0.4f * size, z}, 0.4f * size, clay));
        }
    return things;
}

/// The engine's buffers of a thing.
struct EngineMesh {
    lamina::MeshView view;
    GLuint vertexArray = 0;
    glm::vec3 albedo;
};

EngineMesh upload(const HostGl& gl, const Thing& thing) {
    EngineMesh made;
    made.albedo = thing.albedo;
    made.view.vertexBuffer =
        example::makeBuffer(gl, std::as_bytes(std::span(thing.mesh.positions)));
    made.view.vertexCount = static_cast<std::uint32_t>(thing.mesh.positions.size());
    made.view.indexBuffer = example::makeBuffer(gl, std::as_bytes(std::span(thing.mesh.triangles)));
    made.view.indexType = lamina::IndexType::UInt32;
    made.view.indexCount = static_cast<std::uint32_t>(3 * thing.mesh.triangles.size());
    gl.CreateVertexArrays(1, &made.vertexArray);
    gl.VertexArrayVertexBuffer(made.vertexArray, 0, made.view.vertexBuffer, 0, sizeof(glm::vec3));
    gl.VertexArrayElementBuffer(made.vertexArray, made.view.indexBuffer);
    gl.EnableVertexArrayAttrib(made.vertexArray, 0);
    gl.VertexArrayAttribFormat(made.vertexArray, 0, 3, GL_FLOAT, GL_FALSE, 0);
    gl.VertexArrayAttribBinding(made.vertexArray, 0, 0);
    return made;
}

/// The engine's frame before shadows.
struct Frame {
    GLuint sun = 0, sky = 0, depth = 0;
};

GLuint makeTexture(const HostGl& gl, GLenum format, const glm::uvec2& size) {
    GLuint texture = 0;
    gl.CreateTextures(GL_TEXTURE_2D, 1, &texture);
    gl.TextureStorage2D(texture, 1, format, static_cast<GLsizei>(size.x),
                        static_cast<GLsizei>(size.y));
    return texture;
}

Frame draw(const HostGl& gl, const std::vector<EngineMesh>& meshes, const lamina::View& view) {
    const Frame frame{makeTexture(gl, GL_RGBA16F, view.size),
                      makeTexture(gl, GL_RGBA16F, view.size),
                      makeTexture(gl, GL_DEPTH_COMPONENT32F, view.size)};
    GLuint framebuffer = 0;
    gl.CreateFramebuffers(1, &framebuffer);
    gl.NamedFramebufferTexture(framebuffer, GL_COLOR_ATTACHMENT0, frame.sun, 0);
    gl.NamedFramebufferTexture(framebuffer, GL_COLOR_ATTACHMENT1, frame.sky, 0);
    gl.NamedFramebufferTexture(framebuffer, GL_DEPTH_ATTACHMENT, frame.depth, 0);
    constexpr std::array<GLenum, 2> kOutputs{GL_COLOR_ATTACHMENT0, GL_COLOR_ATTACHMENT1};
    gl.NamedFramebufferDrawBuffers(framebuffer, 2, kOutputs.data());
    constexpr std::array<float, 4> kNoSun{0.0f, 0.0f, 0.0f, 1.0f}, kSky{0.42f, 0.52f, 0.66f, 1.0f};
    constexpr float kFar = 1.0f;
    gl.ClearNamedFramebufferfv(framebuffer, GL_COLOR, 0, kNoSun.data());
    gl.ClearNamedFramebufferfv(framebuffer, GL_COLOR, 1, kSky.data());
    gl.ClearNamedFramebufferfv(framebuffer, GL_DEPTH, 0, &kFar);
    gl.BindFramebuffer(GL_FRAMEBUFFER, framebuffer);
    gl.Viewport(0, 0, static_cast<GLsizei>(view.size.x), static_cast<GLsizei>(view.size.y));
    gl.Enable(GL_DEPTH_TEST);
    const GLuint program =
        example::makeProgram(gl, {{GL_VERTEX_SHADER, kVertex}, {GL_FRAGMENT_SHADER, kFragment}});
    gl.UseProgram(program);
    const glm::mat4 worldToClip(view.worldToClip);
    const glm::vec3 toSun(kToSun);
    gl.ProgramUniformMatrix4fv(program, 0, 1, GL_FALSE, &worldToClip[0][0]);
    gl.ProgramUniform3fv(program, 2, 1, &toSun.x);
    for (const EngineMesh& mesh : meshes) {
        gl.ProgramUniform3fv(program, 1, 1, &mesh.albedo.x);
        gl.BindVertexArray(mesh.vertexArray);
        gl.DrawElements(GL_TRIANGLES, static_cast<GLsizei>(mesh.view.indexCount), GL_UNSIGNED_INT,
                        nullptr);
    }
    return frame;
}

template<class Texel>
std::vector<Texel> read(const HostGl& gl, GLuint texture, GLenum format, const glm::uvec2& size) {
    std::vector<Texel> texels(std::size_t{size.x} * size.y);
    gl.GetTextureImage(texture, 0, format, GL_FLOAT,
                       static_cast<GLsizei>(texels.size() * sizeof(Texel)), texels.data());
    return texels;
}

/// From black over blue and red to white.
glm::vec3 heat(float share) {
    const float x = std::clamp(share, 0.0f, 1.0f);
    return {std::clamp(3.0f * x - 0.6f, 0.0f, 1.0f), std::clamp(3.0f * x - 1.6f, 0.0f, 1.0f),
            std::clamp(x < 0.35f ? 2.4f * x : 1.2f - 1.2f * x, 0.0f, 1.0f) +
                std::clamp(4.0f * x - 3.0f, 0.0f, 1.0f)};
}

/// Puts a picture (rows from the bottom) into one of the four fields.
void paste(lamina::Image& image, const std::vector<glm::vec3>& colors, const glm::uvec2& size,
           const glm::uvec2& field) {
    for (std::uint32_t y = 0; y < size.y; ++y)
        for (std::uint32_t x = 0; x < size.x; ++x) {
            const glm::vec3& color = colors[std::size_t{size.y - 1 - y} * size.x + x];
            const std::size_t at =
                4 * ((std::size_t{field.y} * size.y + y) * image.width + field.x * size.x + x);
            for (glm::length_t c = 0; c < 3; ++c)
                image.rgba[at + static_cast<std::size_t>(c)] =
                    static_cast<std::uint8_t>(255.0f * std::clamp(color[c], 0.0f, 1.0f) + 0.5f);
            image.rgba[at + 3] = 255;
        }
}

void run(const char* file, const glm::uvec2& size) {
    lamina::headless::Context context = check(lamina::headless::Context::create());
    const auto load = [&](const char* name) { return context.getProcAddress(name); };
    const HostGl gl(load);
    lamina::Device device = check(lamina::Device::fromCurrentContext(load));

    std::vector<EngineMesh> meshes;
    std::vector<lamina::ShadowTopology> topologies;
    std::vector<lamina::ShadowCaster> casters;
    std::vector<lamina::GeometrySource> receivers;
    const std::vector<Thing> things = makeScene();
    topologies.reserve(things.size()); // casters point to them
    for (const Thing& thing : things) {
        meshes.push_back(upload(gl, thing));
        receivers.emplace_back(meshes.back().view);
        if (!thing.casts)
            continue;
        topologies.push_back(check(lamina::ShadowTopology::create(device, receivers.back())));
        casters.push_back({&topologies.back(), receivers.back()});
    }

    lamina::ShadowScene scene;
    scene.view.size = size;
    scene.view.worldToClip =
        glm::perspective(0.62, static_cast<double>(size.x) / size.y, 0.5, 80.0) *
        glm::lookAt(glm::dvec3(4.0, 6.5, 19.0), glm::dvec3(0.3, 0.3, -0.6), glm::dvec3(0, 1, 0));
    const Frame frame = draw(gl, meshes, scene.view);
    scene.depthTexture = frame.depth;
    scene.light = glm::dvec4(kToSun, 0.0);
    scene.casters = casters;
    scene.receivers = receivers;

    lamina::Image image{2 * size.x, 2 * size.y, {}};
    image.rgba.resize(std::size_t{4} * image.width * image.height);
    struct Step {
        const char* name;
        lamina::ShadowVolumesDesc desc;
    };
    const std::array<Step, 3> steps{
        Step{"plain", {.cullCasters = false, .clampLayers = false}},
        Step{"culled", {.layers = 48, .lightMapTexels = 1024, .clampLayers = false}},
        Step{"culled and clamped", {.layers = 48, .lightMapTexels = 1024}}};
    std::vector<float> light;
    float hottest = 1.0f;
    for (std::uint32_t i = 0; i < steps.size(); ++i) {
        auto volumes = check(lamina::ShadowVolumes::create(device, steps[i].desc));
        check(volumes.prepare(scene));
        const auto counts = read<float>(gl, check(volumes.overdraw()), GL_RED, size);
        if (i == 0)
            hottest = *std::ranges::max_element(counts);
        std::vector<glm::vec3> colors;
        for (const float count : counts)
            colors.push_back(heat(count / hottest));
        paste(image, colors, size, {(i + 1) % 2, (i + 1) / 2});

        const auto found = read<float>(gl, check(volumes.apply()), GL_RED, size);
        if (i > 0 && found != light)
            std::printf("%s: the shadow differs\n", steps[i].name);
        light = found;
        const lamina::ShadowVolumesReport report = check(volumes.downloadReport());
        std::printf("%-18s  casters culled %2u of %u (%u not lit)  receivers not seen %u of %u  "
                    "layers kept "
                    "%llu of %u  stencil fragments %llu, %.1f times fewer\n",
                    steps[i].name, report.castersCulled, report.casters, report.castersShadowed,
                    report.receiversCulled, report.receivers,
                    static_cast<unsigned long long>(report.layersKept),
                    report.layers * report.casters,
                    static_cast<unsigned long long>(report.stencilFragments),
                    static_cast<double>(report.stencilFragmentsWhole) /
                        static_cast<double>(std::max<std::uint64_t>(report.stencilFragments, 1)));
    }
    const auto sun = read<glm::vec4>(gl, frame.sun, GL_RGBA, size);
    const auto sky = read<glm::vec4>(gl, frame.sky, GL_RGBA, size);
    std::vector<glm::vec3> colors;
    for (std::size_t i = 0; i < light.size(); ++i)
        colors.push_back(
            glm::pow(glm::vec3(sky[i]) + light[i] * glm::vec3(sun[i]), glm::vec3(1.0f / 2.2f)));
    paste(image, colors, size, {0, 0});
    check(lamina::writePng(file, image));
}

bool parse(const char* text, std::uint32_t& value) {
    const char* end = text + std::strlen(text);
    const auto [last, error] = std::from_chars(text, end, value);
    return error == std::errc() && last == end && value >= 16 && value <= 4096;
}

} // namespace

int main(int argc, char** argv) {
    glm::uvec2 size(480, 320);
    if ((argc != 2 && argc != 4) ||
        (argc == 4 && !(parse(argv[2], size.x) && parse(argv[3], size.y)))) {
        std::fprintf(stderr, "usage: shadow_volume_clamping OUT.png [WIDTH HEIGHT]\n");
        return 2;
    }
    run(argv[1], size);
    return 0;
}
