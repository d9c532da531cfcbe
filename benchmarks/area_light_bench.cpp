// Tables 1 and 2 of [WD13]: the naive way (a shadow volume at a time) beside imperfect voxelized
// shadow volumes, and the ways to gather; and a profile of what a pass costs without work, which
// bounds what fewer passes can save. Prints Markdown.
//
//   lamina_area_light_bench [--quick] [--context=auto|egl|osmesa]

#include "bench_case.hpp"
#include "gl/device_state.hpp"

#include <lamina/area_light/area_light.hpp>
#include <lamina/headless/context.hpp>

#include <glm/gtc/matrix_transform.hpp>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <span>
#include <string>
#include <vector>

namespace {

using namespace lamina;

template<class T>
T need(Result<T> result) {
    if (!result) {
        std::fprintf(stderr, "lamina_area_light_bench: %s\n", result.error().text.c_str());
        std::exit(1);
    }
    return std::move(*result);
}

/// What an engine would have drawn: a sloping floor's depths and normals.
struct Scene {
    Scene(const GladGLContext& functions, const Box3& box, const glm::uvec2& size)
        : gl(functions) {
        const glm::dvec3 center = box.center();
        const double radius = 0.5 * glm::length(box.size());
        view.worldToClip = glm::perspective(0.9, static_cast<double>(size.x) / size.y, 0.1 * radius,
                                            12.0 * radius) *
                           glm::lookAt(center + radius * glm::dvec3(0.4, 0.5, 3.0), center,
                                       glm::dvec3(0.0, 1.0, 0.0));
        view.size = size;
        light.corner = center + radius * glm::dvec3(-1.5, 1.2, -1.6);
        light.edgeU = radius * glm::dvec3(3.0, 0.0, 0.0);
        light.edgeV = radius * glm::dvec3(0.0, 1.0, 0.4);
        medium.extinction = static_cast<float>(0.15 / radius);
        std::vector<float> depths;
        for (std::uint32_t y = 0; y < size.y; ++y)
            depths.insert(depths.end(), size.x, 0.96f + 0.03f * static_cast<float>(y) / size.y);
        const std::vector<glm::vec4> normals(std::size_t{size.x} * size.y, glm::vec4(0, 1, 0, 0));
        gl.CreateTextures(GL_TEXTURE_2D, 2, textures);
        const auto width = static_cast<GLsizei>(size.x);
        const auto height = static_cast<GLsizei>(size.y);
        gl.TextureStorage2D(textures[0], 1, GL_R32F, width, height);
        gl.TextureSubImage2D(textures[0], 0, 0, 0, width, height, GL_RED, GL_FLOAT, depths.data());
        gl.TextureStorage2D(textures[1], 1, GL_RGBA32F, width, height);
        gl.TextureSubImage2D(textures[1], 0, 0, 0, width, height, GL_RGBA, GL_FLOAT,
                             normals.data());
        surfaces.depth = textures[0];
        surfaces.normal = textures[1];
    }
    ~Scene() { gl.DeleteTextures(2, textures); }
    Scene(const Scene&) = delete;
    Scene& operator=(const Scene&) = delete;

