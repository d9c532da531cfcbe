// Looks bound to volumes ([TD08], figure 3): inside one lens the tower is a blueprint, inside
// another an X-ray, and elsewhere a lit surface. One set of sprites decides, fragment by fragment,
// in every pass:
//   1. nearest surfaces: normal, style, distance; the X-ray lens lets through;
//   2. farthest surfaces of the blueprint lens, for its hidden edges;
//   3. all surfaces of the X-ray lens add up; the lenses' own surfaces add a rim;
//   4. a full-screen pass lights, finds the edges, and mixes.
//
//   parity_styles OUT.png [--columns N] [--width N] [--height N] [--turn DEGREES]

#include "support/check.hpp"
#include "support/clip_shapes.hpp"
#include "support/engine_mesh.hpp"
#include "support/host_gl.hpp"
#include "support/picture_options.hpp"
#include "support/tower.hpp"

#include <lamina/gl/shaders.hpp>
#include <lamina/grid_io/image.hpp>
#include <lamina/headless/context.hpp>
#include <lamina/parity/sprite_builder.hpp>
#include <lamina/parity/sprite_set.hpp>

#include <CLI/CLI.hpp>
#include <glm/gtc/matrix_transform.hpp>
#include <glm/gtc/type_ptr.hpp>

#include <array>
#include <cmath>

namespace {

using example::check;
using example::EngineMesh;
using example::HostGl;

struct Settings {
    std::string file;
    std::uint32_t columns = 1024;
    int width = 1200, height = 900;
    float turn = 0.0f; ///< Of the lenses about the tower, degrees.
};

/// Drawn larger and averaged: the edges come out smooth.
constexpr int kSupersampling = 2;

constexpr const char* kVertexShader = R"(#version 450
layout(location = 0) uniform mat4 worldToClip;
layout(location = 1) uniform mat4 localToWorld;
layout(location = 0) in vec3 position;
out vec3 world;
void main() {
    vec4 place = localToWorld * vec4(position, 1.0);
    world = place.xyz;
    gl_Position = worldToClip * place;
}
)";

// Follows lamina/parity.glsl with two sprites, the lenses.
constexpr const char* kSceneShader = R"(
#line 1
layout(location = 4) uniform int stage; // 0 nearest, 1 farthest of the blueprint, 2 X-ray, 3 rims
layout(location = 5) uniform vec3 eye;
in vec3 world;
layout(location = 0) out vec4 normalAndStyle; // stages 2 and 3: what adds up
layout(location = 1) out float distance;

const uint kBlueprint = 1u, kXray = 2u;

void main() {
    vec3 view = eye - world;
    vec3 normal = normalize(cross(dFdx(world), dFdy(world)));
    float facing = abs(dot(normal, normalize(view)));
    uint lenses = laminaParityMask(world);
    distance = length(view);
    if (stage == 3) {
        normalAndStyle = vec4(0.0, 0.0, 0.0, 0.08 + 0.55 * pow(1.0 - facing, 3.0));
        return;
    }
    bool isXray = (lenses & kXray) != 0u;
    bool isBlueprint = !isXray && (lenses & kBlueprint) != 0u;
    if (stage == 2 ? !isXray : isXray || (stage == 1 && !isBlueprint))
        discard;
    if (stage == 2)
        normalAndStyle = vec4(vec3(0.55, 0.85, 1.0) * (0.06 + 0.5 * pow(1.0 - facing, 2.0)), 0.0);
    else
        normalAndStyle = vec4(dot(normal, view) < 0.0 ? -normal : normal, isBlueprint ? 2.0 : 1.0);
}
)";

constexpr const char* kScreenVertexShader = R"(#version 450
void main() {
    gl_Position = vec4(gl_VertexID == 1 ? 3.0 : -1.0, gl_VertexID == 2 ? 3.0 : -1.0, 0.0, 1.0);
}
)";

constexpr const char* kScreenShader = R"(#version 450
layout(binding = 0) uniform sampler2D nearNormals;
layout(binding = 1) uniform sampler2D nearDistances;
layout(binding = 2) uniform sampler2D farNormals;
layout(binding = 3) uniform sampler2D farDistances;
layout(binding = 4) uniform sampler2D sums;
out vec4 color;

