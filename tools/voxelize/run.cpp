#include "run.hpp"

#include "compare.hpp"
#include "device_work.hpp"
#include "failure.hpp"
#include "file_guard.hpp"
#include "output_plan.hpp"
#include "report.hpp"
#include "run_record.hpp"

#include <lamina/grid_io/atomic_file.hpp>
#include <lamina/grid_io/grid_file.hpp>
#include <lamina/grid_io/preview.hpp>
#include <lamina/mesh_io/mesh_file.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <system_error>
#include <utility>
#include <vector>

#include <unistd.h>

namespace lamina::tool {
namespace {

namespace fs = std::filesystem;

std::uint64_t fileBytes(const fs::path& file) {
    std::error_code error;
    const std::uintmax_t bytes = fs::file_size(file, error);
    return error ? 0 : bytes;
}

/// Whatever keeps the mesh from being read is the mesh file's fault, but for memory.
Failure meshFailure(const Error& error) {
    if (error.code == ErrorCode::OutOfMemory)
        return failure(error);
    return {ExitCode::BadMesh, error.text};
}

TriangleMesh loadMesh(const fs::path& file, StageClock& clock, RunRecord& record) {
    TriangleMesh mesh = clock.run("load", "reading " + file.filename().string(), [&] {
        MeshReadOptions options;
        options.computeNormals = false;
        options.progress = [&clock](float share) {
            clock.progress(share);
            return true;
        };
        auto read = readMesh(file, options);
        if (!read)
            throw meshFailure(read.error());
        return std::move(*read);
    });
    record.mesh.file = file;
    record.mesh.fileBytes = fileBytes(file);
    record.mesh.triangles = mesh.triangles.size();
    record.mesh.vertices = mesh.positions.size();
    record.mesh.bounds = mesh.bounds();
    record.mesh.hasColors = !mesh.colors.empty();
    record.mesh.hasNormals = !mesh.normals.empty();
    return mesh;
}

/// Does the file get attributes? Without being asked, no further files are made beside it.
bool takesAttributes(const Request& request, const fs::path& output) {
    const GridFormat format = *gridFormat(output);
    return holdsColors(format) && !(request.attributes.isAutomatic && format == GridFormat::Npy);
}

/// What to make: `auto` means the mesh's colours where a file or a picture shows them.
AttributeRequest wantedAttributes(const Request& request, bool meshHasColors) {
    AttributeRequest wanted = request.attributes;
    if (wanted.isAutomatic)
        wanted.color =
            meshHasColors &&
            (request.preview || std::ranges::any_of(request.outputs, [&](const fs::path& output) {
                 return takesAttributes(request, output);
             }));
    return wanted;
}

void writeVoxels(const Request& request, const Voxels& voxels, StageClock& clock,
                 RunRecord& record) {
    for (const fs::path& output : request.outputs) {
        const Stopwatch watch;
        GridWriteOptions options;
        options.up = request.up;
        if (voxels.attributes && takesAttributes(request, output))
            options.attributes = &*voxels.attributes;
        clock.run("write", "writing " + output.filename().string(), [&] {
            const FileGuard guard;
            options.progress = [&](double fraction) {
                clock.progress(fraction);
                return !guard.isSignalled();
            };
            require(writeGrid(output, voxels.bits, options));
        });
        const std::string format(name(*gridFormat(output)));
        const std::vector<fs::path> files = require(gridFiles(output, options));
        for (const fs::path& file : files)
            record.files.push_back({file, format, fileBytes(file), watch.milliseconds()});
    }
}

void writePreview(const Request& request, const Voxels& voxels, StageClock& clock,
                  RunRecord& record) {
    const PreviewRequest& preview = *request.preview;
    const Stopwatch watch;
    clock.run("preview", "drawing " + preview.file.filename().string(), [&] {
        PreviewDesc desc;
        desc.width = preview.size.x;
        desc.height = preview.size.y;
        desc.viewDirection = -preview.view;
        desc.attributes = voxels.attributes ? &*voxels.attributes : nullptr;
        desc.up = glm::dvec3(0.0);
        desc.up[static_cast<int>(request.up)] = 1.0;
        const Image image = require(renderPreview(voxels.bits, desc, [&clock](double fraction) {
            clock.progress(fraction);
            return true;
        }));
        const FileGuard guard;
        require(writePng(preview.file, image));
    });
    record.files.push_back({preview.file, "png", fileBytes(preview.file), watch.milliseconds()});
}

void printToStandardOutput(const std::string& text) {
    if (std::fwrite(text.data(), 1, text.size(), stdout) != text.size() || std::fflush(stdout) != 0)
        throw Failure(ExitCode::Failed, "standard output: the text could not be written");
}

void writeStats(const StatsRequest& stats, const RunRecord& record) {
    const std::string json = statsJson(record);
    if (stats.toStandardOutput())
        return printToStandardOutput(json);
    const FileGuard guard;
    AtomicFile file = require(AtomicFile::create(stats.file));
    require(file.write(json));
    require(file.commit());
}

/// Columns of voxels along the axis of projection.
std::uint64_t columnCount(const GridPlan& grid) {
    const glm::uvec3 axes = boxGridAxes(grid.axis);
    return std::uint64_t{grid.counts[axes.x]} * grid.counts[axes.y];
}

void warnOfAttributes(const Request& request, const RunRecord& record) {
    const AttributeRequest& asked = request.attributes;
    for (const fs::path& output : request.outputs) {
        const GridFormat format = *gridFormat(output);
        if ((asked.color && !holdsColors(format)) || (asked.normal && !holdsNormals(format)))
            fmt::print(stderr,
                       "lamina-voxelize: warning: .{} files hold no {}: {} was written without\n",
                       name(format), holdsColors(format) ? "normals" : "colours and no normals",
                       output.string());
    }
    if (asked.color && !record.mesh.hasColors)
        fmt::print(stderr, "lamina-voxelize: warning: the mesh has no colours: voxels are white\n");
}

void warn(const std::string& text) {
    fmt::print(stderr, "lamina-voxelize: warning: {}\n", text);
}

void warnOfShape(const Request& request, const GridPlan& grid) {
    const glm::dvec3& edge = grid.voxelSize;
    for (const fs::path& output : request.outputs)
        if (*gridFormat(output) == GridFormat::Vox && !isCubic(edge))
            warn(fmt::format(
                "-o {}: .vox files show cubes, --bounds and --grid give edges {:g}, "
                "{:g}, {:g}: the shape is distorted there; .vti and .vdb hold the edges",
                output.string(), edge.x, edge.y, edge.z));
}

/// What keeps a solid from being sure.
void warnAboutSolid(const Request& request, const RunRecord& record) {
    const SolidFacts& solid = *record.voxels->solid;
    const SolidReport& report = solid.report;
    const bool canVote =
        request.backend == Backend::Automatic || request.backend == Backend::Overlap;
    const std::string advice =
        canVote ? "use --solid-rule voted" : "use --backend auto --solid-rule voted";
    if (report.oddColumns > 0)
        warn(fmt::format("the mesh is not closed: {} of {} columns are crossed an odd number of "
                         "times and are filled up to their last crossing; {}",
                         report.oddColumns, columnCount(*record.grid), advice));
    if (solid.rule == SolidRule::Voted && report.doubtfulVoxels > 0)
        warn(fmt::format("{} voxels are doubtful: 5 or more of their 14 rays disagree with the "
                         "others, at holes and where triangles are wrong",
                         report.doubtfulVoxels));
    const bool isOpen = record.mesh.report && record.mesh.report->openEdges > 0;
    if (solid.rule == SolidRule::FloodFill && report.enclosedVoxels == 0)
        warn("the surface encloses nothing: it has openings wider than a voxel; " + advice);
    else if (solid.rule == SolidRule::FloodFill && isOpen)
        warn(fmt::format("the mesh is open: {} of the {} voxels are enclosed, the others touch the "
                         "surface; through openings wider than a voxel the inside is lost; {} to "
                         "compare",
                         report.enclosedVoxels, record.voxels->set, advice));
    if (!report.isFloodComplete)
        warn("the outside winds through more turns than were followed; what lies behind them is "
             "filled; " +
             advice);
}

void tell(const Request& request, const RunRecord& record) {
    if (!request.quiet)
        warnOfAttributes(request, record);
    if (!request.quiet && record.voxels && record.voxels->set == 0)
        fmt::print(
            stderr,
            "lamina-voxelize: warning: no voxel is set; the mesh lies outside the grid, or its "
            "triangles are edge-on to the axis (filled, sampled) or enclose nothing (solid)\n");
    if (!request.quiet)
        warnOfShape(request, *record.grid);
    if (!request.quiet && record.voxels && record.voxels->solid)
        warnAboutSolid(request, record);
    if (request.verbose || (!request.quiet && isatty(STDERR_FILENO) == 1))
        fmt::print(stderr, "{}", summary(record));
}

} // namespace

void run(const Request& request) {
    StageClock clock(!request.quiet);
    RunRecord record;
    checkOutputs(request);
    TriangleMesh mesh = loadMesh(request.mesh, clock, record);
    // To choose the rule, or to say what a flood loses.
    const bool matters = request.coverage == Coverage::Solid &&
                         request.solidRule.value_or(SolidRule::FloodFill) == SolidRule::FloodFill;
    if (request.infoOnly || request.stats || request.compare || matters)
        record.mesh.report =
            clock.run("inspect", "inspecting the mesh", [&] { return require(inspect(mesh)); });
    record.grid = planGrid(request.grid, mesh);

    if (request.compare) {
        checkMemory(*record.grid, 0.0, request.memoryLimitBytes);
        compareOnDevice(request, mesh, clock, record);
    } else if (!request.infoOnly) {
        const AttributeRequest wanted = wantedAttributes(request, record.mesh.hasColors);
        checkMemory(*record.grid,
                    wanted.color || wanted.normal
                        ? expectedVoxels(*record.grid, mesh, request.coverage)
                        : 0.0,
                    request.memoryLimitBytes);
        const Voxels voxels = voxelizeOnDevice(request, wanted, std::move(mesh), clock, record);
        writeVoxels(request, voxels, clock, record);
        if (request.preview)
            writePreview(request, voxels, clock, record);
    }
    clock.finish();
    record.stages = clock.times();
    record.totalMilliseconds = clock.totalMilliseconds();
    const bool statsOnly = request.stats && request.stats->toStandardOutput();
    if (request.infoOnly || request.compare) {
        if (!statsOnly)
            printToStandardOutput(request.compare ? comparisonTable(record)
                                                  : meshDescription(record));
    } else {
        tell(request, record);
    }
    if (request.stats)
        writeStats(*request.stats, record);
}

} // namespace lamina::tool