    const GladGLContext& gl;
    View view;
    RectangleLight light;
    Medium medium;
    SurfaceTextures surfaces;
    GLuint textures[2] = {};
};

/// Least times of the stages over some frames, after one that warms up.
AreaLightTimes measure(const Device& device, AreaLightDesc desc, const Scene& scene,
                       std::span<const GeometrySource> sources, int frames) {
    desc.measure = true;
    AreaLight effect = need(AreaLight::create(device, desc));
    AreaLightTimes least;
    least.fill(1e30);
    for (int frame = 0; frame <= frames; ++frame) {
        need(effect.prepare(scene.view, scene.light, scene.medium, sources));
        need(effect.apply(scene.view, scene.surfaces));
        scene.gl.Finish();
        const AreaLightTimes times = effect.times();
        for (std::size_t i = 0; frame > 0 && i < times.size(); ++i)
            least[i] = std::min(least[i], times[i]);
    }
    return least;
}

double at(const AreaLightTimes& times, AreaLightStage stage) {
    return times[static_cast<std::size_t>(stage)];
}

double volumes(const AreaLightTimes& times) {
    return at(times, AreaLightStage::Maps) + at(times, AreaLightStage::Voxelize);
}

void printNaiveTable(const Device& device, const Scene& scene, const GeometrySource& source,
                     std::uint32_t mostLights) {
    std::printf(
        "\n| VPLs | maps + voxelize: naive | IVSV (maps, voxelize) | ratio | scan: naive | IVSV | "
        "ratio | gather: naive | IVSV | ratio | frame: naive | IVSV | ratio |\n"
        "|---|---|---|---|---|---|---|---|---|---|---|---|---|\n");
    for (const std::uint32_t lights : {1u, 4u, 16u, 64u, 256u}) {
        if (lights > mostLights)
            break;
        AreaLightDesc desc;
        desc.virtualLights = lights;
        desc.maps = ShadowMaps::Imperfect;
        const AreaLightTimes ours = measure(device, desc, scene, {&source, 1}, 2);
        desc.maps = ShadowMaps::Rendered;
        desc.layout = VolumeLayout::Separate;
        const AreaLightTimes naive =
            measure(device, desc, scene, {&source, 1}, lights > 64 ? 1 : 2);
        double frames[2] = {};
        for (std::size_t i = 0; i < ours.size(); ++i) {
            frames[0] += naive[i];
            frames[1] += ours[i];
        }
        const auto ratio = [&](AreaLightStage stage) { return at(naive, stage) / at(ours, stage); };
        std::printf("| %u | %.1f | %.1f (%.1f, %.1f) | %.1fx | %.1f | %.1f | %.1fx | %.1f | %.1f | "
                    "%.1fx | %.0f | %.0f | %.1fx |\n",
                    lights, volumes(naive), volumes(ours), at(ours, AreaLightStage::Maps),
                    at(ours, AreaLightStage::Voxelize), volumes(naive) / volumes(ours),
                    at(naive, AreaLightStage::Scan), at(ours, AreaLightStage::Scan),
                    ratio(AreaLightStage::Scan), at(naive, AreaLightStage::Gather),
                    at(ours, AreaLightStage::Gather), ratio(AreaLightStage::Gather), frames[0],
                    frames[1], frames[0] / frames[1]);
        std::fflush(stdout);
    }
}

/// Where the time of a volume goes, per volume of many: a pass alone, its work, and so the most
/// that one pass for all can save.
void printProfile(const Device& device, const Scene& scene, const Scene& pixel,
                  const GeometrySource& source, std::uint32_t lights) {
    const auto each = [&](VolumeLayout layout, std::uint32_t voxels, const Scene& seen,
                          std::span<const GeometrySource> sources) {
        AreaLightDesc desc;
        desc.virtualLights = lights;
        desc.layout = layout;
        desc.maps = ShadowMaps::Rendered;
        desc.voxels = {voxels, voxels, 128};
        desc.mapTexels = std::max(voxels, 4u);
        AreaLightTimes times = measure(device, desc, seen, sources, 3);
        for (double& time : times)
            time *= 1e3 / lights;
        return times;
    };
    // Volumes of one texel, maps of 16, a picture of one pixel, no triangles: passes alone.
    const auto pass = each(VolumeLayout::Separate, 1, pixel, {});
    const auto rectified = each(VolumeLayout::Separate, 128, scene, {});
    const auto rectifiedAtOnce = each(VolumeLayout::Tiled, 128, scene, {});
    const auto naive = each(VolumeLayout::Separate, 128, scene, {&source, 1});
    const auto atOnce = each(VolumeLayout::Tiled, 128, scene, {&source, 1});
    std::printf("\n| us per volume of %u | pass alone | naive | one pass for all | saved | most "
                "that passes can save |\n|---|---|---|---|---|---|\n",
                lights);
    const auto row = [](const char* name, double alone, double separate, double together) {
        std::printf("| %s | %.1f | %.1f | %.1f | %.2fx | %.2fx |\n", name, alone, separate,
                    together, separate / together, separate / std::max(separate - alone, 1e-3));
    };
    const auto voxelize = AreaLightStage::Voxelize;
    row("clear a map and rectify it", at(pass, voxelize), at(rectified, voxelize),
        at(rectifiedAtOnce, voxelize));
    row("draw a map of the triangles", 0.0, at(naive, voxelize) - at(rectified, voxelize),
        at(atOnce, voxelize) - at(rectifiedAtOnce, voxelize));
    row("scan", at(pass, AreaLightStage::Scan), at(naive, AreaLightStage::Scan),
        at(atOnce, AreaLightStage::Scan));
    row("gather", at(pass, AreaLightStage::Gather), at(naive, AreaLightStage::Gather),
        at(atOnce, AreaLightStage::Gather));
}

void printGatherTable(const Device& device, const Scene& scene, const GeometrySource& source,
                      std::uint32_t lights) {
    struct Way {
        const char* name;
        GatherMode gather;
        AirlightForm airlight;
        bool interpolate;
    };
    const Way ways[] = {
        {"full, weighted", GatherMode::Full, AirlightForm::Weighted, true},
        {"full, factored", GatherMode::Full, AirlightForm::Factored, true},
        {"full, weighted, not interpolated", GatherMode::Full, AirlightForm::Weighted, false},
        {"3x3 interleaved", GatherMode::Interleaved, AirlightForm::Weighted, true},
        {"quarter resolution", GatherMode::Quarter, AirlightForm::Weighted, true}};
    std::printf(
        "\n| gather of %u VPLs | ms | filter and composite, ms | of full |\n|---|---|---|---|\n",
        lights);
    double full = 0.0;
    for (const Way& way : ways) {
        AreaLightDesc desc;
        desc.virtualLights = lights;
        desc.gather = way.gather;
        desc.airlight = way.airlight;
        desc.interpolate = way.interpolate;
        const AreaLightTimes times = measure(device, desc, scene, {&source, 1}, 2);
        const double sum = at(times, AreaLightStage::Gather) + at(times, AreaLightStage::Composite);
        full = full == 0.0 ? sum : full;
        std::printf("| %s | %.1f | %.1f | %.2f |\n", way.name, at(times, AreaLightStage::Gather),
                    at(times, AreaLightStage::Composite), sum / full);
        std::fflush(stdout);
    }
}

} // namespace

