// lamina_transmittance_table: how right and how fast transmittance shadows of a tree are.
//
// Error: against exact crossings by ray casting, beside a perfect slicemap of the same columns and
// slices. Cost: [ED06] Table 1 anew, beside a plain shadow map of the same scene.

#include "stage_clock.hpp"

#include "gl/device_state.hpp"
#include "transmittance/light_faces.hpp"

#include <lamina/gl/shaders.hpp>
#include <lamina/headless/context.hpp>
#include <lamina/transmittance/transmittance.hpp>

#ifdef LAMINA_HAS_EMBREE
#include <reference/leaf_rays.hpp>
#endif
#include <support/tree.hpp>

#include <glm/gtc/matrix_transform.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <string_view>

namespace {

using namespace lamina;
using bench::StageClock;

constexpr float kSigma = 0.1f;
const glm::dvec3 kToSun = glm::normalize(glm::dvec3(-0.45, 1.0, -0.62));

template<class T>
T check(Result<T> result) {
    if (!result) {
        std::fprintf(stderr, "lamina_transmittance_table: %s\n", result.error().text.c_str());
        std::exit(1);
    }
    return std::move(*result);
}
void check(const Result<void>& result) {
    if (!result) {
        std::fprintf(stderr, "lamina_transmittance_table: %s\n", result.error().text.c_str());
        std::exit(1);
    }
}

struct Options {
    headless::ContextApi api = headless::ContextApi::Automatic;
    bool isQuick = false;
};

TransmittanceLight sun() {
    TransmittanceLight light;
    light.direction = -kToSun;
    return light;
}

TransmittanceSettings sampledSettings() {
    TransmittanceSettings settings;
    settings.attenuation.fill(glm::vec3(kSigma));
    settings.slices = SliceLookup::Sampled;
    settings.filterWidth = 0.0f;
    settings.depthBias = 0.0f;
    return settings;
}

TransmittanceSettings linearSettings() {
    TransmittanceSettings settings;
    settings.attenuation.fill(glm::vec3(kSigma));
    return settings;
}

TransmittanceDesc describe(std::uint32_t columns, std::uint32_t slices, bool isLocal) {
    TransmittanceDesc desc;
    desc.size = {columns, columns, slices};
    desc.localRanges = isLocal;
    desc.opaqueMapTexels = columns;
    return desc;
}

#ifdef LAMINA_HAS_EMBREE

/// Asks lamina/transmittance.glsl about points.
class Prober {
public:
    explicit Prober(const GladGLContext& gl)
        : mGl(gl) {}

    /// The number of leaves before each point that T amounts to.
    std::vector<double> counts(Transmittance& transmittance,
                               std::span<const reference::SurfacePoint> points,
                               bool hasNormals) const {
        std::vector<glm::vec4> input;
        for (const auto& point : points) {
            input.emplace_back(glm::vec3(point.position), 0.0f);
            input.emplace_back(hasNormals ? glm::vec3(point.normal) : glm::vec3(0.0f), 0.0f);
        }
        const std::size_t bytes = points.size() * sizeof(glm::vec4);
        GLuint buffers[2];
        mGl.CreateBuffers(2, buffers);
        mGl.NamedBufferData(buffers[0], static_cast<GLsizeiptr>(2 * bytes), input.data(),
                            GL_STATIC_DRAW);
        mGl.NamedBufferData(buffers[1], static_cast<GLsizeiptr>(bytes), nullptr, GL_STATIC_READ);
        mGl.BindBuffersBase(GL_SHADER_STORAGE_BUFFER, 0, 2, buffers);
        const GLuint program = build(transmittance);
        transmittance.bind();
        mGl.UseProgram(program);
        mGl.DispatchCompute(static_cast<GLuint>((points.size() + 63) / 64), 1, 1);
        mGl.MemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
        std::vector<glm::vec4> output(points.size());
        mGl.GetNamedBufferSubData(buffers[1], 0, static_cast<GLsizeiptr>(bytes), output.data());
        mGl.UseProgram(0);
        mGl.DeleteProgram(program);
        mGl.DeleteBuffers(2, buffers);
        std::vector<double> counts;
        for (const glm::vec4& value : output)
            counts.push_back(std::log(static_cast<double>(value.x)) / std::log(1.0 - kSigma));
        return counts;
    }

private:
    [[nodiscard]] GLuint build(const Transmittance& transmittance) const {
        const std::string source = "#version 450 core\n" + transmittance.shaderDefines() +
                                   check(shaderSource("lamina/transmittance.glsl")) + R"(
layout(local_size_x = 64) in;
layout(std430, binding = 0) readonly buffer Points { vec4 points[]; };
layout(std430, binding = 1) buffer Results { vec4 results[]; };
void main() {
    uint i = gl_GlobalInvocationID.x;
    if (i < uint(results.length()))
        results[i] = vec4(laminaTransmittance(points[2u * i].xyz, points[2u * i + 1u].xyz), 1.0);
}
)";
        const char* text = source.c_str();
        return mGl.CreateShaderProgramv(GL_COMPUTE_SHADER, 1, &text);
    }

