#include "bench_case.hpp"
#include "gl_timing.hpp"
#include "uploaded_mesh.hpp"

#include <lamina/voxelize/attribute_voxelizer.hpp>
#include <lamina/voxelize/voxelizer.hpp>

namespace lamina::bench {
namespace {

/// Colours and normals of the conservative voxels, which are made once.
Result<void> run(benchmark::State& state, const Device& device, const Case& what) {
    auto uploaded = upload(device, what);
    auto voxelizer = Voxelizer::create(device, {.coverage = Coverage::Conservative});
    auto attributeVoxelizer = AttributeVoxelizer::create(device);
    auto voxels = VoxelGrid::create(device);
    auto attributes = VoxelAttributes::create(device);
    if (!uploaded)
        return uploaded.error();
    if (!voxelizer)
        return voxelizer.error();
    if (!attributeVoxelizer)
        return attributeVoxelizer.error();
    if (!voxels)
        return voxels.error();
    if (!attributes)
        return attributes.error();
    const std::span<const GeometrySource> sources(&uploaded->source, 1);
    if (auto made = (*voxelizer)->voxelize(sources, uploaded->transform, *voxels); !made)
        return made.error();
    AttributeStats stats;
    auto measured = measure(state, device, [&]() -> Result<void> {
        auto done = attributeVoxelizer->voxelize(sources, {}, *voxels, *attributes);
        if (!done)
            return done.error();
        stats = *done;
        return {};
    });
    if (!measured)
        return measured;
    report(state, *uploaded->mesh, uploaded->transform, stats.voxels, stats.attributeBytes);
    state.counters["passes"] = stats.passes;
    return {};
}

} // namespace

void registerAttributes(const Device& device, const Case& what) {
    registerMethod(what.describe() + "/lamina attributes",
                   [=, &device](benchmark::State& state) { return run(state, device, what); });
}

} // namespace lamina::bench
