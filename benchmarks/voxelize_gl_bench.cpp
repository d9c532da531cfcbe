#include "bench_case.hpp"
#include "gl_timing.hpp"

#include <lamina/voxelize/voxelizer.hpp>

namespace lamina::bench {
namespace {

Result<void> run(benchmark::State& state, const Device& device, const TriangleMesh& mesh,
                 const GridTransform& transform, Coverage coverage) {
    auto voxelizer = Voxelizer::create(device, {.coverage = coverage});
    if (!voxelizer)
        return voxelizer.error();
    auto buffers = MeshBuffers::upload(device, mesh);
    if (!buffers)
        return buffers.error();
    auto grid = VoxelGrid::create(device);
    if (!grid)
        return grid.error();
    const GeometrySource sources[] = {buffers->view()};

    VoxelizeStats stats;
    auto measured = measure(state, device, [&]() -> Result<void> {
        auto done = (*voxelizer)->voxelize(sources, transform, *grid);
        if (!done)
            return done.error();
        stats = *done;
        return {};
    });
    if (!measured)
        return measured.error();

    auto bits = grid->download();
    if (!bits)
        return bits.error();
    report(state, mesh, transform, bits->count(), grid->gpuBytes());
    state.counters["passes"] = stats.passes;
    return {};
}

void registerRun(const Device& device, const std::string& name, std::shared_ptr<NamedMesh> mesh,
                 Coverage coverage,
                 std::function<Result<GridTransform>(const TriangleMesh&)> makeGrid) {
    registerGl(name, [=, &device](benchmark::State& state) -> Result<void> {
        auto loaded = mesh->get();
        if (!loaded)
            return loaded.error();
        auto transform = makeGrid(**loaded);
        if (!transform)
            return transform.error();
        return run(state, device, **loaded, *transform, coverage);
    });
}

} // namespace

void registerVoxelizers(const Device& device, const Case& what) {
    struct Row {
        const char* name;
        Coverage coverage;
    };
    for (const Row& row :
         {Row{"slicemap filled", Coverage::Filled}, Row{"slicemap sampled", Coverage::Sampled},
          Row{"overlap conservative", Coverage::Conservative},
          Row{"overlap separating6", Coverage::Separating6}, Row{"overlap solid", Coverage::Solid}})
        registerRun(device, what.describe() + "/lamina " + row.name, what.mesh, row.coverage,
                    [resolution = what.resolution](const TriangleMesh& mesh) {
                        return benchGrid(mesh, resolution);
                    });
}

void registerSlicemapPasses(const Device& device, const std::shared_ptr<NamedMesh>& mesh) {
    constexpr std::uint32_t kColumns = 512;
    for (const std::uint32_t slices : {128u, 256u, 512u, 1024u})
        registerRun(device,
                    mesh->name + "/512x512 columns/lamina slicemap filled, " +
                        std::to_string(slices) + " slices",
                    mesh, Coverage::Filled, [slices](const TriangleMesh& loaded) {
                        return GridTransform::box(loaded.bounds(), {kColumns, kColumns, slices});
                    });
}

} // namespace lamina::bench
