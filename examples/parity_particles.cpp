// Particles rain on a shape that twists and turns: the shape's vertex stage makes a new depth
// sprite every frame in one geometry pass, and the engine's own compute shader asks it, for each
// particle, whether it is inside, which way is out, and how far.
//
//   parity_particles OUT.png [--particles N] [--frames N] [--columns N] ...

#include "support/check.hpp"
#include "support/clip_shapes.hpp"
#include "support/engine_mesh.hpp"
#include "support/host_gl.hpp"
#include "support/picture_options.hpp"
#include "support/shapes.hpp"
#include "support/target.hpp"

#include <lamina/gl/shaders.hpp>
#include <lamina/headless/context.hpp>
#include <lamina/parity/point_classifier.hpp>
#include <lamina/parity/sprite_builder.hpp>
#include <lamina/parity/sprite_set.hpp>

#include <CLI/CLI.hpp>
#include <glm/gtc/matrix_transform.hpp>
#include <glm/gtc/type_ptr.hpp>
#include <glm/vec4.hpp>

#include <algorithm>
#include <array>

namespace {

using example::check;
using example::EngineMesh;
using example::HostGl;

struct Settings {
    std::string file;
    std::uint32_t particles = 10000;
    int frames = 150;
    std::uint32_t columns = 256;
    std::uint32_t layers = 12;
    int width = 1280, height = 960;
};

constexpr float kStep = 1.0f / 60.0f;                          ///< Seconds a frame.
const lamina::Box3 kRoom{{-2.2, -2.2, -2.2}, {2.2, 2.2, 2.2}}; ///< The shape never leaves it.
const glm::vec3 kEye(0.6f, 2.6f, 7.6f);

/// Bytes of a particle: position, and what the shader keeps of it.
struct Particle {
    glm::vec4 position; ///< w: times it hit the shape.
    glm::vec4 velocity;
};

// The shape's motion, for the sprite and for the picture.
constexpr const char* kMotion = R"(
layout(location = 12) uniform float seconds;
vec3 moved(vec3 p) {
    float twist = 0.9 * sin(1.3 * seconds) * p.y;
    p.xz = mat2(cos(twist), sin(twist), -sin(twist), cos(twist)) * p.xz;
    float turn = 0.8 * seconds;
    p.xz = mat2(cos(turn), sin(turn), -sin(turn), cos(turn)) * p.xz;
    return p * (1.0 + 0.08 * sin(2.4 * seconds + 3.0 * p.y));
}
)";

// The engine's vertex stage as a source for Lamina.
constexpr const char* kSpriteVertexStage = R"(
layout(location = 0) in vec3 position;
LaminaVertex laminaVertex() {
    return LaminaVertex(moved(position), vec3(0.0), 0u);
}
)";

// Follows lamina/parity.glsl.
constexpr const char* kParticleShader = R"(
#line 1
layout(local_size_x = 64) in;
layout(location = 0) uniform float step;
layout(location = 1) uniform float seconds;
struct Particle { vec4 position; vec4 velocity; };
layout(std430, binding = 0) buffer Particles { Particle particles[]; };

float random(uint seed) {
    seed = seed * 747796405u + 2891336453u;
    seed = ((seed >> ((seed >> 28u) + 4u)) ^ seed) * 277803737u;
    return float((seed >> 22u) ^ seed) * 2.3283064e-10;
}

// Above the shape again, at rest.
void restart(uint i, inout Particle particle) {
    uint seed = i * 7u + uint(seconds * 60.0) * 70001u;
    float radius = 1.7 * sqrt(random(seed));
    float angle = 6.2831853 * random(seed + 1u);
    particle.position = vec4(radius * cos(angle), 2.3 + 0.8 * random(seed + 2u), radius * sin(angle), 0.0);
    particle.velocity = vec4(0.0);
}

void main() {
    uint i = gl_GlobalInvocationID.x;
    if (i >= uint(particles.length()))
        return;
    Particle particle = particles[i];
    particle.velocity.y -= 2.4 * step;
    particle.position.xyz += step * particle.velocity.xyz;
    // Out along the normal, as far as the column's crossing says; a few steps, as surfaces bend.
    for (int k = 0; k < 4 && laminaParityInside(0, particle.position.xyz); ++k) {
        vec3 world = particle.position.xyz;
        vec3 normal = laminaParityNormal(0, world);
        if (normal == vec3(0.0))
            break;
        vec3 axis = normalize(laminaParitySprite[0].worldToSprite[2].xyz);
        // The surface's distance from that along the axis, and no less than half a column.
        float depth = -laminaParityDistance(0, world) * max(abs(dot(normal, axis)), 0.1);
        particle.position.xyz += (depth + 0.012) * normal;
        float into = dot(particle.velocity.xyz, normal);
        if (into < 0.0)
            particle.velocity.xyz -= 1.35 * into * normal;
        particle.velocity.xyz *= 0.99;
        particle.position.w += k == 0 ? 1.0 : 0.0;
    }
    if (particle.position.y < -2.6)
        restart(i, particle);
    particles[i] = particle;
}
)";

