// A chestnut's shadow, by lamina::transmittance ([ED06] figure 4, [CLN11] figure 2). The engine
// draws positions, normals and colours once; each picture shades them with another transmittance.
//
//   transmittance_tree [--out DIRECTORY] [--size PIXELS] [--frames N] ...
//
//   tree_shadow_map.png      a standard shadow map, in which every leaf is opaque, beside
//                            transmittance shadows
//   tree_sigma.png           leaves that take 5, 15 and 40 % of the light
//   tree_colors.png          green, reddish and yellowish leaves with shadows of their colours
//   tree_absorption.png      one coefficient for leaves and wood, beside absorption per voxel
//   tree_reference.png       transmittance shadows, by ray casting (with Embree 3), difference x 4
//   tree_000.png, ...        --frames: the sun moves

#include "support/check.hpp"
#include "support/host_gl.hpp"
#ifdef EXAMPLE_HAS_EMBREE
#include "support/leaf_reference.hpp"
#endif
#include "support/shapes.hpp"
#include "support/tree.hpp"

#include <lamina/grid_io/image.hpp>
#include <lamina/headless/context.hpp>
#include <lamina/transmittance/transmittance.hpp>

#include <CLI/CLI.hpp>
#include <glm/exponential.hpp>
#include <glm/geometric.hpp>
#include <glm/gtc/matrix_transform.hpp>
#include <glm/gtc/type_ptr.hpp>

#include <array>
#include <cmath>
#include <string>

namespace {

using example::check;
using example::HostGl;

constexpr std::size_t kClasses = 3;
constexpr std::uint32_t kWood = kClasses; // Material ids: the leaves' classes, then wood.
const std::array<glm::vec3, kClasses> kLeafColors{
    glm::vec3(0.26f, 0.42f, 0.09f), {0.55f, 0.13f, 0.06f}, {0.66f, 0.50f, 0.06f}};

struct Options {
    std::string directory = ".";
    std::uint32_t size = 480;
    std::uint32_t columns = 512;
    std::uint32_t slices = 128;
    bool isUniform = false;
    int leavesPerTwig = 170;
    int frames = 0;
};

constexpr const char* kVertexShader = R"(#version 450
layout(location = 0) uniform mat4 worldToClip;
layout(location = 0) in vec3 position;
out vec3 world;
void main() {
    world = position;
    gl_Position = worldToClip * vec4(position, 1.0);
}
)";

constexpr const char* kFragmentShader = R"(#version 450
layout(location = 1) uniform vec4 albedo; // alpha: 1 for leaves, which light passes
in vec3 world;
layout(location = 0) out vec4 positions;
layout(location = 1) out vec4 normals;
layout(location = 2) out vec4 colors;
void main() {
    positions = vec4(world, 1.0);
    normals = vec4(normalize(cross(dFdx(world), dFdy(world))), 0.0);
    colors = albedo;
}
)";

/// What the engine keeps of a mesh.
struct EngineMesh {
    lamina::MeshView view;
    GLuint vertexArray = 0;
    glm::vec4 albedo{1.0f};
};

EngineMesh upload(const HostGl& gl, const lamina::TriangleMesh& mesh, const glm::vec4& albedo,
                  std::uint32_t materialId) {
    EngineMesh made;
    made.albedo = albedo;
    made.view.vertexBuffer = example::makeBuffer(gl, std::as_bytes(std::span(mesh.positions)));
    made.view.vertexCount = static_cast<std::uint32_t>(mesh.positions.size());
    made.view.indexBuffer = example::makeBuffer(gl, std::as_bytes(std::span(mesh.triangles)));
    made.view.indexType = lamina::IndexType::UInt32;
    made.view.indexCount = static_cast<std::uint32_t>(3 * mesh.triangles.size());
    made.view.materialId = materialId;
    gl.CreateVertexArrays(1, &made.vertexArray);
    gl.VertexArrayVertexBuffer(made.vertexArray, 0, made.view.vertexBuffer, 0, sizeof(glm::vec3));
    gl.VertexArrayElementBuffer(made.vertexArray, made.view.indexBuffer);
    gl.EnableVertexArrayAttrib(made.vertexArray, 0);
    gl.VertexArrayAttribFormat(made.vertexArray, 0, 3, GL_FLOAT, GL_FALSE, 0);
    gl.VertexArrayAttribBinding(made.vertexArray, 0, 0);
    return made;
}

