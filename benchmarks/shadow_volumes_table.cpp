// lamina_shadow_volumes_table: what culled and clamped shadow volumes cost and save ([ED06] 3.2).
//
// The court of examples/shadow_volume_clamping under the sun and by a lamp, and a knot of a million
// triangles above it; plain, culled, clamped by both searches, with geometry as receivers, and
// clipped. Times of each stage, medians of one run; stencil fragments; what was kept.

#include "stage_clock.hpp"

#include <lamina/headless/context.hpp>
#include <lamina/shadow_volumes/shadow_volumes.hpp>

#include <reference/shapes.hpp>
#include <support/check.hpp>
#include <support/court.hpp>
#include <support/engine_mesh.hpp>

#include <glm/gtc/matrix_transform.hpp>
#include <glm/gtc/type_ptr.hpp>

#include <algorithm>
#include <array>
#include <cstdio>
#include <iterator>
#include <string_view>

namespace lamina::bench {
namespace {

using example::check;
using example::HostGl;

constexpr glm::dvec4 kLamp{-3.0, 7.0, 1.0, 1.0};

struct Options {
    headless::ContextApi api = headless::ContextApi::Automatic;
    bool isQuick = false;
};

/// An engine's scene in GL buffers.
struct Stage {
    std::vector<example::EngineMesh> meshes;
    std::vector<ShadowTopology> topologies;
    std::vector<ShadowCaster> casters;
    std::vector<GeometrySource> receivers;
    std::size_t triangles = 0; ///< Of casters.
};

Stage makeStage(const HostGl& gl, const Device& device,
                const std::vector<example::CourtThing>& things) {
    Stage stage;
    stage.topologies.reserve(things.size()); // casters point to them
    for (const example::CourtThing& thing : things) {
        stage.meshes.push_back(example::upload(gl, thing.mesh));
        stage.receivers.emplace_back(stage.meshes.back().view);
        if (!thing.casts)
            continue;
        stage.topologies.push_back(check(ShadowTopology::create(device, stage.receivers.back())));
        stage.casters.push_back({&stage.topologies.back(), stage.receivers.back()});
        stage.triangles += thing.mesh.triangles.size();
    }
    return stage;
}

GLuint drawDepth(const HostGl& gl, const Stage& stage, const View& view) {
    const GLuint program =
        example::makeProgram(gl, {{GL_VERTEX_SHADER, R"(#version 450 core
layout(location = 0) in vec3 position;
layout(location = 0) uniform mat4 worldToClip;
void main() { gl_Position = worldToClip * vec4(position, 1.0); }
)"},
                                  {GL_FRAGMENT_SHADER, "#version 450 core\nvoid main() {}\n"}});
    GLuint depth = 0, framebuffer = 0;
    gl.CreateTextures(GL_TEXTURE_2D, 1, &depth);
    gl.TextureStorage2D(depth, 1, GL_DEPTH_COMPONENT32F, static_cast<GLsizei>(view.size.x),
                        static_cast<GLsizei>(view.size.y));
    gl.CreateFramebuffers(1, &framebuffer);
    gl.NamedFramebufferTexture(framebuffer, GL_DEPTH_ATTACHMENT, depth, 0);
    constexpr float kFarthest = 1.0f;
    gl.ClearNamedFramebufferfv(framebuffer, GL_DEPTH, 0, &kFarthest);
    gl.BindFramebuffer(GL_DRAW_FRAMEBUFFER, framebuffer);
    gl.Viewport(0, 0, static_cast<GLsizei>(view.size.x), static_cast<GLsizei>(view.size.y));
    gl.Enable(GL_DEPTH_TEST);
    gl.UseProgram(program);
    const glm::mat4 camera(view.worldToClip);
    gl.ProgramUniformMatrix4fv(program, 0, 1, GL_FALSE, glm::value_ptr(camera));
    for (const example::EngineMesh& mesh : stage.meshes)
        example::draw(gl, mesh);
    gl.Disable(GL_DEPTH_TEST);
    gl.BindFramebuffer(GL_DRAW_FRAMEBUFFER, 0);
    gl.DeleteFramebuffers(1, &framebuffer);
    return depth;
}

constexpr const char* kStages[] = {"lamina: visible points",
                                   "lamina: receivers",
                                   "lamina: casters seen from the light",
                                   "lamina: caster layers",
                                   "lamina: shadow volumes, prepare",
                                   "lamina: shadow volumes"};
constexpr std::size_t kStageCount = std::size(kStages);

double median(std::vector<double> values) {
    std::ranges::nth_element(values,
                             values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2));
    return values[values.size() / 2];
}

struct Variant {
    const char* name;
    ShadowVolumesDesc desc;
    VolumeExtent extent = VolumeExtent::Kept;
};

void printRow(const Device& device, StageClock& clock, const Variant& variant,
              const ShadowScene& scene, int runs) {
    auto volumes = check(ShadowVolumes::create(device, variant.desc));
    std::array<std::vector<double>, kStageCount> times;
    for (int run = -1; run < runs; ++run) {
        clock.reset();
        check(volumes.prepare(scene));
        check(volumes.apply(variant.extent));
        // The first run compiles and allocates.
        for (std::size_t i = 0; i < kStageCount && run >= 0; ++i)
            times[i].push_back(clock.milliseconds(kStages[i]));
    }
    const ShadowVolumesReport report = check(volumes.downloadReport());
    std::array<double, kStageCount> found{};
    std::ranges::transform(times, found.begin(), median);
    std::printf("%-24s |", variant.name);
    // Plain volumes need none of what prepare() finds.
    const bool isPlain = variant.extent == VolumeExtent::Whole;
    for (std::size_t i = 0; i + 1 < kStageCount; ++i)
        isPlain ? std::printf("%9s", "-") : std::printf("%9.2f", found[i]);
    std::printf("%9.2f %9.2f | %10llu %4u/%-3u %5llu/%llu\n", found[kStageCount - 1],
                found[kStageCount - 1] + (isPlain ? 0.0 : found[kStageCount - 2]),
                static_cast<unsigned long long>(isPlain ? report.stencilFragmentsWhole
                                                        : report.stencilFragments),
                isPlain ? 0 : report.castersCulled, report.casters,
                static_cast<unsigned long long>(
                    isPlain ? std::uint64_t{report.layers} * report.casters : report.layersKept),
                static_cast<unsigned long long>(std::uint64_t{report.layers} * report.casters));
}

void printScene(const HostGl& gl, const Device& device, StageClock& clock, const Options& options,
                const char* name, const Stage& stage, const glm::dvec4& light, bool isHeavy) {
    ShadowScene scene;
    scene.view.size = options.isQuick ? glm::uvec2(96, 64) : glm::uvec2(960, 640);
    const double aspect = static_cast<double>(scene.view.size.x) / scene.view.size.y;
    scene.view.worldToClip =
        glm::perspective(0.62, aspect, 0.5, 80.0) *
        glm::lookAt(glm::dvec3(4.0, 6.5, 19.0), glm::dvec3(0.3, 0.3, -0.6), glm::dvec3(0, 1, 0));
    scene.depthTexture = drawDepth(gl, stage, scene.view);
    scene.light = light;
    scene.casters = stage.casters;
    scene.receivers = stage.receivers;
    const int runs = options.isQuick ? 1 : isHeavy ? 5 : 9;
    std::printf("\n%s: %zu casters of %zu triangles, %u x %u pixels; ms, medians of %d\n"
                "%-24s | %8s %8s %8s %8s %8s %8s %9s | %10s %8s %s\n",
                name, stage.casters.size(), stage.triangles, scene.view.size.x, scene.view.size.y,
                runs, "", "visible", "receiver", "shad.map", "layers", "prepare", "stencil",
                "frame", "fragments", "culled", "layers kept");
    ShadowVolumesDesc clamped;
    clamped.layers = options.isQuick ? 4 : 32;
    clamped.lightMapTexels = options.isQuick ? 128 : 1024;
    std::vector<Variant> variants(6, {"plain", clamped, VolumeExtent::Whole});
    for (std::size_t i = 1; i < variants.size(); ++i)
        variants[i].extent = VolumeExtent::Kept;
    variants[1].name = "culled";
    variants[1].desc.clampLayers = false;
    variants[2].name = "clamped, ideal";
    variants[3].name = "clamped, practical";
    variants[3].desc.search = LayerSearch::Queries;
    variants[4].name = "clamped, geometry";
    variants[4].desc.litmap = false;
    variants[5].name = "clamped and clipped";
    variants[5].desc.clipVolumes = true;
    for (const Variant& variant : variants) {
        const bool isPractical = variant.desc.search == LayerSearch::Queries;
        // A draw of the million triangles for each of 32 layers.
        if (isHeavy && isPractical)
            continue;
        printRow(device, clock, variant, scene, isPractical ? std::min(runs, 3) : runs);
    }
    gl.DeleteTextures(1, &scene.depthTexture);
}

void run(const Options& options) {
    const headless::Context context = check(headless::Context::create({.api = options.api}));
    const auto load = [&](const char* name) { return context.getProcAddress(name); };
    StageClock clock(load);
    const HostGl gl(load);
    const Device device = check(Device::fromCurrentContext(clock.loader()));
    std::printf("%s%s\n", device.info().renderer.c_str(),
                device.info().isSoftware ? " [software: runs on the CPU]" : "");
    std::vector<example::CourtThing> things = example::makeCourt();
    const Stage court = makeStage(gl, device, things);
    printScene(gl, device, clock, options, "court, sun", court, {example::kCourtSun, 0.0}, false);
    printScene(gl, device, clock, options, "court, lamp", court, kLamp, false);
    const unsigned segments = options.isQuick ? 256 : 4096;
    const unsigned sides = options.isQuick ? 16 : 128;
    things.push_back(
        {reference::makeTorusKnot({0.5f, 3.0f, 0.0f}, 1.1f, 0.3f, 2, 3, segments, sides)});
    const Stage knot = makeStage(gl, device, things);
    printScene(gl, device, clock, options, "court and knot, lamp", knot, kLamp, true);
}

} // namespace
} // namespace lamina::bench

int main(int argc, char** argv) {
    using lamina::headless::ContextApi;
    lamina::bench::Options options;
    for (int i = 1; i < argc; ++i) {
        const std::string_view argument = argv[i];
        if (argument == "--context=egl")
            options.api = ContextApi::Egl;
        else if (argument == "--context=osmesa")
            options.api = ContextApi::OsMesa;
        else if (argument == "--quick")
            options.isQuick = true;
        else if (argument != "--context=auto") {
            std::fprintf(stderr, "usage: lamina_shadow_volumes_table [--context=auto|egl|osmesa] "
                                 "[--quick]\n");
            return 2;
        }
    }
    lamina::bench::run(options);
    return 0;
}