    const GladGLContext& mGl;
};

struct Errors {
    double rms = 0.0;
    double exactShare = 0.0;
};

Errors errorsOf(std::span<const double> counts, std::span<const unsigned> exact) {
    Errors errors;
    for (std::size_t i = 0; i < counts.size(); ++i) {
        errors.rms +=
            std::pow(std::pow(1.0 - kSigma, counts[i]) - std::pow(1.0 - kSigma, exact[i]), 2.0);
        errors.exactShare += std::abs(counts[i] - exact[i]) < 1e-3 ? 1.0 : 0.0;
    }
    const auto count = static_cast<double>(counts.size());
    return {std::sqrt(errors.rms / count), errors.exactShare / count};
}

/// Half on leaves, half on the ground that they shade.
std::vector<reference::SurfacePoint> makePoints(const TriangleMesh& leaves, std::size_t count) {
    auto points = reference::sampleSurface(leaves, count / 2, 1);
    for (const auto& leaf : reference::sampleSurface(leaves, count / 2, 2)) {
        reference::SurfacePoint ground;
        ground.position = leaf.position - leaf.position.y / kToSun.y * kToSun;
        points.push_back(ground);
    }
    return points;
}

void printErrors(const Device& device, const TriangleMesh& leaves, const Options& options) {
    const std::uint32_t columns = options.isQuick ? 64 : 512;
    const reference::LeafRays rays(leaves);
    const auto points = makePoints(leaves, options.isQuick ? 2000 : 100'000);
    std::vector<unsigned> exact;
    for (const auto& point : points)
        exact.push_back(rays.between(point, 30.0 * kToSun));
    const MeshBuffers buffers = check(MeshBuffers::upload(device, leaves));
    const GeometrySource sources[] = {buffers.view()};
    TransmittanceCasters casters;
    casters.leaves = sources;
    casters.bounds = leaves.bounds();
    const Prober prober(device.state()->gl);

    std::printf(
        "\nError of transmittance, sigma %.1f: %zu leaf triangles, %u x %u columns, %zu leaf "
        "and ground points\n"
        "ranges   slices |    RMS error                |  points with the exact count\n"
        "                |  ideal   sampled   linear   |  ideal    sampled\n",
        kSigma, leaves.triangles.size(), columns, columns, points.size());
    for (const bool isLocal : {false, true})
        for (const std::uint32_t slices : {32u, 96u, 128u, 512u, 1024u}) {
            if (options.isQuick && slices > 128)
                continue;
            const TransmittanceDesc desc = describe(columns, slices, isLocal);
            Transmittance transmittance = check(Transmittance::create(device, desc));
            check(transmittance.prepare(sun(), casters));
            const LightFaces faces = check(fitLightFaces(sun(), casters.bounds, desc.size, 1, 0.0));
            reference::IdealSlicemap slicemap(rays, faces.grids.front(), isLocal);
            std::vector<double> idealCounts;
            for (const auto& point : points)
                idealCounts.push_back(slicemap.countNearer(point.position));
            const Errors ideal = errorsOf(idealCounts, exact);
            check(transmittance.setSettings(sampledSettings()));
            const Errors sampled = errorsOf(prober.counts(transmittance, points, false), exact);
            check(transmittance.setSettings(linearSettings()));
            const Errors linear = errorsOf(prober.counts(transmittance, points, true), exact);
            std::printf("%-8s %6u | %.4f   %.4f    %.4f   | %5.1f %%   %5.1f %%\n",
                        isLocal ? "local" : "uniform", slices, ideal.rms, sampled.rms, linear.rms,
                        100.0 * ideal.exactShare, 100.0 * sampled.exactShare);
        }
}

#endif

/// Median wall times of the stages of a frame, in milliseconds.
struct FrameTimes {
    double opaque = 0.0, ranges = 0.0, slicemap = 0.0, stacking = 0.0, shading = 0.0;

    [[nodiscard]] double frame() const { return opaque + ranges + slicemap + stacking + shading; }
};

FrameTimes measure(StageClock& clock, int runs, const std::function<void()>& frame) {
    frame(); // Compiles and allocates.
    std::array<std::vector<double>, 5> times;
    for (int run = 0; run < runs; ++run) {
        clock.reset();
        frame();
        const double ranges = clock.milliseconds("lamina: column ranges");
        times[0].push_back(clock.milliseconds("lamina: light depths"));
        times[1].push_back(ranges);
        times[2].push_back(clock.milliseconds("lamina: voxelize (mrt_slicemap)") - ranges);
        times[3].push_back(clock.milliseconds("lamina: stack leaf maps"));
        times[4].push_back(clock.milliseconds("lamina: apply transmittance"));
    }
    const auto median = [runs](std::vector<double>& values) {
        std::ranges::nth_element(values, values.begin() + runs / 2);
        return values[static_cast<std::size_t>(runs) / 2];
    };
    return {median(times[0]), median(times[1]), median(times[2]), median(times[3]),
            median(times[4])};
}

/// Depths of a wavy surface through the crown, so that look-ups stop at all depths.
GLuint makeDepths(const GladGLContext& gl, std::uint32_t size) {
    std::vector<float> depths;
    for (std::uint32_t y = 0; y < size; ++y)
        for (std::uint32_t x = 0; x < size; ++x)
            depths.push_back(0.5f + 0.4f * std::sin(0.05f * static_cast<float>(x)) *
                                        std::cos(0.07f * static_cast<float>(y)));
    GLuint texture = 0;
    gl.CreateTextures(GL_TEXTURE_2D, 1, &texture);
    gl.TextureStorage2D(texture, 1, GL_R32F, static_cast<GLsizei>(size),
                        static_cast<GLsizei>(size));
    gl.TextureSubImage2D(texture, 0, 0, 0, static_cast<GLsizei>(size), static_cast<GLsizei>(size),
                         GL_RED, GL_FLOAT, depths.data());
    return texture;
}

/// What is shaded, and by which casters.
struct CostScene {
    std::vector<MeshBuffers> buffers;
    std::vector<GeometrySource> leaves, wood, all;
    std::vector<Material> materials;
    TransmittanceCasters casters;
    TransmittanceReceiver receiver;
};

/// Leaves in three parts of a class each.
CostScene makeCostScene(const Device& device, const example::Tree& tree, std::uint32_t size) {
    CostScene scene;
    constexpr std::uint32_t kParts = 3;
    scene.materials.resize(kParts + 1);
    for (std::uint32_t part = 0; part < kParts; ++part) {
        TriangleMesh mesh;
        mesh.positions = tree.leaves.positions;
        for (std::size_t i = part; i < tree.leaves.triangles.size(); i += kParts)
            mesh.triangles.push_back(tree.leaves.triangles[i]);
        scene.buffers.push_back(check(MeshBuffers::upload(device, mesh)));
        MeshView view = scene.buffers.back().view();
        view.materialId = part;
        scene.materials[part].colorClass = part;
        scene.leaves.emplace_back(view);
    }
    scene.buffers.push_back(check(MeshBuffers::upload(device, tree.wood)));
    scene.wood.emplace_back(scene.buffers.back().view());
    scene.all = scene.leaves;
    scene.all.push_back(scene.wood.front());
    scene.casters.bounds = tree.leaves.bounds();
    scene.casters.bounds.extend(tree.wood.bounds().min);
    scene.casters.bounds.extend(tree.wood.bounds().max);
    scene.casters.leaves = scene.leaves;
    scene.casters.opaque = scene.wood;
    scene.casters.materials = scene.materials;

    scene.receiver.depthTexture = makeDepths(device.state()->gl, size);
    scene.receiver.view.size = {size, size};
    const glm::dvec3 center = scene.casters.bounds.center();
    scene.receiver.view.worldToClip = glm::ortho(-3.0, 3.0, -3.0, 3.0, 0.0, 8.0) *
                                      glm::lookAt(center + glm::dvec3(0, 4, 0), center, {0, 0, 1});
    return scene;
}

FrameTimes timeFrame(const Device& device, StageClock& clock, const CostScene& scene,
                     const TransmittanceCasters& casters, const TransmittanceDesc& desc,
                     const TransmittanceLight& light, const TransmittanceSettings& settings,
                     int runs) {
    Transmittance transmittance = check(Transmittance::create(device, desc));
    check(transmittance.setSettings(settings));
    return measure(clock, runs, [&] {
        check(transmittance.prepare(light, casters));
        check(transmittance.apply(scene.receiver));
    });
}

void printTimes(const char* name, const FrameTimes& times) {
    std::printf("%-26s | %10.2f %9.2f %9.2f %9.2f %9.2f %9.2f\n", name, times.opaque, times.ranges,
                times.slicemap, times.stacking, times.shading, times.frame());
}

/// [ED06] Table 1 anew. Near and far are made in one pass.
void printCosts(const Device& device, StageClock& clock, const example::Tree& tree,
                const Options& options) {
    const std::uint32_t size = options.isQuick ? 64 : 512;
    const int runs = options.isQuick ? 1 : 9;
    const CostScene scene = makeCostScene(device, tree, size);
    const auto printHead = [](const char* what) {
        std::printf("%-26s | %10s %9s %9s %9s %9s %9s\n", what, "opaque map", "near, far",
                    "slicemap", "stacking", "shading", "frame");
    };
    std::printf("\nCost in ms, medians of %d: %zu leaf and %zu wood triangles, %u x %u columns and "
                "pixels\n",
                runs, tree.leaves.triangles.size(), tree.wood.triangles.size(), size, size);
    printHead("");
    TransmittanceCasters opaque = scene.casters;
    opaque.leaves = {};
    opaque.opaque = scene.all;
    FrameTimes plain = timeFrame(device, clock, scene, opaque, describe(size, 8, false), sun(),
                                 linearSettings(), runs);
    plain.slicemap = 0.0; // Empty, and no part of shadow mapping.
    printTimes("plain shadow map", plain);
    char name[64];
    for (const SliceLookup lookup : {SliceLookup::Sampled, SliceLookup::Linear}) {
        const bool isSampled = lookup == SliceLookup::Sampled;
        printHead(isSampled ? "sampled look-ups" : "linear, filtered look-ups");
        for (const std::uint32_t targets : {1u, 2u, 3u, 8u})
            for (const bool isLocal : {false, true}) {
                if (options.isQuick && targets > 1)
                    continue;
                const std::uint32_t slices = 128 * targets;
                std::snprintf(name, sizeof name, "%s, %u target%s, %u",
                              isLocal ? "local" : "uniform", targets, targets > 1 ? "s" : "",
                              slices);
                printTimes(name, timeFrame(device, clock, scene, scene.casters,
                                           describe(size, slices, isLocal), sun(),
                                           isSampled ? sampledSettings() : linearSettings(), runs));
            }
    }
    printHead("local, 128 slices");
    TransmittanceLight lamp;
    lamp.kind = LightKind::Point;
    lamp.position = scene.casters.bounds.center();
    for (const std::uint32_t faces : {1u, 6u})
        for (const std::uint32_t classes : {1u, 3u}) {
            TransmittanceDesc desc = describe(size, 128, true);
            desc.maxFaces = faces;
            desc.classes = classes;
            std::snprintf(name, sizeof name, "%s, %u class%s", faces == 1 ? "sun" : "lamp, 6 faces",
                          classes, classes > 1 ? "es" : "");
            printTimes(name, timeFrame(device, clock, scene, scene.casters, desc,
                                       faces == 1 ? sun() : lamp, linearSettings(), runs));
        }
    device.state()->gl.DeleteTextures(1, &scene.receiver.depthTexture);
}

} // namespace

