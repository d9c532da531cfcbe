// Two complex shapes clip a tower in one pass, pixel by pixel ([TD08], figure 1). The engine's own
// fragment shader includes <lamina/parity.glsl>, asks which clip shapes hold the fragment, and
// discards it by a rule; the cut faces are the clip shapes' own surfaces, where they lie inside the
// tower's walls: the tower is a third sprite.
//
//   parity_clip OUT.png [--rule union|intersection|difference] [--keep] [--columns N] ...

#include "support/check.hpp"
#include "support/clip_shapes.hpp"
#include "support/engine_mesh.hpp"
#include "support/host_gl.hpp"
#include "support/picture_options.hpp"
#include "support/target.hpp"
#include "support/tower.hpp"

#include <lamina/gl/shaders.hpp>
#include <lamina/headless/context.hpp>
#include <lamina/parity/sprite_builder.hpp>
#include <lamina/parity/sprite_set.hpp>

#include <CLI/CLI.hpp>
#include <glm/geometric.hpp>
#include <glm/gtc/matrix_transform.hpp>
#include <glm/gtc/type_ptr.hpp>

#include <array>
#include <map>

namespace {

using example::check;
using example::EngineMesh;
using example::HostGl;

struct Settings {
    std::string file;
    int rule = 0; ///< LAMINA_PARITY_UNION, .. of the clip shapes.
    bool keeps = false;
    bool isCapped = true;
    bool clips = true;
    std::uint32_t columns = 1024;
    int width = 1280, height = 960;
};

// Follows lamina/parity.glsl with three sprites: two clip shapes and the tower.
constexpr const char* kFragmentShader = R"(
#line 1
layout(location = 4) uniform int surface; // clip shapes 0 and 1, tower 2, sky 3
layout(location = 5) uniform vec3 eye;
layout(location = 6) uniform int rule;
layout(location = 7) uniform int keeps;   // 1: what lies inside the clip shapes stays
layout(location = 8) uniform int clips;
in vec3 world;
out vec4 color;

const int kShapes = 2;
const int kTower = 2;

// Is a point clipped away, if the clip shapes of `mask` hold it?
bool isClipped(uint mask) {
    return clips == 1 && laminaParityCombineShapes(mask, kShapes, rule) != (keeps == 1);
}

vec3 lit(vec3 albedo, vec3 normal, float gloss) {
    vec3 view = normalize(eye - world);
    normal = dot(normal, view) < 0.0 ? -normal : normal;
    vec3 light = normalize(vec3(0.45, 0.8, 0.75));
    vec3 fill = normalize(vec3(-0.9, 0.15, 0.5));
    float high = pow(max(dot(normal, normalize(light + view)), 0.0), 48.0);
    vec3 sum = albedo * (0.12 + 0.08 * normal.y + 0.72 * max(dot(normal, light), 0.0) +
                         0.14 * max(dot(normal, fill), 0.0)) + gloss * high;
    return pow(sum, vec3(1.0 / 2.2));
}

vec3 background(vec3 direction) {
    return mix(vec3(0.80, 0.82, 0.82), vec3(0.40, 0.52, 0.66), smoothstep(-0.3, 0.5, direction.y));
}

void main() {
    if (surface == 3) {
        color = vec4(background(normalize(world - eye)), 1.0);
        return;
    }
    uint mask = laminaParityMask(world);
    vec3 normal = normalize(cross(dFdx(world), dFdy(world)));
    if (surface == kTower) {
        if (isClipped(mask))
            discard;
        vec3 stone = world.y < 0.0 ? vec3(0.35, 0.36, 0.33) : vec3(0.72, 0.64, 0.50);
        stone = world.y > 6.19 ? vec3(0.36, 0.47, 0.48) : stone;
        color = vec4(lit(stone, normal, 0.06), 1.0);
        return;
    }
    // A cut face: the clip shape's surface, where it bounds what is clipped and lies in a wall.
    if (!laminaParityIsBoundary(mask, kShapes, surface, rule) || !laminaParityInsideRefined(kTower, 1, world))
        discard;
    float hatch = smoothstep(0.35, 0.65, abs(fract(4.0 * (world.x + world.y + world.z)) - 0.5) * 2.0);
    vec3 paint = mix(vec3(0.62, 0.10, 0.06), vec3(0.80, 0.26, 0.14), hatch);
    color = vec4(lit(paint, normal, 0.0), 1.0);
}
)";

constexpr float kFar = 60.0f;

lamina::TriangleMesh makeSky(const glm::vec3& eye) {
    const glm::vec3 away = glm::normalize(glm::vec3(-eye.x, 0.0f, -eye.z));
    const glm::vec3 side = kFar * glm::vec3(-away.z, 0.0f, away.x);
    lamina::TriangleMesh sky;
    for (const float x : {-1.0f, 1.0f})
        for (const float y : {-kFar, kFar})
            sky.positions.push_back(kFar * away + x * side + glm::vec3(0.0f, y, 0.0f));
    sky.triangles = {{0, 1, 2}, {1, 2, 3}};
    return sky;
}

