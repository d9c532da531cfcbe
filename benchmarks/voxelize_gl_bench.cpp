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
    registerMethod(name, [=, &device](benchmark::State& state) -> Result<void> {
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
        {Backend::MrtSlicemap, Coverage::Filled},
        {Backend::MrtSlicemap, Coverage::Sampled},
        {Backend::MrtSlicemap, Coverage::Conservative},
        {Backend::MrtSlicemap, Coverage::Solid},
        {Backend::Overlap, Coverage::Conservative},
        {Backend::Overlap, Coverage::Separating6},
        {Backend::Overlap, Coverage::Solid},
        {.backend = Backend::Overlap, .coverage = Coverage::Solid, .solidRule = SolidRule::Voted},
        {.backend = Backend::Overlap,
         .coverage = Coverage::Solid,
         .solidRule = SolidRule::FloodFill}};
    for (const VoxelizerDesc& row : kRows)
        registerRun(
            device,
            what.describe() + "/lamina " + std::string(name(row.backend)) + " " +
                std::string(name(row.coverage)) +
                (row.solidRule == SolidRule::Parity ? "" : " " + std::string(name(row.solidRule))),
            what.mesh, row, [resolution = what.resolution](const TriangleMesh& mesh) {
                return benchGrid(mesh, resolution);
            });
}

void registerSlicemaps(const Device& device, const std::shared_ptr<NamedMesh>& mesh) {
    constexpr std::uint32_t kColumns = 1024;
    struct Row {
        const char* name;
        std::uint32_t slices;
        VoxelizerDesc desc;
    };
    const auto mrt = [](VoxelStore store, bool localRanges = false) {
        return VoxelizerDesc{Backend::MrtSlicemap, Coverage::Sampled, localRanges, store};
    };
    const Row rows[] = {
        {"slicemap 128", 128, {Backend::Slicemap}},
        {"mrt_slicemap atomics 128", 128, mrt(VoxelStore::Buffer)},
        {"slicemap 1024 in 8 passes", 1024, {Backend::Slicemap}},
        {"mrt_slicemap targets 1024", 1024, mrt(VoxelStore::Texture)},
        {"mrt_slicemap atomics 1024", 1024, mrt(VoxelStore::Buffer)},
        {"local_slicemap 128", 128, {Backend::LocalSlicemap}},
        {"mrt_slicemap targets local 1024", 1024, mrt(VoxelStore::Texture, true)},
        {"mrt_slicemap atomics local 1024", 1024, mrt(VoxelStore::Buffer, true)},
    };
    for (const Coverage coverage : {Coverage::Sampled, Coverage::Filled})
        for (const Row& row : rows) {
            VoxelizerDesc desc = row.desc;
            desc.coverage = coverage;
            registerRun(
                device,
                mesh->name + "/1024x1024 columns, " + std::string(name(coverage)) + "/" + row.name,
                mesh, desc, [slices = row.slices](const TriangleMesh& loaded) {
                    return GridTransform::box(loaded.bounds(), {kColumns, kColumns, slices});
                });
        }
}

} // namespace lamina::bench