/// Leaves by colour: patches of the crown, so that their shadows differ on the ground.
std::array<lamina::TriangleMesh, kClasses> splitByColor(const lamina::TriangleMesh& leaves) {
    std::array<lamina::TriangleMesh, kClasses> split;
    for (lamina::TriangleMesh& mesh : split)
        mesh.positions = leaves.positions;
    for (const glm::uvec3& triangle : leaves.triangles) {
        const float patch = example::noise(0.9f * leaves.positions[triangle[0]]);
        split[patch < -0.08f ? 1 : patch > 0.08f ? 2 : 0].triangles.push_back(triangle);
    }
    return split;
}

lamina::TriangleMesh makeGround() {
    constexpr float kHalf = 40.0f;
    lamina::TriangleMesh ground;
    ground.positions = {
        {-kHalf, 0, -kHalf}, {kHalf, 0, -kHalf}, {kHalf, 0, kHalf}, {-kHalf, 0, kHalf}};
    ground.triangles = {{0, 2, 1}, {0, 3, 2}};
    return ground;
}

struct Scene {
    std::array<lamina::TriangleMesh, kClasses> leafMeshes;
    lamina::TriangleMesh woodMesh;
    std::array<EngineMesh, kClasses> leaves;
    EngineMesh wood, ground;
    lamina::Box3 bounds;

    Scene(const HostGl& gl, int leavesPerTwig) {
        example::Tree tree = example::makeTree(
            example::TreeDesc{.leavesPerTwig = leavesPerTwig, .leafLength = 0.13f});
        bounds = tree.leaves.bounds();
        bounds.extend(tree.wood.bounds().min);
        bounds.extend(tree.wood.bounds().max);
        leafMeshes = splitByColor(tree.leaves);
        woodMesh = std::move(tree.wood);
        for (std::uint32_t i = 0; i < kClasses; ++i)
            leaves[i] = upload(gl, leafMeshes[i], glm::vec4(kLeafColors[0], 1.0f), i);
        wood = upload(gl, woodMesh, {0.24f, 0.17f, 0.12f, 0.0f}, kWood);
        ground = upload(gl, makeGround(), {0.55f, 0.52f, 0.46f, 0.0f}, kWood);
    }
};

/// What the engine draws before it shades.
struct GBuffer {
    std::uint32_t size = 0;
    lamina::View view;
    GLuint framebuffer = 0, depth = 0;
    std::array<GLuint, 3> targets{}; ///< Positions, normals, colours.
    std::vector<glm::vec4> positions, normals, colors;
};

GBuffer makeGBuffer(const HostGl& gl, std::uint32_t size) {
    GBuffer made;
    made.size = size;
    made.view.size = {size, size};
    made.view.worldToClip =
        glm::perspective(glm::radians(38.0), 1.0, 0.5, 120.0) *
        glm::lookAt(glm::dvec3(-3.6, 5.8, 13.4), glm::dvec3(1.0, 2.4, 0.9), glm::dvec3(0, 1, 0));
    const auto pixels = static_cast<GLsizei>(size);
    gl.CreateFramebuffers(1, &made.framebuffer);
    gl.CreateTextures(GL_TEXTURE_2D, 1, &made.depth);
    gl.TextureStorage2D(made.depth, 1, GL_DEPTH_COMPONENT32F, pixels, pixels);
    gl.NamedFramebufferTexture(made.framebuffer, GL_DEPTH_ATTACHMENT, made.depth, 0);
    gl.CreateTextures(GL_TEXTURE_2D, 3, made.targets.data());
    constexpr GLenum kOutputs[] = {GL_COLOR_ATTACHMENT0, GL_COLOR_ATTACHMENT1,
                                   GL_COLOR_ATTACHMENT2};
    for (std::size_t i = 0; i < 3; ++i) {
        gl.TextureStorage2D(made.targets[i], 1, GL_RGBA32F, pixels, pixels);
        gl.NamedFramebufferTexture(made.framebuffer, kOutputs[i], made.targets[i], 0);
    }
    gl.NamedFramebufferDrawBuffers(made.framebuffer, 3, kOutputs);
    return made;
}