int main(int argc, char** argv) {
    bool isQuick = false;
    headless::ContextDesc options;
    for (int i = 1; i < argc; ++i) {
        const std::string argument = argv[i];
        if (argument == "--quick")
            isQuick = true;
        else if (argument == "--context=egl")
            options.api = headless::ContextApi::Egl;
        else if (argument == "--context=osmesa")
            options.api = headless::ContextApi::OsMesa;
        else if (argument != "--context=auto") {
            std::fprintf(stderr,
                         "usage: lamina_area_light_bench [--quick] [--context=auto|egl|osmesa]\n");
            return 2;
        }
    }
    headless::Context context = need(headless::Context::create(options));
    Device device = need(
        Device::fromCurrentContext([&](const char* name) { return context.getProcAddress(name); }));
    const GladGLContext& gl = device.state()->gl;
    const std::string wanted = isQuick ? "sphere_20k" : "knot_100k";
    for (const auto& mesh : bench::benchMeshes()) {
        if (mesh->name != wanted)
            continue;
        const TriangleMesh* loaded = need(mesh->get());
        const MeshBuffers buffers = need(MeshBuffers::upload(device, *loaded));
        const GeometrySource source = buffers.view();
        const glm::uvec2 size = isQuick ? glm::uvec2(48, 32) : glm::uvec2(256, 192);
        const Scene scene(gl, loaded->bounds(), size);
        std::printf("%s, %s%s: %zu triangles, %u x %u pixels, 128-cubed volumes, ms\n",
                    wanted.c_str(), device.info().renderer.c_str(),
                    device.info().isSoftware ? " [software: runs on the CPU]" : "",
                    loaded->triangles.size(), size.x, size.y);
        const Scene pixel(gl, loaded->bounds(), glm::uvec2(1));
        printProfile(device, scene, pixel, source, isQuick ? 4 : 64);
        printNaiveTable(device, scene, source, isQuick ? 4 : 256);
        printGatherTable(device, scene, source, isQuick ? 9 : 128);
    }
    return 0;
}