constexpr const char* kShapeVertexShader = R"(
layout(location = 0) uniform mat4 worldToClip;
layout(location = 0) in vec3 position;
out vec3 world;
void main() {
    world = moved(position);
    gl_Position = worldToClip * vec4(world, 1.0);
}
)";

constexpr const char* kShapeFragmentShader = R"(#version 450
layout(location = 5) uniform vec3 eye;
in vec3 world;
out vec4 color;
void main() {
    vec3 view = normalize(eye - world);
    vec3 normal = normalize(cross(dFdx(world), dFdy(world)));
    normal = dot(normal, view) < 0.0 ? -normal : normal;
    vec3 light = normalize(vec3(0.4, 0.9, 0.6));
    float gloss = pow(max(dot(normal, normalize(light + view)), 0.0), 50.0);
    vec3 sum = vec3(0.16, 0.30, 0.42) * (0.25 + 0.15 * normal.y + 0.9 * max(dot(normal, light), 0.0)) + 0.35 * gloss;
    color = vec4(pow(sum, vec3(1.0 / 2.2)), 1.0);
}
)";

// A particle is a small quad that faces the eye: six vertices each, read from the particles'
// buffer.
constexpr const char* kQuadVertexShader = R"(#version 450
layout(location = 0) uniform mat4 worldToClip;
struct Particle { vec4 position; vec4 velocity; };
layout(std430, binding = 0) readonly buffer Particles { Particle particles[]; };
out vec2 place;
flat out float hits;
void main() {
    Particle particle = particles[gl_VertexID / 6];
    int corner = gl_VertexID % 6;
    place = vec2(corner == 1 || corner == 2 || corner == 4, corner == 2 || corner == 4 || corner == 5) * 2.0 - 1.0;
    vec4 center = worldToClip * vec4(particle.position.xyz, 1.0);
    gl_Position = center + vec4(0.03 * place * vec2(0.75, 1.0), 0.0, 0.0);
    hits = particle.position.w;
}
)";

constexpr const char* kQuadFragmentShader = R"(#version 450
in vec2 place;
flat in float hits;
out vec4 color;
void main() {
    float square = dot(place, place);
    if (square > 1.0)
        discard;
    vec3 tint = hits == 0.0 ? vec3(0.85, 0.90, 0.95) : mix(vec3(1.0, 0.80, 0.25), vec3(0.95, 0.30, 0.10), min(hits / 12.0, 1.0));
    color = vec4(tint * (0.6 + 0.4 * sqrt(1.0 - square)), 1.0);
}
)";

GLuint makeParticles(const HostGl& gl, std::uint32_t count) {
    example::Random random(3);
    std::vector<Particle> particles(count);
    for (Particle& particle : particles) {
        const glm::vec2 place(random(-1.3f, 1.3f), random(-1.3f, 1.3f));
        particle.position = {place.x, random(2.2f, 5.0f), place.y, 0.0f};
        particle.velocity = glm::vec4(0.0f);
    }
    return example::makeBuffer(gl, std::as_bytes(std::span(particles)));
}

glm::mat4 worldToClip(const Settings& settings) {
    const float aspect = static_cast<float>(settings.width) / static_cast<float>(settings.height);
    return glm::perspective(glm::radians(38.0f), aspect, 0.5f, 30.0f) *
           glm::lookAt(kEye, glm::vec3(0, 0.2f, 0), glm::vec3(0, 1, 0));
}

void drawPicture(const HostGl& gl, const Settings& settings, const EngineMesh& shape,
                 GLuint particles, float seconds) {
    const GLuint shapeProgram = example::makeProgram(
        gl, {{GL_VERTEX_SHADER, std::string("#version 450\n") + kMotion + kShapeVertexShader},
             {GL_FRAGMENT_SHADER, kShapeFragmentShader}});
    const GLuint quadProgram = example::makeProgram(
        gl, {{GL_VERTEX_SHADER, kQuadVertexShader}, {GL_FRAGMENT_SHADER, kQuadFragmentShader}});
    const glm::mat4 camera = worldToClip(settings);
    for (const GLuint program : {shapeProgram, quadProgram})
        gl.ProgramUniformMatrix4fv(program, 0, 1, GL_FALSE, glm::value_ptr(camera));
    gl.ProgramUniform3fv(shapeProgram, 5, 1, glm::value_ptr(kEye));
    gl.ProgramUniform1f(shapeProgram, 12, seconds);

    const example::Target target = example::makeTarget(gl, settings.width, settings.height);
    example::beginFrame(gl, target);
    constexpr float kDusk[] = {0.10f, 0.12f, 0.16f, 1.0f};
    gl.ClearNamedFramebufferfv(target.samples, GL_COLOR, 0, kDusk);
    gl.UseProgram(shapeProgram);
    example::draw(gl, shape);
    gl.UseProgram(quadProgram);
    gl.BindBufferBase(GL_SHADER_STORAGE_BUFFER, 0, particles);
    gl.DrawArrays(GL_TRIANGLES, 0, static_cast<GLsizei>(6 * settings.particles));
    check(lamina::writePng(settings.file, example::readBack(gl, target)));
}

