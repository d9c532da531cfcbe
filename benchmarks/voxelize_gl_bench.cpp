#include "bench_case.hpp"
#include "gl_timing.hpp"

#include <lamina/voxelize/voxelizer.hpp>

namespace lamina::bench {
namespace {

Result<void> run(benchmark::State& state, const Device& device, const TriangleMesh& mesh,
                 const GridTransform& transform, const VoxelizerDesc& desc) {
    auto voxelizer = Voxelizer::create(device, desc);
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
                 const VoxelizerDesc& desc,
                 std::function<Result<GridTransform>(const TriangleMesh&)> makeGrid) {
    registerGl(name, [=, &device](benchmark::State& state) -> Result<void> {
        auto loaded = mesh->get();
        if (!loaded)
            return loaded.error();
        auto transform = makeGrid(**loaded);
        if (!transform)
            return transform.error();
        return run(state, device, **loaded, *transform, desc);
    });
}

} // namespace

void registerVoxelizers(const Device& device, const Case& what) {
    constexpr VoxelizerDesc kRows[] = {
        {Backend::Slicemap, Coverage::Filled},       {Backend::Slicemap, Coverage::Sampled},
        {Backend::Slicemap, Coverage::Conservative}, {Backend::Slicemap, Coverage::Solid},
        {Backend::Overlap, Coverage::Conservative},  {Backend::Overlap, Coverage::Separating6},
        {Backend::Overlap, Coverage::Solid}};
    for (const VoxelizerDesc& row : kRows)
        registerRun(device,
                    what.describe() + "/lamina " + std::string(name(row.backend)) + " " +
                        std::string(name(row.coverage)),
                    what.mesh, row, [resolution = what.resolution](const TriangleMesh& mesh) {
                        return benchGrid(mesh, resolution);
                    });
}

void registerSlicemapPasses(const Device& device, const std::shared_ptr<NamedMesh>& mesh) {
    constexpr std::uint32_t kColumns = 512;
    for (const std::uint32_t slices : {128u, 256u, 512u, 1024u})
        registerRun(device,
                    mesh->name + "/512x512 columns/lamina slicemap filled, " +
                        std::to_string(slices) + " slices",
                    mesh, {Backend::Slicemap, Coverage::Filled},
                    [slices](const TriangleMesh& loaded) {
                        return GridTransform::box(loaded.bounds(), {kColumns, kColumns, slices});
                    });
}

} // namespace lamina::bench
