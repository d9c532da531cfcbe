#include "bench_case.hpp"
#include "gl_timing.hpp"

#include <lamina/voxelize/attribute_voxelizer.hpp>
#include <lamina/voxelize/voxelizer.hpp>

namespace lamina::bench {
namespace {

/// Colours and normals of the conservative voxels, which are made once.
Result<void> run(benchmark::State& state, const Device& device, const Case& what) {
    auto mesh = what.mesh->get();
    if (!mesh)
        return mesh.error();
    auto transform = benchGrid(**mesh, what.resolution);
    auto voxelizer = Voxelizer::create(device, {.coverage = Coverage::Conservative});
    auto attributeVoxelizer = AttributeVoxelizer::create(device);
    auto buffers = MeshBuffers::upload(device, **mesh);
    auto voxels = VoxelGrid::create(device);
    auto attributes = VoxelAttributes::create(device);
    if (!transform)
        return transform.error();
    if (!voxelizer)
        return voxelizer.error();
    if (!attributeVoxelizer)
        return attributeVoxelizer.error();
    if (!buffers)
        return buffers.error();
    if (!voxels)
        return voxels.error();
    if (!attributes)
        return attributes.error();
    const GeometrySource sources[] = {buffers->view()};
    if (auto made = (*voxelizer)->voxelize(sources, *transform, *voxels); !made)
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
    report(state, **mesh, *transform, stats.voxels, stats.attributeBytes);
    state.counters["passes"] = stats.passes;
    return {};
}

} // namespace

void registerAttributes(const Device& device, const Case& what) {
    registerGl(what.describe() + "/lamina attributes",
               [=, &device](benchmark::State& state) { return run(state, device, what); });
}

} // namespace lamina::bench