// 1 where neighbours differ in normal or jump in distance.
float edge(sampler2D normals, sampler2D distances, ivec2 p) {
    ivec2 last = textureSize(normals, 0) - 1;
    vec4 here = texelFetch(normals, p, 0);
    float bend = 0.0;
    vec2 jump = vec2(0.0);
    for (int axis = 0; axis < 2; ++axis) {
        ivec2 offset = axis == 0 ? ivec2(1, 0) : ivec2(0, 1);
        vec4 a = texelFetch(normals, clamp(p - offset, ivec2(0), last), 0);
        vec4 b = texelFetch(normals, clamp(p + offset, ivec2(0), last), 0);
        float da = texelFetch(distances, clamp(p - offset, ivec2(0), last), 0).r;
        float db = texelFetch(distances, clamp(p + offset, ivec2(0), last), 0).r;
        // Only within the style: its border is no edge of the shape.
        if (a.w == here.w)
            bend = max(bend, 1.0 - dot(a.xyz, here.xyz));
        if (b.w == here.w)
            bend = max(bend, 1.0 - dot(b.xyz, here.xyz));
        // The second difference: 0 on slopes.
        jump[axis] = abs(da + db - 2.0 * texelFetch(distances, p, 0).r);
    }
    return max(smoothstep(0.12, 0.35, bend), smoothstep(0.10, 0.25, max(jump.x, jump.y)));
}

void main() {
    ivec2 p = ivec2(gl_FragCoord.xy);
    vec2 size = vec2(textureSize(nearNormals, 0));
    vec3 paper = mix(vec3(0.20, 0.22, 0.26), vec3(0.44, 0.50, 0.58), gl_FragCoord.y / size.y);
    vec4 near = texelFetch(nearNormals, p, 0);
    vec3 result = paper;
    if (near.w == 1.0) {
        float light = max(dot(near.xyz, normalize(vec3(0.45, 0.8, 0.75))), 0.0);
        result = vec3(0.78, 0.66, 0.47) * (0.22 + 0.10 * near.y + 0.70 * light);
        result = pow(result, vec3(1.0 / 1.8));
    } else if (near.w == 2.0) {
        result = mix(vec3(0.03, 0.16, 0.42), vec3(0.07, 0.26, 0.56), 0.5 + 0.5 * near.z);
        float hidden = texelFetch(farNormals, p, 0).w == 2.0 ? edge(farNormals, farDistances, p) : 0.0;
        result = mix(result, vec3(0.45, 0.66, 0.95), 0.45 * hidden);
        result = mix(result, vec3(0.93, 0.97, 1.0), edge(nearNormals, nearDistances, p));
    }
    vec4 sum = texelFetch(sums, p, 0);
    // An X-ray picture: the deeper, the brighter, on black.
    float isXray = clamp(12.0 * sum.r, 0.0, 1.0);
    result = mix(result, 0.25 * result, isXray) + 1.0 - exp(-1.1 * sum.rgb);
    result = mix(result, vec3(0.85, 0.95, 1.0), clamp(sum.a, 0.0, 1.0) * 0.45);
    color = vec4(result, 1.0);
}
)";

GLuint makeTexture(const HostGl& gl, GLenum format, int width, int height) {
    GLuint texture = 0;
    gl.CreateTextures(GL_TEXTURE_2D, 1, &texture);
    gl.TextureStorage2D(texture, 1, format, width, height);
    return texture;
}

/// Normals with styles, and distances.
struct SurfaceTarget {
    GLuint framebuffer = 0, normals = 0, distances = 0, depth = 0;
};

SurfaceTarget makeSurfaceTarget(const HostGl& gl, int width, int height) {
    SurfaceTarget made;
    made.normals = makeTexture(gl, GL_RGBA16F, width, height);
    made.distances = makeTexture(gl, GL_R32F, width, height);
    made.depth = makeTexture(gl, GL_DEPTH_COMPONENT32F, width, height);
    gl.CreateFramebuffers(1, &made.framebuffer);
    gl.NamedFramebufferTexture(made.framebuffer, GL_COLOR_ATTACHMENT0, made.normals, 0);
    gl.NamedFramebufferTexture(made.framebuffer, GL_COLOR_ATTACHMENT1, made.distances, 0);
    gl.NamedFramebufferTexture(made.framebuffer, GL_DEPTH_ATTACHMENT, made.depth, 0);
    constexpr GLenum kBoth[] = {GL_COLOR_ATTACHMENT0, GL_COLOR_ATTACHMENT1};
    gl.NamedFramebufferDrawBuffers(made.framebuffer, 2, kBoth);
    return made;
}

void clear(const HostGl& gl, const SurfaceTarget& target, float depth) {
    constexpr float kNothing[] = {0, 0, 0, 0};
    constexpr float kFarAway[] = {100.0f, 0, 0, 0};
    gl.ClearNamedFramebufferfv(target.framebuffer, GL_COLOR, 0, kNothing);
    gl.ClearNamedFramebufferfv(target.framebuffer, GL_COLOR, 1, kFarAway);
    gl.ClearNamedFramebufferfv(target.framebuffer, GL_DEPTH, 0, &depth);
}