GLuint makeEngineProgram(const HostGl& gl, const Settings& settings, const glm::vec3& eye) {
    const std::string fragment = "#version 450\n#define LAMINA_PARITY_COUNT 3\n" +
                                 check(lamina::shaderSource("lamina/parity.glsl")) +
                                 kFragmentShader;
    const GLuint program = example::makeProgram(
        gl, {{GL_VERTEX_SHADER, example::kWorldVertexShader}, {GL_FRAGMENT_SHADER, fragment}});
    const float aspect = static_cast<float>(settings.width) / static_cast<float>(settings.height);
    const glm::mat4 camera = glm::perspective(glm::radians(38.0f), aspect, 0.5f, 150.0f) *
                             glm::lookAt(eye, glm::vec3(0.0f, 3.7f, 0.0f), glm::vec3(0, 1, 0));
    gl.ProgramUniformMatrix4fv(program, 0, 1, GL_FALSE, glm::value_ptr(camera));
    gl.ProgramUniform3fv(program, 5, 1, glm::value_ptr(eye));
    gl.ProgramUniform1i(program, 6, settings.rule);
    gl.ProgramUniform1i(program, 7, settings.keeps ? 1 : 0);
    gl.ProgramUniform1i(program, 8, settings.clips ? 1 : 0);
    return program;
}

void run(const Settings& settings) {
    lamina::headless::Context context = check(lamina::headless::Context::create());
    const auto load = [&](const char* name) { return context.getProcAddress(name); };
    const HostGl gl(load);
    lamina::Device device = check(lamina::Device::fromCurrentContext(load));

    const lamina::TriangleMesh meshes[] = {example::makeKnot({0.9f, 4.3f, 2.2f}, 1.55f, 0.47f),
                                           example::makeWavyBall({-1.9f, 5.4f, 1.9f}, 2.1f),
                                           example::makeTower()};
    auto builder = check(lamina::SpriteBuilder::create(device));
    std::vector<lamina::DepthSprite> sprites;
    std::vector<EngineMesh> drawn;
    std::printf("%s: sprites of", settings.file.c_str());
    for (const lamina::TriangleMesh& mesh : meshes) {
        drawn.push_back(upload(gl, mesh));
        const lamina::GeometrySource source = drawn.back().view;
        const auto best = check(builder.downloadBestDirection({&source, 1}, mesh.bounds()));
        const auto place =
            check(lamina::fitSprite(mesh.bounds(), best.direction, settings.columns));
        sprites.push_back(check(lamina::DepthSprite::create(device)));
        const auto report = check(builder.buildAndWait({&source, 1}, place, sprites.back()));
        std::printf(" %u layers (%zu triangles, %llu odd columns)", report.layers,
                    mesh.triangles.size(), static_cast<unsigned long long>(report.oddColumns));
    }
    std::printf("\n");
    auto set = check(lamina::SpriteSet::create(device));
    check(set.update(std::array{lamina::SpriteInstance{.sprite = &sprites[0]},
                                lamina::SpriteInstance{.sprite = &sprites[1]},
                                lamina::SpriteInstance{.sprite = &sprites[2]}}));

    const glm::vec3 eye(3.0f, 8.6f, 15.6f);
    drawn.push_back(upload(gl, makeSky(eye)));
    const GLuint program = makeEngineProgram(gl, settings, eye);
    const example::Target target = example::makeTarget(gl, settings.width, settings.height);
    example::beginFrame(gl, target);
    set.bind();
    gl.UseProgram(program);
    for (std::size_t i = 0; i < drawn.size(); ++i) {
        if (i < 2 && !(settings.isCapped && settings.clips))
            continue;
        gl.ProgramUniform1i(program, 4, static_cast<GLint>(i));
        draw(gl, drawn[i]);
    }
    check(lamina::writePng(settings.file, example::readBack(gl, target)));
}

} // namespace

int main(int argc, char** argv) {
    Settings settings;
    CLI::App app("Clips a tower by two shapes.");
    app.add_option("file", settings.file, "The picture, a PNG")->required();
    app.add_option("--rule", settings.rule, "Of the shapes: union, intersection, difference")
        ->default_str("union")
        ->transform(CLI::CheckedTransformer(
            std::map<std::string, int>{{"union", 0}, {"intersection", 1}, {"difference", 2}}));
    app.add_flag("--keep", settings.keeps, "Keep what is inside, not what is outside");
    app.add_flag("!--open", settings.isCapped, "Leave the cut faces open");
    app.add_flag("!--whole", settings.clips, "Do not clip");
    example::addPictureOptions(app, settings);
    CLI11_PARSE(app, argc, argv);
    run(settings);
    return 0;
}
