#include "bench_case.hpp"
#include "table_reporter.hpp"

#include <lamina/core/version.hpp>
#include <lamina/headless/context.hpp>

#include <cstdio>
#include <optional>
#include <string_view>

namespace {

using namespace lamina;

constexpr const char* kUsage =
    "usage: lamina_bench [--context=auto|egl|osmesa] [--benchmark_filter=REGEX] [--benchmark_...]\n"
    "Names are mesh/resolution/method. LAMINA_MESH_DIR names a folder of more meshes.\n"
    "Prints a table; --benchmark_format=console|json|csv prints Google Benchmark's own formats.\n";

/// Takes `--context=...` out of the arguments.
std::optional<headless::ContextApi> takeContext(int& argc, char** argv) {
    auto api = std::optional(headless::ContextApi::Automatic);
    int kept = 1;
    for (int i = 1; i < argc; ++i) {
        const std::string_view argument = argv[i];
        if (!argument.starts_with("--context=")) {
            argv[kept++] = argv[i];
            continue;
        }
        const std::string_view word = argument.substr(argument.find('=') + 1);
        if (word == "egl")
            api = headless::ContextApi::Egl;
        else if (word == "osmesa")
            api = headless::ContextApi::OsMesa;
        else if (word != "auto")
            api.reset();
    }
    argc = kept;
    return api;
}

bool asksForOwnFormat(int argc, char** argv) {
    for (int i = 1; i < argc; ++i)
        if (std::string_view(argv[i]).starts_with("--benchmark_format="))
            return true;
    return false;
}

void nameDevice(const headless::Context& context, const Device& device) {
    const DeviceInfo& info = device.info();
    benchmark::AddCustomContext("lamina", LAMINA_VERSION_STRING);
    benchmark::AddCustomContext("context", context.info().kind);
    benchmark::AddCustomContext(
        "renderer", info.renderer + (info.isSoftware ? " [software: runs on the CPU]" : ""));
    benchmark::AddCustomContext("GL version", info.version);
}

void registerAll(const Device& device) {
    const auto meshes = bench::benchMeshes();
    for (const auto& mesh : meshes)
        for (const std::uint32_t resolution : {128u, 256u, 512u, 1024u}) {
            const bench::Case what{mesh, resolution};
            bench::registerVoxelizers(device, what);
            bench::registerAttributes(device, what);
            bench::registerHostOverlap(what);
            if (resolution <= 256)
                bench::registerVolumes(device, what);
#if defined(LAMINA_HAS_OPENVDB)
            bench::registerOpenVdb(what);
#endif
        }
    for (const auto& mesh : meshes)
        if (mesh->name == "knot_100k" || mesh->name == "armadillo") {
            bench::registerSlicemaps(device, mesh);
            bench::registerRanges(device, mesh);
#if defined(LAMINA_HAS_REFRACTION)
            bench::registerRefraction(device, mesh);
#endif
        }
    for (const auto& mesh : meshes)
        if (mesh->name == "knot_100k")
            bench::registerEpipolar(device, mesh);
    for (const auto& mesh : bench::scalingMeshes())
        for (const std::uint32_t resolution : {64u, 128u, 256u, 512u, 1024u})
            bench::registerVoxelizers(device, {mesh, resolution});
}

int run(int argc, char** argv) {
    const auto api = takeContext(argc, argv);
    const bool table = !asksForOwnFormat(argc, argv);
    benchmark::Initialize(&argc, argv);
    if (!api || argc > 1) {
        std::fputs(kUsage, stderr);
        return 2;
    }
    headless::ContextDesc desc;
    desc.api = *api;
    auto context = headless::Context::create(desc);
    if (!context) {
        std::fprintf(stderr, "%s\n", context.error().text.c_str());
        return 1;
    }
    auto device =
        Device::fromCurrentContext([&](const char* name) { return context->getProcAddress(name); });
    if (!device) {
        std::fprintf(stderr, "%s\n", device.error().text.c_str());
        return 1;
    }
    nameDevice(*context, *device);
    registerAll(*device);
    bench::TableReporter reporter;
    const std::size_t count = benchmark::RunSpecifiedBenchmarks(table ? &reporter : nullptr);
    benchmark::Shutdown();
    return count > 0 && !reporter.failed() ? 0 : 1;
}

} // namespace

int main(int argc, char** argv) {
    return run(argc, argv);
}
