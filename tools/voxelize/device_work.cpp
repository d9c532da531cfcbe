#include "device_work.hpp"

#include "choices.hpp"
#include "failure.hpp"

#include <lamina/gl/device.hpp>
#include <lamina/grid/voxel_grid.hpp>
#include <lamina/voxelize/geometry_source.hpp>

#include <fmt/format.h>

#include <array>
#include <utility>

namespace lamina::tool {
namespace {

headless::Context createContext(const Request& request) {
    headless::ContextDesc desc;
    desc.api = request.context;
    return require(headless::Context::create(desc));
}

DeviceDesc deviceDesc(const Request& request, StageClock& clock) {
    DeviceDesc desc;
    desc.memoryBudgetBytes = static_cast<std::uint64_t>(request.memoryLimitBytes);
    if (request.verbose)
        desc.message = [&clock](const Message& message) {
            clock.finish();
            fmt::print(stderr, "{} {}\n",
                       message.severity == MessageSeverity::Warning ? "warning  " : "note     ",
                       message.text);
        };
    return desc;
}

/// Waits for the GPU, so that the time of a stage is what it cost.
void wait(const headless::Context& context) {
    reinterpret_cast<void (*)()>(context.getProcAddress("glFinish"))();
}

} // namespace

BitGrid voxelizeOnDevice(const Request& request, TriangleMesh mesh, StageClock& clock,
                         RunRecord& record) {
    const GridPlan& plan = *record.grid;
    const GridTransform transform =
        require(GridTransform::box(plan.bounds, plan.counts, plan.axis));

    const headless::Context context =
        clock.run("context", "creating a GL context", [&] { return createContext(request); });
    const Device device = require(Device::fromCurrentContext(
        [&context](const char* name) { return context.getProcAddress(name); },
        deviceDesc(request, clock)));
    record.renderer = RendererFacts{context.info(),
                                    {context.attempts().begin(), context.attempts().end()},
                                    device.info().isSoftware};

    const auto voxelizer = clock.run("programs", "building programs", [&] {
        return require(Voxelizer::create(device, {request.backend, request.coverage}));
    });
    const MeshBuffers buffers = clock.run("upload", "uploading the mesh", [&] {
        MeshBuffers uploaded = require(MeshBuffers::upload(device, mesh));
        wait(context);
        return uploaded;
    });
    mesh = {};

    VoxelGrid grid = require(VoxelGrid::create(device));
    const VoxelizeStats stats = clock.run("voxelize", "voxelizing", [&] {
        const std::array<GeometrySource, 1> sources{buffers.view()};
        const VoxelizeStats done = require(voxelizer->voxelize(sources, transform, grid));
        wait(context);
        return done;
    });
    BitGrid bits =
        clock.run("download", "reading voxels back", [&] { return require(grid.download()); });

    record.voxels = VoxelFacts{std::string(name(voxelizer->backend())),
                               voxelizer->reason(),
                               std::string(name(request.coverage)),
                               stats.passes,
                               stats.gridBytes,
                               bits.count()};
    return bits;
}

} // namespace lamina::tool
