#include "device_work.hpp"

#include "failure.hpp"
#include "open_device.hpp"

#include <lamina/grid/voxel_grid.hpp>
#include <lamina/voxelize/attribute_voxelizer.hpp>
#include <lamina/voxelize/geometry_source.hpp>

#include <array>

namespace lamina::tool {
namespace {

/// The rule that the command line names, else the one that fits the mesh. Other backends than
/// overlap know none but parity.
SolidRule chooseSolidRule(const Request& request, const MeshFacts& mesh) {
    if (request.solidRule)
        return *request.solidRule;
    const bool isPlain = fittingSolidRule(mesh) == SolidRule::Parity;
    const bool canVote =
        request.backend == Backend::Automatic || request.backend == Backend::Overlap;
    return isPlain || !canVote ? SolidRule::Parity : SolidRule::Voted;
}

/// The attributes of the set voxels of `grid`.
AttributeGrid recordAttributes(const OpenDevice& open, const MeshBuffers& mesh,
                               const VoxelGrid& grid, const AttributeRequest& wanted,
                               StageClock& clock) {
    auto voxelizer = require(AttributeVoxelizer::create(open.device));
    auto attributes = require(VoxelAttributes::create(open.device));
    clock.run("attributes", "recording colours and normals", [&] {
        const std::array<GeometrySource, 1> sources{mesh.view()};
        (void)require(voxelizer.voxelize(sources, {}, grid, attributes));
        open.wait();
    });
    return clock.run("download", "reading attributes back", [&] {
        AttributeGrid host = require(attributes.download());
        if (!wanted.color)
            host.colors = {};
        if (!wanted.normal)
            host.normals = {};
        return host;
    });
}

} // namespace

SolidRule fittingSolidRule(const MeshFacts& mesh) {
    const bool isPlain = mesh.report && mesh.report->watertight() && mesh.report->components == 1;
    return isPlain ? SolidRule::Parity : SolidRule::Voted;
}

Voxels voxelizeOnDevice(const Request& request, const AttributeRequest& wanted, TriangleMesh mesh,
                        StageClock& clock, RunRecord& record) {
    const GridPlan& plan = *record.grid;
    const GridTransform transform =
        require(GridTransform::box(plan.bounds, plan.counts, plan.axis));
    const OpenDevice open = openDevice(request, clock, record);

    const SolidRule rule = chooseSolidRule(request, record.mesh);
    const auto voxelizer = clock.run("programs", "building programs", [&] {
        return require(Voxelizer::create(
            open.device,
            {.backend = request.backend, .coverage = request.coverage, .solidRule = rule}));
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
        clock.run("download", "reading voxels back", [&] { return downloadUniform(grid); });

    record.voxels = VoxelFacts{std::string(name(voxelizer->backend())),
                               voxelizer->reason(),
                               std::string(name(request.coverage)),
                               stats.passes,
                               stats.gridBytes,
                               bits.count(),
                               false,
                               false,
                               std::nullopt};
    if (request.coverage == Coverage::Solid)
        record.voxels->solid =
            SolidFacts{rule, !request.solidRule, require(voxelizer->downloadSolidReport())};
    if (!wanted.color && !wanted.normal)
        return {std::move(bits), std::nullopt};
    // Until now their number was an estimate.
    checkMemory(plan, static_cast<double>(record.voxels->set), request.memoryLimitBytes);
    if (grid.hasLocalRanges()) // Attributes are those of the voxels that the files hold.
        require(grid.upload(bits));
    record.voxels->hasColors = wanted.color;
    record.voxels->hasNormals = wanted.normal;
    AttributeGrid attributes = recordAttributes(open, buffers, grid, wanted, clock);
    if (request.coverage == Coverage::Solid && wanted.color)
        clock.run("attributes", "colouring the inside", [&] {
            require(spreadColors(bits, attributes));
            attributes.hits = {}; // Files are without what is known to have none.
        });
    return {std::move(bits), std::move(attributes)};
}

} // namespace lamina::tool
