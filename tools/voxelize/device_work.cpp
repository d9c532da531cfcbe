#include "device_work.hpp"

#include "failure.hpp"
#include "open_device.hpp"

#include <lamina/grid/voxel_grid.hpp>
#include <lamina/voxelize/geometry_source.hpp>

#include <array>

namespace lamina::tool {

BitGrid voxelizeOnDevice(const Request& request, TriangleMesh mesh, StageClock& clock,
                         RunRecord& record) {
    const GridPlan& plan = *record.grid;
    const GridTransform transform =
        require(GridTransform::box(plan.bounds, plan.counts, plan.axis));
    const OpenDevice open = openDevice(request, clock, record);

    const auto voxelizer = clock.run("programs", "building programs", [&] {
        return require(Voxelizer::create(open.device, {request.backend, request.coverage}));
    });
    const MeshBuffers buffers = clock.run("upload", "uploading the mesh", [&] {
        MeshBuffers uploaded = require(MeshBuffers::upload(open.device, mesh));
        open.wait();
        return uploaded;
    });
    mesh = {};

    VoxelGrid grid = require(VoxelGrid::create(open.device));
    const VoxelizeStats stats = clock.run("voxelize", "voxelizing", [&] {
        const std::array<GeometrySource, 1> sources{buffers.view()};
        const VoxelizeStats done = require(voxelizer->voxelize(sources, transform, grid));
        open.wait();
        return done;
    });
    BitGrid bits =
        clock.run("download", "reading voxels back", [&] { return require(grid.download()); });

    record.voxels = VoxelFacts{std::string(name(voxelizer->backend())),
                               voxelizer->reason(),
                               std::string(name(request.coverage)),
                               stats.passes,
                               stats.gridBytes,
                               bits.count(),
                               std::nullopt};
    if (request.coverage == Coverage::Solid)
        record.voxels->oddColumns = require(voxelizer->downloadSolidReport()).oddColumns;
    return bits;
}

} // namespace lamina::tool
