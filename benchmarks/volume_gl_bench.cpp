#include "bench_case.hpp"
#include "gl_timing.hpp"
#include "uploaded_mesh.hpp"

#include <lamina/voxelize/geometry_source.hpp>
#include <lamina/voxelize/volume_voxelizer.hpp>

#include <algorithm>

namespace lamina::bench {
namespace {

struct Row {
    const char* name;
    VolumeLayout layout;
};

VolumeLayout layoutOf(VolumeFormat count, VolumeFormat normal, VolumeFormat color) {
    VolumeLayout layout;
    layout.count = count;
    layout.normal = normal;
    layout.color = color;
    return layout;
}

Result<void> run(benchmark::State& state, const Device& device, const Case& what,
                 const VolumeLayout& layout) {
    auto uploaded = upload(device, what);
    auto voxelizer = VolumeVoxelizer::create(device);
    auto volume = VolumeGrid::create(device, layout);
    if (!uploaded)
        return uploaded.error();
    if (!voxelizer)
        return voxelizer.error();
    if (!volume)
        return volume.error();
    VolumeStats stats;
    auto measured = measure(state, device, [&]() -> Result<void> {
        auto done = voxelizer->voxelize({&uploaded->source, 1}, {}, uploaded->transform, *volume);
        if (!done)
            return done.error();
        stats = *done;
        return {};
    });
    if (!measured)
        return measured;
    auto data = volume->download();
    if (!data)
        return data.error();
    const auto set = std::ranges::count_if(data->counts, [](std::uint32_t n) { return n != 0; });
    report(state, *uploaded->mesh, uploaded->transform, static_cast<std::uint64_t>(set),
           stats.volumeBytes);
    state.counters["passes"] = stats.passes;
    return {};
}

} // namespace

void registerVolumes(const Device& device, const Case& what) {
    using enum VolumeFormat;
    for (const Row& row : {Row{"count R8", layoutOf(R8, None, None)},
                           Row{"count R32UI", layoutOf(R32UI, None, None)},
                           Row{"count, normal, colour", layoutOf(R32UI, RGBA16F, RGBA8)}})
        registerMethod(what.describe() + "/lamina volume " + row.name,
                       [=, &device, layout = row.layout](benchmark::State& state) {
                           return run(state, device, what, layout);
                       });
}

} // namespace lamina::bench
