// lamina_parity_bench: the figures of depth sprites, each table measured in one run.
//   1. building: single pass against depth peeling;
//   2. accuracy: share of wrong points by columns, one direction and three, and what each costs;
//   3. clipping: a frame clipped by two sprites against the same frame without ([TD08] Table 1).
#include "parity_bench.hpp"
#include "bench_case.hpp"

#include <lamina/headless/context.hpp>

#include <reference/shapes.hpp>

#include <string_view>

namespace lamina::bench {
namespace {

std::vector<Shape> shapes() {
    const float radii[] = {1.0f, 0.8f, 0.5f, 0.3f};
    std::vector<Shape> all = {
        {"torus knot", reference::makeTorusKnot({}, 0.55f, 0.12f, 2, 3, 512, 32)},
        {"menger sponge", reference::makeMengerSponge({0.01f, 0.02f, 0.03f}, 1.8f, 3)},
        {"nested shells", reference::makeNestedShells({}, radii, 4)},
    };
    for (const auto& mesh : benchMeshes())
        if (mesh->name == "glmark2_bunny" || mesh->name == "armadillo")
            all.push_back({mesh->name, *need(mesh->get())});
    return all;
}

int run(std::string_view which, bool quick) {
    headless::ContextDesc desc;
    const auto context = need(headless::Context::create(desc));
    const Device device = need(
        Device::fromCurrentContext([&](const char* name) { return context.getProcAddress(name); }));
    std::printf("%s%s\n", device.info().renderer.c_str(),
                device.info().isSoftware ? " [software: runs on the CPU]" : "");
    std::vector<Shape> meshes = shapes();
    if (quick)
        meshes.resize(1);
    const int rounds = quick ? 1 : 5;
    if (which == "build" || which == "all")
        printBuilding(device, meshes, rounds);
    if (which == "accuracy" || which == "all")
        printAccuracy(device, meshes, quick ? 10000 : 1000000);
    if (which == "variants" || which == "all")
        printVariants(device, meshes, quick ? 10000 : 1000000, rounds);
    if (which == "clip" || which == "all")
        printClipping(device, meshes.back(), rounds);
    return 0;
}

} // namespace
} // namespace lamina::bench

int main(int argc, char** argv) {
    std::string_view which = "all";
    bool quick = false;
    for (int i = 1; i < argc; ++i) {
        const std::string_view argument = argv[i];
        if (argument == "--quick")
            quick = true;
        else if (argument == "build" || argument == "accuracy" || argument == "variants" ||
                 argument == "clip" || argument == "all")
            which = argument;
        else {
            std::fputs("usage: lamina_parity_bench [all|build|accuracy|variants|clip] [--quick]\n",
                       stderr);
            return 2;
        }
    }
    return lamina::bench::run(which, quick);
}
