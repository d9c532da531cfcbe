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
#ifdef EXAMPLE_HAS_EMBREE
#include "support/leaf_reference.hpp"
#endif
#include "support/strip.hpp"
#include "support/tree_stage.hpp"

#include <lamina/headless/context.hpp>
#include <lamina/transmittance/transmittance.hpp>

#include <CLI/CLI.hpp>
#include <glm/exponential.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <string>

namespace {

using example::check;
using example::Strip;
using example::TreeStage;

constexpr std::size_t kClasses = example::kLeafClasses;

struct Options {
    std::string directory = ".";
    std::uint32_t size = 480;
    std::uint32_t columns = 512;
    std::uint32_t slices = 128;
    bool isUniform = false;
    int leavesPerTwig = 170;
    int frames = 0;
};

/// The lit picture. transmittance: of each pixel.
std::vector<glm::vec3> shade(const TreeStage::Pixels& pixels, const glm::vec3& toSun,
                             const std::vector<glm::vec4>& transmittance) {
    const glm::vec3 sun(1.75f, 1.6f, 1.35f);
    const glm::vec3 sky(0.22f, 0.27f, 0.34f);
    std::vector<glm::vec3> picture;
    for (std::size_t i = 0; i < pixels.positions.size(); ++i) {
        if (pixels.positions[i].w == 0.0f) {
            picture.emplace_back(0.62f, 0.74f, 0.88f);
            continue;
        }
        const float facing = glm::dot(glm::vec3(pixels.normals[i]), toSun);
        const bool isLeaf = pixels.colors[i].w > 0.5f;
        const float received = isLeaf ? 0.35f + 0.5f * std::abs(facing) : std::max(facing, 0.0f);
        picture.push_back(glm::vec3(pixels.colors[i]) *
                          (sky + received * sun * glm::vec3(transmittance[i])));
    }
    return picture;
}

/// Makes the transmittance of every pixel for one kind of shadow after the other.
class Shader {
public:
    Shader(const lamina::Device& device, const TreeStage& stage, const glm::vec3& toSun)
        : mDevice(device)
        , mStage(stage)
        , mPixels(stage.draw(false)) {
        for (const example::EngineMesh& leaves : stage.leaves())
            mLeaves.emplace_back(leaves.view);
        mWood.emplace_back(stage.wood().view);
        for (std::uint32_t i = 0; i < kClasses; ++i)
            mMaterials[i].colorClass = i;
        setSun(toSun);
    }

    void setSun(const glm::vec3& toSun) {
        mToSun = toSun;
        mLight.direction = -glm::dvec3(toSun);
    }
    /// Draws the leaves in their colours from now on.
    void showColors() { mPixels = mStage.draw(true); }

    [[nodiscard]] lamina::Transmittance make(const lamina::TransmittanceDesc& desc) const {
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
                .bounds = mStage.bounds()};
    }
    std::vector<glm::vec4> apply(lamina::Transmittance& transmittance,
                                 const lamina::TransmittanceSettings& settings) const {
        check(transmittance.setSettings(settings));
        return mStage.read(check(transmittance.apply({.view = mStage.view(),
                                                      .depthTexture = mStage.depthTexture(),
                                                      .normalTexture = mStage.normalTexture()})));
    }
    [[nodiscard]] std::vector<glm::vec3> lit(const std::vector<glm::vec4>& transmittance) const {
        return shade(mPixels, mToSun, transmittance);
    }
    [[nodiscard]] const TreeStage::Pixels& pixels() const { return mPixels; }
    [[nodiscard]] const glm::vec3& toSun() const { return mToSun; }
    std::array<lamina::Material, kClasses + 1>& materials() { return mMaterials; }

private:
    const lamina::Device& mDevice;
    const TreeStage& mStage;
    TreeStage::Pixels mPixels;
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
        const float most = std::max(
            {example::kLeafColors[i].r, example::kLeafColors[i].g, example::kLeafColors[i].b});
        settings.attenuation[i] = strength * (1.0f - 0.95f * example::kLeafColors[i] / most);
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
    shader.materials()[example::kWoodMaterial].absorption = 3.0f;
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
void drawReference(const Options& options, const TreeStage& stage, const Shader& shader,
                   const std::vector<glm::vec4>& transmittance,
                   const lamina::TransmittanceSettings& settings) {
    const example::LeafReference rays(stage.leafMeshes(), stage.woodMesh());
    const std::vector<glm::vec4>& positions = shader.pixels().positions;
    std::vector<glm::vec4> exact;
    for (const glm::vec4& position : positions) {
        glm::vec3 light(1.0f);
        if (position.w > 0.0f) {
            const auto crossings = rays.towards(glm::vec3(position), shader.toSun());
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
        if (positions[i].w == 0.0f)
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

void drawColors(const Options& options, [[maybe_unused]] const TreeStage& stage, Shader& shader) {
    shader.showColors();
    lamina::Transmittance transmittance = shader.make(describe(options, kClasses));
    shader.prepare(transmittance, shader.casters());
    const lamina::TransmittanceSettings settings = colored(0.3f);
    const auto color = shader.apply(transmittance, settings);
    Strip colors(options.size);
    colors.add(shader.lit(color));
    colors.write(options.directory + "/tree_colors.png");
#ifdef EXAMPLE_HAS_EMBREE
    drawReference(options, stage, shader, color, settings);
#endif
    for (int frame = 0; frame < options.frames; ++frame) {
        const float angle =
            6.2832f * static_cast<float>(frame) / static_cast<float>(options.frames);
        shader.setSun(
            glm::normalize(glm::vec3(0.7f * std::sin(angle), 1.0f, -0.7f * std::cos(angle))));
        shader.prepare(transmittance, shader.casters());
        Strip strip(options.size);
        strip.add(shader.lit(shader.apply(transmittance, settings)));
        char file[32];
        std::snprintf(file, sizeof file, "/tree_%03d.png", frame);
        strip.write(options.directory + file);
    }
}

void run(const Options& options) {
    lamina::headless::Context context = check(lamina::headless::Context::create());
    const auto load = [&](const char* name) { return context.getProcAddress(name); };
    const example::HostGl gl(load);
    const lamina::Device device = check(lamina::Device::fromCurrentContext(load));
    const TreeStage stage(gl, options.leavesPerTwig, options.size);
    Shader shader(device, stage, glm::normalize(glm::vec3(-0.62f, 1.0f, -0.30f)));
    drawShadowMapBesideTransmittance(options, shader);
    drawAbsorption(options, shader);
    drawColors(options, stage, shader);
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