/// A mesh and where it stands.
struct Placed {
    EngineMesh mesh;
    glm::mat4 localToWorld{1.0f};
};

/// The engine's frame.
class Frame {
public:
    Frame(const HostGl& gl, const Settings& settings);
    void draw(const Placed& tower, std::span<const Placed> lenses) const;
    [[nodiscard]] lamina::Image read() const;

private:
    void drawStage(int stage, std::span<const Placed> meshes) const;

    const HostGl& mGl;
    int mWidth, mHeight;
    GLuint mScene = 0, mScreen = 0, mEmpty = 0;
    SurfaceTarget mNear, mFar;
    GLuint mSums = 0, mSumFramebuffer = 0;
    GLuint mPictureFramebuffer = 0;
};

Frame::Frame(const HostGl& gl, const Settings& settings)
    : mGl(gl)
    , mWidth(settings.width * kSupersampling)
    , mHeight(settings.height * kSupersampling)
    , mNear(makeSurfaceTarget(gl, mWidth, mHeight))
    , mFar(makeSurfaceTarget(gl, mWidth, mHeight)) {
    mScene = example::makeProgram(
        gl, {{GL_VERTEX_SHADER, kVertexShader},
             {GL_FRAGMENT_SHADER, "#version 450\n#define LAMINA_PARITY_COUNT 2\n" +
                                      check(lamina::shaderSource("lamina/parity.glsl")) +
                                      kSceneShader}});
    mScreen = example::makeProgram(
        gl, {{GL_VERTEX_SHADER, kScreenVertexShader}, {GL_FRAGMENT_SHADER, kScreenShader}});
    const glm::vec3 eye(3.5f, 8.4f, 16.5f);
    const float aspect = static_cast<float>(mWidth) / static_cast<float>(mHeight);
    const glm::mat4 camera = glm::perspective(glm::radians(37.0f), aspect, 0.5f, 60.0f) *
                             glm::lookAt(eye, glm::vec3(0, 3.7f, 0), glm::vec3(0, 1, 0));
    gl.ProgramUniformMatrix4fv(mScene, 0, 1, GL_FALSE, glm::value_ptr(camera));
    gl.ProgramUniform3fv(mScene, 5, 1, glm::value_ptr(eye));

    gl.CreateVertexArrays(1, &mEmpty);
    mSums = makeTexture(gl, GL_RGBA16F, mWidth, mHeight);
    gl.CreateFramebuffers(1, &mSumFramebuffer);
    gl.NamedFramebufferTexture(mSumFramebuffer, GL_COLOR_ATTACHMENT0, mSums, 0);
    // Hidden behind the nearest surfaces.
    gl.NamedFramebufferTexture(mSumFramebuffer, GL_DEPTH_ATTACHMENT, mNear.depth, 0);
    gl.CreateFramebuffers(1, &mPictureFramebuffer);
    gl.NamedFramebufferTexture(mPictureFramebuffer, GL_COLOR_ATTACHMENT0,
                               makeTexture(gl, GL_RGBA8, mWidth, mHeight), 0);
}

void Frame::drawStage(int stage, std::span<const Placed> meshes) const {
    mGl.ProgramUniform1i(mScene, 4, stage);
    for (const Placed& placed : meshes) {
        mGl.ProgramUniformMatrix4fv(mScene, 1, 1, GL_FALSE, glm::value_ptr(placed.localToWorld));
        example::draw(mGl, placed.mesh);
    }
}

void Frame::draw(const Placed& tower, std::span<const Placed> lenses) const {
    const std::span scene(&tower, 1);
    mGl.Viewport(0, 0, mWidth, mHeight);
    mGl.UseProgram(mScene);
    mGl.Enable(GL_DEPTH_TEST);
    clear(mGl, mNear, 1.0f);
    mGl.BindFramebuffer(GL_DRAW_FRAMEBUFFER, mNear.framebuffer);
    drawStage(0, scene);

    clear(mGl, mFar, 0.0f);
    mGl.BindFramebuffer(GL_DRAW_FRAMEBUFFER, mFar.framebuffer);
    mGl.DepthFunc(GL_GREATER);
    drawStage(1, scene);
    mGl.DepthFunc(GL_LESS);

    constexpr float kNothing[] = {0, 0, 0, 0};
    mGl.ClearNamedFramebufferfv(mSumFramebuffer, GL_COLOR, 0, kNothing);
    mGl.BindFramebuffer(GL_DRAW_FRAMEBUFFER, mSumFramebuffer);
    mGl.DepthMask(GL_FALSE);
    mGl.Enable(GL_BLEND);
    mGl.BlendFunc(GL_ONE, GL_ONE);
    drawStage(2, scene);
    drawStage(3, lenses);
    mGl.Disable(GL_BLEND);
    mGl.DepthMask(GL_TRUE);

    mGl.Disable(GL_DEPTH_TEST);
    mGl.BindFramebuffer(GL_DRAW_FRAMEBUFFER, mPictureFramebuffer);
    mGl.UseProgram(mScreen);
    const GLuint textures[] = {mNear.normals, mNear.distances, mFar.normals, mFar.distances, mSums};
    for (GLuint unit = 0; unit < 5; ++unit)
        mGl.BindTextureUnit(unit, textures[unit]);
    mGl.BindVertexArray(mEmpty);
    mGl.DrawArrays(GL_TRIANGLES, 0, 3);
}

