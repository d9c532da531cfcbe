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
#include <variant>
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

/// What casts shadows: triangles, or maps that are there already.
using Casters = std::variant<std::span<const GeometrySource>, std::span<const LightDepthMap>>;

/// Least times of the stages over some frames, after one that warms up.
AreaLightTimes measure(const Device& device, AreaLightDesc desc, const Scene& scene,
                       const Casters& casters, int frames) {
    desc.measure = true;
    AreaLight effect = need(AreaLight::create(device, desc));
    AreaLightTimes least;
    least.fill(1e30);
    for (int frame = 0; frame <= frames; ++frame) {
        std::visit(
            [&](const auto& from) {
                need(effect.prepare(scene.view, scene.light, scene.medium, from));
            },
            casters);
        need(effect.apply(scene.view, scene.surfaces));
        scene.gl.Finish();
        const AreaLightTimes times = effect.times();
        for (std::size_t i = 0; frame > 0 && i < times.size(); ++i)
            least[i] = std::min(least[i], times[i]);
    }
    return least;
}

/// Maps of all lights, drawn already: a ball around each light.
class HostMaps {
public:
    HostMaps(const GladGLContext& functions, std::span<const VirtualLight> lights)
        : gl(functions) {
        constexpr int kSide = 128;
        gl.CreateTextures(GL_TEXTURE_2D_ARRAY, 1, &mTexture);
        gl.TextureStorage3D(mTexture, 1, GL_R32F, kSide, kSide,
                            static_cast<GLsizei>(lights.size()));
        const float radius = 1.0f;
        gl.ClearTexImage(mTexture, 0, GL_RED, GL_FLOAT, &radius);
        for (const VirtualLight& light : lights) {
            const glm::dvec3 s = glm::normalize(glm::cross(glm::dvec3(1, 0, 0), light.normal));
            LightDepthMap map;
            map.texture = mTexture;
            map.kind = DepthMapKind::HemisphereArray;
            map.layer = static_cast<std::uint32_t>(mMaps.size());
            map.worldToHemisphere =
                glm::transpose(glm::dmat3(s, glm::cross(light.normal, s), light.normal));
            mMaps.push_back(map);
        }
    }
    ~HostMaps() { gl.DeleteTextures(1, &mTexture); }
    HostMaps(const HostMaps&) = delete;
    HostMaps& operator=(const HostMaps&) = delete;

    [[nodiscard]] std::span<const LightDepthMap> maps() const { return mMaps; }

private:
    const GladGLContext& gl;
    GLuint mTexture = 0;
    std::vector<LightDepthMap> mMaps;
};

double at(const AreaLightTimes& times, AreaLightStage stage) {
    return times[static_cast<std::size_t>(stage)];
}

using Sources = std::span<const GeometrySource>;

/// The stages of one way to make and use the volumes, ms.
struct Stages {
    double maps = 0.0;
    double voxelize = 0.0;
    double scan = 0.0;
    double gather = 0.0;

    [[nodiscard]] double frame() const { return maps + voxelize + scan + gather; }
};

/// pixel: a view of one pixel, for the stages that do not depend on it. sources: of the maps.
Stages measureStages(const Device& device, const AreaLightDesc& desc, const Scene& scene,
                     const Scene& pixel, Sources sources, int frames) {
    const auto lights = need(sampleVirtualLights(scene.light, desc.virtualLights));
    const HostMaps maps(scene.gl, lights);
    const AreaLightTimes ready = measure(device, desc, pixel, maps.maps(), 4 * frames);
    const AreaLightTimes drawn = measure(device, desc, scene, sources, frames);
    Stages stages;
    stages.voxelize = at(ready, AreaLightStage::Voxelize);
    stages.scan = at(ready, AreaLightStage::Scan);
    // Drawn maps are timed with their rectification.
    stages.maps = desc.maps == ShadowMaps::Imperfect
                      ? at(drawn, AreaLightStage::Maps)
                      : at(drawn, AreaLightStage::Voxelize) - stages.voxelize;
    stages.gather = at(drawn, AreaLightStage::Gather);
    return stages;
}

void printNaiveTable(const Device& device, const Scene& scene, const Scene& pixel, Sources sources,
                     std::uint32_t mostLights) {
    std::printf("\n| VPLs | shadow maps: naive | IVSV | ratio | voxelize: naive | IVSV | ratio | "
                "scan: naive | IVSV | ratio | gather: naive | IVSV | ratio | frame: naive | IVSV | "
                "ratio |\n|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|\n");
    for (const std::uint32_t lights : {1u, 4u, 16u, 64u, 256u}) {
        if (lights > mostLights)
            break;
        AreaLightDesc desc;
        desc.virtualLights = lights;
        desc.maps = ShadowMaps::Imperfect;
        const int frames = lights > 64 ? 1 : 2;
        const Stages ours = measureStages(device, desc, scene, pixel, sources, frames);
        desc.maps = ShadowMaps::Rendered;
        desc.layout = ShadowVolumeLayout::Separate;
        const Stages naive = measureStages(device, desc, scene, pixel, sources, frames);
        std::printf("| %u |", lights);
        const auto pair = [](double slow, double fast) {
            std::printf(" %.2f | %.2f | %.1fx |", slow, fast, slow / fast);
        };
        pair(naive.maps, ours.maps);
        pair(naive.voxelize, ours.voxelize);
        pair(naive.scan, ours.scan);
        pair(naive.gather, ours.gather);
        pair(naive.frame(), ours.frame());
        std::printf("\n");
        std::fflush(stdout);
    }
}

/// What a pass costs without work: volumes of one texel, maps of 16, a picture of one pixel, no
/// triangles. That is all that one pass for all lights can save, against the work of a light.
void printProfile(const Device& device, const Scene& scene, const Scene& pixel, Sources sources,
                  std::uint32_t lights) {
    AreaLightDesc desc;
    desc.virtualLights = lights;
    desc.maps = ShadowMaps::Rendered;
    desc.layout = ShadowVolumeLayout::Separate;
    const Stages work = measureStages(device, desc, scene, pixel, sources, 2);
    desc.voxels = {1, 1, 128};
    desc.mapTexels = 4;
    const Stages pass = measureStages(device, desc, pixel, pixel, {}, 6);
    std::printf("\n| us a light, of %u naive ones | its pass without work | all | most that fewer "
                "passes save |\n|---|---|---|---|\n",
                lights);
    const auto row = [&](const char* name, double alone, double all) {
        std::printf("| %s | %.1f | %.1f | %.2fx |\n", name, 1e3 * alone / lights,
                    1e3 * all / lights, all / std::max(all - alone, 1e-6));
    };
    row("shadow map", pass.maps, work.maps);
    row("voxelize", pass.voxelize, work.voxelize);
    row("scan", pass.scan, work.scan);
    row("gather", pass.gather, work.gather);
    std::fflush(stdout);
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
        const AreaLightTimes times = measure(device, desc, scene, Sources(&source, 1), 2);
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
        printProfile(device, scene, pixel, {&source, 1}, isQuick ? 4 : 64);
        printNaiveTable(device, scene, pixel, {&source, 1}, isQuick ? 4 : 256);
        printGatherTable(device, scene, source, isQuick ? 9 : 128);
    }
    return 0;
}