std::vector<glm::vec4> readPixels(const HostGl& gl, GLuint texture, std::uint32_t size) {
    std::vector<glm::vec4> pixels(std::size_t{size} * size);
    gl.GetTextureImage(texture, 0, GL_RGBA, GL_FLOAT,
                       static_cast<GLsizei>(pixels.size() * sizeof(glm::vec4)), pixels.data());
    return pixels;
}

void draw(const HostGl& gl, GLuint program, const Scene& scene, GBuffer& gBuffer) {
    gl.BindFramebuffer(GL_DRAW_FRAMEBUFFER, gBuffer.framebuffer);
    gl.Viewport(0, 0, static_cast<GLsizei>(gBuffer.size), static_cast<GLsizei>(gBuffer.size));
    gl.Enable(GL_DEPTH_TEST);
    constexpr float kNone[] = {0.0f, 0.0f, 0.0f, 0.0f};
    constexpr float kFarthest = 1.0f;
    for (int i = 0; i < 3; ++i)
        gl.ClearNamedFramebufferfv(gBuffer.framebuffer, GL_COLOR, i, kNone);
    gl.ClearNamedFramebufferfv(gBuffer.framebuffer, GL_DEPTH, 0, &kFarthest);
    gl.UseProgram(program);
    const glm::mat4 camera(gBuffer.view.worldToClip);
    gl.ProgramUniformMatrix4fv(program, 0, 1, GL_FALSE, glm::value_ptr(camera));
    std::vector<const EngineMesh*> meshes{&scene.ground, &scene.wood};
    for (const EngineMesh& leaves : scene.leaves)
        meshes.push_back(&leaves);
    for (const EngineMesh* mesh : meshes) {
        gl.ProgramUniform4fv(program, 1, 1, glm::value_ptr(mesh->albedo));
        gl.BindVertexArray(mesh->vertexArray);
        gl.DrawElements(GL_TRIANGLES, static_cast<GLsizei>(mesh->view.indexCount), GL_UNSIGNED_INT,
                        nullptr);
    }
    gBuffer.positions = readPixels(gl, gBuffer.targets[0], gBuffer.size);
    gBuffer.normals = readPixels(gl, gBuffer.targets[1], gBuffer.size);
    gBuffer.colors = readPixels(gl, gBuffer.targets[2], gBuffer.size);
}

/// Pictures of equal height beside each other.
class Strip {
public:
    explicit Strip(std::uint32_t height)
        : mHeight(height) {}

    /// pixels: linear colours, rows from the bottom.
    void add(const std::vector<glm::vec3>& pixels) { mPictures.push_back(pixels); }

    void write(const std::string& file) const {
        const auto count = static_cast<std::uint32_t>(mPictures.size());
        lamina::Image image{mHeight * count, mHeight, {}};
        for (std::uint32_t y = 0; y < mHeight; ++y)
            for (const auto& picture : mPictures)
                for (std::uint32_t x = 0; x < mHeight; ++x) {
                    const glm::vec3& color = picture[(mHeight - 1 - y) * mHeight + x];
                    for (int channel = 0; channel < 3; ++channel)
                        image.rgba.push_back(static_cast<std::uint8_t>(
                            255.0f * std::pow(glm::clamp(color[channel], 0.0f, 1.0f), 1 / 2.2f) +
                            0.5f));
                    image.rgba.push_back(255);
                }
        check(lamina::writePng(file, image));
        std::printf("%s\n", file.c_str());
    }

private:
    std::uint32_t mHeight;
    std::vector<std::vector<glm::vec3>> mPictures;
};

