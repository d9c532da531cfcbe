// Shadow volumes culled and clamped ([Eisemann & Decoret 2006], Figure 7): a court with dozens of
// casters under a low sun. Writes four pictures in one: the court with its shadows, and how often
// each pixel's stencil is touched by plain, by culled and by culled and clamped shadow volumes.
//
//   shadow_volume_clamping OUT.png [--width PIXELS] [--height PIXELS] [--layers N] [--turn DEGREES]

#include "support/check.hpp"
#include "support/court.hpp"
#include "support/engine_mesh.hpp"
#include "support/host_gl.hpp"

#include <lamina/grid_io/image.hpp>
#include <lamina/headless/context.hpp>
#include <lamina/shadow_volumes/shadow_volumes.hpp>

#include <CLI/CLI.hpp>
#include <glm/gtc/constants.hpp>
#include <glm/gtc/matrix_transform.hpp>

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <string>

namespace {

using example::check;
using example::CourtThing;
using example::EngineMesh;
using example::HostGl;

struct Settings {
    std::string file;
    glm::uvec2 size{480, 320}; ///< Of each of the four pictures.
    std::uint32_t layers = 48;
    double turn = 0.0; ///< Of the sun about the court, degrees.
};

// The engine's own pass: what the sun gives each pixel if it is not in shadow, and what the sky
// does.
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

Frame draw(const HostGl& gl, const std::vector<CourtThing>& things,
           const std::vector<EngineMesh>& meshes, const lamina::View& view,
           const glm::dvec3& sunDirection) {
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
    const GLuint program = example::makeProgram(
        gl, {{GL_VERTEX_SHADER, example::kWorldVertexShader}, {GL_FRAGMENT_SHADER, kFragment}});
    gl.UseProgram(program);
    const glm::mat4 worldToClip(view.worldToClip);
    const glm::vec3 toSun(sunDirection);
    gl.ProgramUniformMatrix4fv(program, 0, 1, GL_FALSE, &worldToClip[0][0]);
    gl.ProgramUniform3fv(program, 2, 1, &toSun.x);
    for (std::size_t i = 0; i < meshes.size(); ++i) {
        gl.ProgramUniform3fv(program, 1, 1, &things[i].albedo.x);
        example::draw(gl, meshes[i]);
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

void run(const Settings& settings) {
    const glm::uvec2 size = settings.size;
    lamina::headless::Context context = check(lamina::headless::Context::create());
    const auto load = [&](const char* name) { return context.getProcAddress(name); };
    const HostGl gl(load);
    lamina::Device device = check(lamina::Device::fromCurrentContext(load));

    std::vector<EngineMesh> meshes;
    std::vector<lamina::ShadowTopology> topologies;
    std::vector<lamina::ShadowCaster> casters;
    std::vector<lamina::GeometrySource> receivers;
    const std::vector<CourtThing> things = example::makeCourt();
    topologies.reserve(things.size()); // casters point to them
    for (const CourtThing& thing : things) {
        meshes.push_back(example::upload(gl, thing.mesh));
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
    const glm::dmat4 turn =
        glm::rotate(glm::dmat4(1.0), glm::radians(settings.turn), glm::dvec3(0, 1, 0));
    const glm::dvec3 toSun(turn * glm::dvec4(glm::normalize(example::kCourtSun), 0.0));
    const Frame frame = draw(gl, things, meshes, scene.view, toSun);
    scene.depthTexture = frame.depth;
    scene.light = glm::dvec4(toSun, 0.0);
    scene.casters = casters;
    scene.receivers = receivers;

    lamina::Image image{2 * size.x, 2 * size.y, {}};
    image.rgba.resize(std::size_t{4} * image.width * image.height);
    struct Step {
        const char* name;
        lamina::ShadowVolumesDesc desc;
    };
    const std::array<Step, 3> steps{
        Step{"plain",
             {.layers = settings.layers,
              .lightMapTexels = 1024,
              .cullCasters = false,
              .clampLayers = false}},
        Step{"culled", {.layers = settings.layers, .lightMapTexels = 1024, .clampLayers = false}},
        Step{"culled and clamped", {.layers = settings.layers, .lightMapTexels = 1024}}};
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
        if (i > 0 && found != light) {
            std::fprintf(stderr, "%s: the shadow differs\n", steps[i].name);
            std::exit(1);
        }
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
    check(lamina::writePng(settings.file, image));
}

} // namespace

int main(int argc, char** argv) {
    Settings settings;
    CLI::App app(
        "Stencil shadows of a court, and how often they touch each pixel's stencil when plain, "
        "culled, and culled and clamped.");
    app.add_option("file", settings.file, "The four pictures, a PNG")->required();
    app.add_option("--width", settings.size.x, "Pixels of each")
        ->capture_default_str()
        ->check(CLI::Range(16, 4096));
    app.add_option("--height", settings.size.y, "Pixels of each")
        ->capture_default_str()
        ->check(CLI::Range(16, 4096));
    app.add_option("--layers", settings.layers, "Strips of the view that volumes are clamped to")
        ->capture_default_str()
        ->check(CLI::Range(1, 128));
    app.add_option("--turn", settings.turn, "Of the sun about the court, degrees");
    CLI11_PARSE(app, argc, argv);
    run(settings);
    return 0;
}
