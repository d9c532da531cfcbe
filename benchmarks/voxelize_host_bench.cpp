#include "bench_case.hpp"

#include <reference/overlap.hpp>

#include <algorithm>

namespace lamina::bench {
namespace {

constexpr unsigned kThreads = 2;

Result<void> run(benchmark::State& state, const Case& what) {
    auto mesh = what.mesh->get();
    if (!mesh)
        return mesh.error();
    auto transform = benchGrid(**mesh, what.resolution);
    if (!transform)
        return transform.error();
    auto grid = BitGrid::create(*transform);
    if (!grid)
        return grid.error();

    Result<void> added;
    for ([[maybe_unused]] auto iteration : state) {
        std::ranges::fill(grid->words(), 0u);
        added =
            reference::addOverlap<float>(*grid, **mesh, reference::VoxelShape::Cube, {}, kThreads);
    }
    if (!added)
        return added.error();
    report(state, **mesh, *transform, grid->count(), grid->words().size_bytes());
    return {};
}

} // namespace

void registerHostOverlap(const Case& what) {
    registerMethod(what.describe() + "/host overlap, 2 threads",
                   [what](benchmark::State& state) { return run(state, what); });
}

} // namespace lamina::bench