/// The lit picture. transmittance: of each pixel.
std::vector<glm::vec3> shade(const GBuffer& gBuffer, const glm::vec3& toSun,
                             const std::vector<glm::vec4>& transmittance) {
    const glm::vec3 sun(1.75f, 1.6f, 1.35f);
    const glm::vec3 sky(0.22f, 0.27f, 0.34f);
    std::vector<glm::vec3> picture;
    for (std::size_t i = 0; i < gBuffer.positions.size(); ++i) {
        if (gBuffer.positions[i].w == 0.0f) {
            picture.emplace_back(0.62f, 0.74f, 0.88f);
            continue;
        }
        const float facing = glm::dot(glm::vec3(gBuffer.normals[i]), toSun);
        const bool isLeaf = gBuffer.colors[i].w > 0.5f;
        const float received = isLeaf ? 0.35f + 0.5f * std::abs(facing) : std::max(facing, 0.0f);
        picture.push_back(glm::vec3(gBuffer.colors[i]) *
                          (sky + received * sun * glm::vec3(transmittance[i])));
    }
    return picture;
}

/// Makes the transmittance of every pixel for one kind of shadow after the other.
class Shader {
public:
    Shader(const HostGl& gl, const lamina::Device& device, const Scene& scene,
           const GBuffer& gBuffer, const glm::vec3& toSun)
        : mGl(gl)
        , mDevice(device)
        , mScene(scene)
        , mGBuffer(gBuffer) {
        for (const EngineMesh& leaves : scene.leaves)
            mLeaves.emplace_back(leaves.view);
        mWood.emplace_back(scene.wood.view);
        for (std::uint32_t i = 0; i < kClasses; ++i)
            mMaterials[i].colorClass = i;
        setSun(toSun);
    }

    void setSun(const glm::vec3& toSun) {
        mToSun = toSun;
        mLight.direction = -glm::dvec3(toSun);
    }

    /// desc: the model; casters: leaves or not.
    lamina::Transmittance make(const lamina::TransmittanceDesc& desc) const {
        return check(lamina::Transmittance::create(mDevice, desc));
    }
    void prepare(lamina::Transmittance& transmittance,
                 const lamina::TransmittanceCasters& casters) const {
        check(transmittance.prepare(mLight, casters));
    }
    [[nodiscard]] lamina::TransmittanceCasters casters() const {
        return {.leaves = mLeaves,
                .opaque = mWood,
                .opaqueMap = nullptr,
                .materials = mMaterials,
                .bounds = mScene.bounds};
    }
    std::vector<glm::vec4> apply(lamina::Transmittance& transmittance,
                                 const lamina::TransmittanceSettings& settings) const {
        check(transmittance.setSettings(settings));
        const GLuint texture = check(transmittance.apply({.view = mGBuffer.view,
                                                          .depthTexture = mGBuffer.depth,
                                                          .normalTexture = mGBuffer.targets[1]}));
        return readPixels(mGl, texture, mGBuffer.size);
    }
    [[nodiscard]] std::vector<glm::vec3> lit(const std::vector<glm::vec4>& transmittance) const {
        return shade(mGBuffer, mToSun, transmittance);
    }
    std::array<lamina::Material, kClasses + 1>& materials() { return mMaterials; }

private:
    const HostGl& mGl;
    const lamina::Device& mDevice;
    const Scene& mScene;
    const GBuffer& mGBuffer;
    glm::vec3 mToSun{0.0f};
    lamina::TransmittanceLight mLight;
    std::vector<lamina::GeometrySource> mLeaves, mWood;
    std::array<lamina::Material, kClasses + 1> mMaterials;
};

lamina::TransmittanceSettings attenuating(float sigma) {
    lamina::TransmittanceSettings settings;
    settings.attenuation.fill(glm::vec3(sigma));
    return settings;
}

/// Leaves take what they do not show.
lamina::TransmittanceSettings colored(float strength) {
    lamina::TransmittanceSettings settings;
    for (std::size_t i = 0; i < kClasses; ++i) {
        const float most = std::max({kLeafColors[i].r, kLeafColors[i].g, kLeafColors[i].b});
        settings.attenuation[i] = strength * (1.0f - 0.95f * kLeafColors[i] / most);
    }
    return settings;
}