void run(const Settings& settings) {
    lamina::headless::Context context = check(lamina::headless::Context::create());
    const auto load = [&](const char* name) { return context.getProcAddress(name); };
    const HostGl gl(load);
    lamina::Device device = check(lamina::Device::fromCurrentContext(load));

    const EngineMesh shape = upload(gl, example::makeKnot({}, 1.15f, 0.36f));
    const GLuint particles = makeParticles(gl, settings.particles);
    float seconds = 0.0f;
    lamina::DrawSource source;
    source.vertexShader = std::string(kMotion) + kSpriteVertexStage;
    source.draw = [&](const lamina::DrawContext& draw) {
        gl.ProgramUniform1f(draw.program, 12, seconds);
        example::draw(gl, shape);
    };
    const lamina::GeometrySource sources[] = {source};
    // README begin
    auto builder = check(lamina::SpriteBuilder::create(device));
    auto sprite = check(lamina::DepthSprite::create(device));
    auto set = check(lamina::SpriteSet::create(device));
    const auto place = check(lamina::fitSprite(kRoom, {0, -1, 0}, settings.columns));
    // Every frame that the shape changes; a rigid one is built once, and its localToWorld moves it.
    const auto prepareFrame = [&] {
        check(builder.build(sources, place, settings.layers, sprite)); // one geometry pass
        check(set.update(std::array{lamina::SpriteInstance{.sprite = &sprite}}));
        set.bind(); // for engine shaders that include <lamina/parity.glsl>
    };
    // README end
    const GLuint program = example::makeProgram(
        gl,
        {{GL_COMPUTE_SHADER,
          "#version 450\n" + check(lamina::shaderSource("lamina/parity.glsl")) + kParticleShader}});

    // Every frame; nothing waits for the GPU.
    for (int frame = 0; frame < settings.frames; ++frame) {
        seconds = kStep * static_cast<float>(frame);
        prepareFrame();
        gl.ProgramUniform1f(program, 0, kStep);
        gl.ProgramUniform1f(program, 1, seconds);
        gl.UseProgram(program);
        gl.BindBufferBase(GL_SHADER_STORAGE_BUFFER, 0, particles);
        gl.DispatchCompute((settings.particles + 63) / 64, 1, 1);
        gl.MemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT | GL_BUFFER_UPDATE_BARRIER_BIT);
    }

    // How many are inside after all, and how many were ever pushed out.
    std::vector<Particle> host(settings.particles);
    gl.GetNamedBufferSubData(particles, 0, static_cast<GLsizeiptr>(host.size() * sizeof(Particle)),
                             host.data());
    std::vector<glm::vec3> points;
    for (const Particle& particle : host)
        points.emplace_back(particle.position);
    const auto answers =
        check(check(lamina::PointClassifier::create(device)).download(set, points));
    const auto report = check(sprite.downloadReport());
    std::printf(
        "%s: %d frames; %lld of %u particles inside, %lld have hit; %u layers, %llu columns "
        "had too many\n",
        settings.file.c_str(), settings.frames,
        static_cast<long long>(std::ranges::count(answers, 1)), settings.particles,
        static_cast<long long>(
            std::ranges::count_if(host, [](const Particle& p) { return p.position.w > 0.0f; })),
        report.layers, static_cast<unsigned long long>(report.overflowColumns));
    drawPicture(gl, settings, shape, particles, seconds);
}

} // namespace

int main(int argc, char** argv) {
    Settings settings;
    CLI::App app("Lets particles collide with a shape that moves.");
    app.add_option("file", settings.file, "The picture of the last frame, a PNG")->required();
    app.add_option("--particles", settings.particles, "Number")
        ->check(CLI::Range(1, 1000000))
        ->capture_default_str();
    app.add_option("--frames", settings.frames, "Of a sixtieth of a second")
        ->check(CLI::Range(1, 100000))
        ->capture_default_str();
    app.add_option("--layers", settings.layers, "Layers of the sprite")
        ->check(CLI::Range(2, 64))
        ->capture_default_str();
    example::addPictureOptions(app, settings);
    CLI11_PARSE(app, argc, argv);
    run(settings);
    return 0;
}