int main(int argc, char** argv) {
    Options options;
    for (int i = 1; i < argc; ++i) {
        const std::string_view argument = argv[i];
        if (argument == "--context=egl")
            options.api = headless::ContextApi::Egl;
        else if (argument == "--context=osmesa")
            options.api = headless::ContextApi::OsMesa;
        else if (argument == "--quick")
            options.isQuick = true;
        else if (argument != "--context=auto") {
            std::fprintf(stderr, "usage: lamina_transmittance_table [--context=auto|egl|osmesa] "
                                 "[--quick]\n");
            return 2;
        }
    }
    const headless::Context context = check(headless::Context::create({.api = options.api}));
    StageClock clock([&](const char* name) { return context.getProcAddress(name); });
    const Device device = check(Device::fromCurrentContext(clock.loader()));
    std::printf("%s%s\n", device.info().renderer.c_str(),
                device.info().isSoftware ? " [software: runs on the CPU]" : "");
    const example::Tree chestnut = options.isQuick
                                       ? example::makeTree(example::TreeDesc{.leavesPerTwig = 10})
                                       : example::makeChestnut();
#ifdef LAMINA_HAS_EMBREE
    printErrors(
        device,
        example::makeTree(example::TreeDesc{.leavesPerTwig = 42, .leafLength = 0.13f}).leaves,
        options);
    if (!options.isQuick)
        printErrors(device, chestnut.leaves, options);
#else
    std::printf("No errors without ray casting: built without Embree 3 (libembree-dev)\n");
#endif
    printCosts(device, clock, chestnut, options);
    return 0;
}