lamina::TransmittanceDesc describe(const Options& options, std::uint32_t classes = 1) {
    return {.size = {options.columns, options.columns, options.slices},
            .localRanges = !options.isUniform,
            .classes = classes,
            .opaqueMapTexels = 2 * options.columns};
}

void drawShadowMapBesideTransmittance(const Options& options, const Shader& shader) {
    lamina::Transmittance transmittance = shader.make(describe(options));
    Strip strip(options.size);
    // A shadow map is what is left when every caster is opaque.
    lamina::TransmittanceCasters opaque = shader.casters();
    std::vector<lamina::GeometrySource> all(opaque.leaves.begin(), opaque.leaves.end());
    all.insert(all.end(), opaque.opaque.begin(), opaque.opaque.end());
    opaque.leaves = {};
    opaque.opaque = all;
    shader.prepare(transmittance, opaque);
    strip.add(shader.lit(shader.apply(transmittance, {})));
    shader.prepare(transmittance, shader.casters());
    strip.add(shader.lit(shader.apply(transmittance, attenuating(0.15f))));
    strip.write(options.directory + "/tree_shadow_map.png");

    Strip sweep(options.size);
    for (const float sigma : {0.05f, 0.15f, 0.4f})
        sweep.add(shader.lit(shader.apply(transmittance, attenuating(sigma))));
    sweep.write(options.directory + "/tree_sigma.png");
}

void drawAbsorption(const Options& options, Shader& shader) {
    Strip strip(options.size);
    lamina::TransmittanceCasters casters = shader.casters();
    std::vector<lamina::GeometrySource> all(casters.leaves.begin(), casters.leaves.end());
    all.insert(all.end(), casters.opaque.begin(), casters.opaque.end());
    casters.leaves = all;
    casters.opaque = {};
    {
        lamina::TransmittanceDesc desc = describe(options);
        desc.localRanges = false;
        lamina::Transmittance uniform = shader.make(desc);
        shader.prepare(uniform, casters);
        strip.add(shader.lit(shader.apply(uniform, attenuating(0.12f))));
    }
    for (std::uint32_t i = 0; i < kClasses; ++i)
        shader.materials()[i].absorption = 0.12f;
    shader.materials()[kWood].absorption = 3.0f;
    lamina::TransmittanceDesc desc = describe(options);
    desc.model = lamina::TransmittanceModel::Absorption;
    desc.localRanges = false;
    desc.size.z = std::min(options.slices, 64u);
    lamina::Transmittance perVoxel = shader.make(desc);
    shader.prepare(perVoxel, casters);
    strip.add(shader.lit(shader.apply(perVoxel, {})));
    strip.write(options.directory + "/tree_absorption.png");
}

#ifdef EXAMPLE_HAS_EMBREE
void drawReference(const Options& options, const Scene& scene, const GBuffer& gBuffer,
                   const Shader& shader, const glm::vec3& toSun,
                   const std::vector<glm::vec4>& transmittance,
                   const lamina::TransmittanceSettings& settings) {
    const example::LeafReference rays(scene.leafMeshes, scene.woodMesh);
    std::vector<glm::vec4> exact;
    for (const glm::vec4& position : gBuffer.positions) {
        glm::vec3 light(1.0f);
        if (position.w > 0.0f) {
            const auto crossings = rays.towards(glm::vec3(position), toSun);
            for (std::size_t i = 0; i < kClasses; ++i)
                light *= glm::pow(1.0f - settings.attenuation[i],
                                  glm::vec3(static_cast<float>(crossings.leaves[i])));
            if (crossings.isBehindWood)
                light = glm::vec3(0.0f);
        }
        exact.emplace_back(light, 1.0f);
    }
    double squares = 0.0;
    std::size_t count = 0;
    std::vector<glm::vec3> difference;
    for (std::size_t i = 0; i < exact.size(); ++i) {
        difference.push_back(4.0f * glm::abs(glm::vec3(transmittance[i] - exact[i])));
        if (gBuffer.positions[i].w == 0.0f)
            continue;
        squares += std::pow(transmittance[i].g - exact[i].g, 2.0);
        ++count;
    }
    Strip strip(options.size);
    strip.add(shader.lit(transmittance));
    strip.add(shader.lit(exact));
    strip.add(difference);
    strip.write(options.directory + "/tree_reference.png");
    std::printf("RMS error of transmittance against ray casting: %.4f\n",
                std::sqrt(squares / static_cast<double>(count)));
}
#endif