lamina::Image Frame::read() const {
    std::vector<std::uint8_t> large(std::size_t{4} * static_cast<std::size_t>(mWidth * mHeight));
    mGl.BindFramebuffer(GL_READ_FRAMEBUFFER, mPictureFramebuffer);
    mGl.ReadPixels(0, 0, mWidth, mHeight, GL_RGBA, GL_UNSIGNED_BYTE, large.data());
    const int width = mWidth / kSupersampling;
    const int height = mHeight / kSupersampling;
    lamina::Image image{static_cast<std::uint32_t>(width), static_cast<std::uint32_t>(height), {}};
    for (int y = height - 1; y >= 0; --y) // the first row is the top one
        for (int x = 0; x < width; ++x)
            for (int channel = 0; channel < 4; ++channel) {
                int sum = 0;
                for (int i = 0; i < kSupersampling * kSupersampling; ++i) {
                    const int row = y * kSupersampling + i / kSupersampling;
                    const int column = x * kSupersampling + i % kSupersampling;
                    sum += large[static_cast<std::size_t>(4 * (row * mWidth + column) + channel)];
                }
                image.rgba.push_back(
                    static_cast<std::uint8_t>(sum / (kSupersampling * kSupersampling)));
            }
    return image;
}

void run(const Settings& settings) {
    lamina::headless::Context context = check(lamina::headless::Context::create());
    const auto load = [&](const char* name) { return context.getProcAddress(name); };
    const HostGl gl(load);
    lamina::Device device = check(lamina::Device::fromCurrentContext(load));

    // The lenses are built once, where they were modelled, and moved by their matrices.
    const lamina::TriangleMesh shapes[] = {example::makeWavyBall({}, 2.3f),
                                           example::makeKnot({}, 1.6f, 0.56f)};
    const glm::vec3 places[] = {{-1.6f, 5.0f, 2.2f}, {1.7f, 2.9f, 2.4f}};
    const glm::mat4 turned =
        glm::rotate(glm::mat4(1.0f), glm::radians(settings.turn), glm::vec3(0, 1, 0));
    auto builder = check(lamina::SpriteBuilder::create(device));
    std::vector<lamina::DepthSprite> sprites;
    std::vector<Placed> lenses;
    for (std::size_t i = 0; i < 2; ++i) {
        lenses.push_back({upload(gl, shapes[i]), glm::translate(turned, places[i])});
        const lamina::GeometrySource source = lenses.back().mesh.view;
        const auto place =
            check(lamina::fitSprite(shapes[i].bounds(), {0, 0, 1}, settings.columns));
        sprites.push_back(check(lamina::DepthSprite::create(device)));
        check(builder.buildAndWait({&source, 1}, place, sprites.back()));
    }
    auto set = check(lamina::SpriteSet::create(device));
    check(set.update(std::array{
        lamina::SpriteInstance{.sprite = &sprites[0], .localToWorld = lenses[0].localToWorld},
        lamina::SpriteInstance{.sprite = &sprites[1], .localToWorld = lenses[1].localToWorld}}));

    const Frame frame(gl, settings);
    const Placed tower{upload(gl, example::makeTower())};
    set.bind();
    frame.draw(tower, lenses);
    check(lamina::writePng(settings.file, frame.read()));
    std::printf("%s: lenses of %u and %u layers\n", settings.file.c_str(), sprites[0].layers(),
                sprites[1].layers());
}

} // namespace

int main(int argc, char** argv) {
    Settings settings;
    CLI::App app("Draws a tower in three styles, two of them bound to lenses.");
    app.add_option("file", settings.file, "The picture, a PNG")->required();
    app.add_option("--turn", settings.turn, "Of the lenses about the tower, degrees")
        ->capture_default_str();
    example::addPictureOptions(app, settings);
    CLI11_PARSE(app, argc, argv);
    run(settings);
    return 0;
}