void run(const Options& options) {
    lamina::headless::Context context = check(lamina::headless::Context::create());
    const auto load = [&](const char* name) { return context.getProcAddress(name); };
    const HostGl gl(load);
    const lamina::Device device = check(lamina::Device::fromCurrentContext(load));
    const GLuint program = example::makeProgram(
        gl, {{GL_VERTEX_SHADER, kVertexShader}, {GL_FRAGMENT_SHADER, kFragmentShader}});
    Scene scene(gl, options.leavesPerTwig);
    GBuffer gBuffer = makeGBuffer(gl, options.size);
    draw(gl, program, scene, gBuffer);

    glm::vec3 toSun = glm::normalize(glm::vec3(-0.62f, 1.0f, -0.30f));
    Shader shader(gl, device, scene, gBuffer, toSun);
    drawShadowMapBesideTransmittance(options, shader);
    drawAbsorption(options, shader);

    for (std::uint32_t i = 0; i < kClasses; ++i)
        scene.leaves[i].albedo = glm::vec4(kLeafColors[i], 1.0f);
    draw(gl, program, scene, gBuffer);
    lamina::Transmittance transmittance = shader.make(describe(options, kClasses));
    shader.prepare(transmittance, shader.casters());
    const lamina::TransmittanceSettings settings = colored(0.3f);
    const auto color = shader.apply(transmittance, settings);
    Strip colors(options.size);
    colors.add(shader.lit(color));
    colors.write(options.directory + "/tree_colors.png");
#ifdef EXAMPLE_HAS_EMBREE
    drawReference(options, scene, gBuffer, shader, toSun, color, settings);
#endif
    for (int frame = 0; frame < options.frames; ++frame) {
        const float angle =
            6.2832f * static_cast<float>(frame) / static_cast<float>(options.frames);
        toSun = glm::normalize(glm::vec3(0.7f * std::sin(angle), 1.0f, -0.7f * std::cos(angle)));
        shader.setSun(toSun);
        shader.prepare(transmittance, shader.casters());
        Strip strip(options.size);
        strip.add(shader.lit(shader.apply(transmittance, settings)));
        char file[32];
        std::snprintf(file, sizeof file, "/tree_%03d.png", frame);
        strip.write(options.directory + file);
    }
}

} // namespace

int main(int argc, char** argv) {
    Options options;
    CLI::App app("A chestnut's shadow on the ground, as PNG files");
    app.add_option("--out", options.directory, "Existing directory for the pictures")
        ->capture_default_str();
    app.add_option("--size", options.size, "Pixels a side of a picture")
        ->capture_default_str()
        ->check(CLI::Range(16, 4096));
    app.add_option("--columns", options.columns, "Columns of the slicemaps each way")
        ->capture_default_str()
        ->check(CLI::Range(16, 4096));
    app.add_option("--slices", options.slices, "Slices")
        ->capture_default_str()
        ->check(CLI::Range(8, 4096));
    app.add_flag("--uniform", options.isUniform, "Slices of the whole depth, not of each column's");
    app.add_option("--leaves", options.leavesPerTwig, "Leaves of each of 480 twigs")
        ->capture_default_str()
        ->check(CLI::Range(1, 2000));
    app.add_option("--frames", options.frames, "Pictures of an animation of the sun")
        ->capture_default_str()
        ->check(CLI::Range(0, 999));
    CLI11_PARSE(app, argc, argv);
    run(options);
    return 0;
}
