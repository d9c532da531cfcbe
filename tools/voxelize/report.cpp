#include "report.hpp"

#include "choices.hpp"

#include <lamina/core/version.hpp>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <cmath>
#include <iterator>

namespace lamina::tool {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kMebibyte = 1048576.0;

/// Milliseconds to a thousandth.
double rounded(double milliseconds) {
    return std::round(milliseconds * 1000.0) / 1000.0;
}

Json toJson(const glm::dvec3& v) {
    return Json::array({v.x, v.y, v.z});
}

Json toJson(const Box3& box) {
    return {{"min", toJson(box.min)}, {"max", toJson(box.max)}};
}

Json toJson(const MeshFacts& mesh) {
    Json json = {{"file", mesh.file.string()},   {"bytes", mesh.fileBytes},
                 {"triangles", mesh.triangles},  {"vertices", mesh.vertices},
                 {"colors", mesh.hasColors},     {"normals", mesh.hasNormals},
                 {"bounds", toJson(mesh.bounds)}};
    if (!mesh.report)
        return json;
    const MeshReport& report = *mesh.report;
    json["distinct_positions"] = report.distinctPositions;
    json["degenerate_triangles"] = report.degenerateTriangles;
    json["components"] = report.components;
    json["open_edges"] = report.openEdges;
    json["open_loops"] = report.openLoops;
    json["non_manifold_edges"] = report.nonManifoldEdges;
    json["flipped_edges"] = report.flippedEdges;
    json["watertight"] = report.watertight();
    json["signed_volume"] = report.signedVolume;
    return json;
}

Json toJson(const GridPlan& grid) {
    return {{"size", {grid.counts.x, grid.counts.y, grid.counts.z}},
            {"voxel_size", toJson(grid.voxelSize)},
            {"bounds", toJson(grid.bounds)},
            {"axis", wordOf(kAxes, grid.axis)},
            {"axis_chosen_by", grid.isAxisChosen ? "most columns covered" : "command line"},
            {"columns_covered", toJson(grid.coveredColumns)}};
}

Json toJson(const RendererFacts& renderer) {
    return {{"context", wordOf(kContexts, renderer.context.api)},
            {"kind", renderer.context.kind},
            {"name", renderer.context.renderer},
            {"version", renderer.context.version},
            {"software", renderer.isSoftware},
            {"failed_attempts", renderer.attempts}};
}

/// Share of the exact set's voxels, in percent.
double percentOfExact(const ComparedMethod& method, std::uint64_t voxels) {
    const std::uint64_t exact = method.againstExact.both + method.againstExact.onlyFirst;
    return exact == 0 ? 0.0 : 100.0 * static_cast<double>(voxels) / static_cast<double>(exact);
}

Json toJson(const ComparedMethod& method) {
    Json json = {{"coverage", method.coverage},
                 {"backend", method.backend},
                 {"milliseconds", rounded(method.milliseconds)},
                 {"passes", method.passes},
                 {"grid_bytes", method.deviceBytes},
                 {"set", method.set},
                 {"exact", method.exact},
                 {"iou", method.againstExact.iou()},
                 {"missing", method.againstExact.onlyFirst},
                 {"extra", method.againstExact.onlySecond}};
    if (!method.solidRule.empty())
        json["solid_rule"] = method.solidRule;
    return json;
}

Json toJson(const SolidFacts& solid) {
    return {{"solid_rule", wordOf(kSolidRules, solid.rule)},
            {"solid_rule_chosen_by", solid.isRuleChosen ? "mesh" : "command line"},
            {"odd_columns", solid.report.oddColumns},
            {"doubtful", solid.report.doubtfulVoxels},
            {"enclosed", solid.report.enclosedVoxels}};
}

double voxelCount(const GridPlan& grid) {
    return static_cast<double>(grid.counts.x) * grid.counts.y * grid.counts.z;
}

std::string bytesText(double bytes) {
    constexpr const char* kUnits[] = {"bytes", "KiB", "MiB", "GiB", "TiB"};
    std::size_t unit = 0;
    for (; bytes >= 1024.0 && unit + 1 < std::size(kUnits); ++unit)
        bytes /= 1024.0;
    return unit == 0 ? fmt::format("{:.0f} {}", bytes, kUnits[unit])
                     : fmt::format("{:.1f} {}", bytes, kUnits[unit]);
}

std::string gridText(const GridPlan& grid) {
    const glm::dvec3& h = grid.voxelSize;
    const bool cubic = h.x == h.y && h.y == h.z;
    return fmt::format("{} x {} x {} voxels of {}, projected along {}{}", grid.counts.x,
                       grid.counts.y, grid.counts.z,
                       cubic ? fmt::format("{:.6g}", h.x)
                             : fmt::format("{:.6g} x {:.6g} x {:.6g}", h.x, h.y, h.z),
                       wordOf(kAxes, grid.axis), grid.isAxisChosen ? " (chosen)" : "");
}

} // namespace

std::string statsJson(const RunRecord& record) {
    Json json;
    json["tool"] = {{"name", "lamina-voxelize"}, {"version", LAMINA_VERSION_STRING}};
    json["mesh"] = toJson(record.mesh);
    if (record.grid)
        json["grid"] = toJson(*record.grid);
    if (record.voxels) {
        const VoxelFacts& voxels = *record.voxels;
        json["voxels"] = {{"set", voxels.set},
                          {"share", static_cast<double>(voxels.set) / voxelCount(*record.grid)},
                          {"coverage", voxels.coverage}};
        Json attributes = Json::array();
        if (voxels.hasColors)
            attributes.push_back("color");
        if (voxels.hasNormals)
            attributes.push_back("normal");
        json["voxels"]["attributes"] = std::move(attributes);
        if (voxels.solid)
            json["voxels"].update(toJson(*voxels.solid));
        json["backend"] = {{"name", voxels.backend},
                           {"reason", voxels.reason},
                           {"passes", voxels.passes},
                           {"grid_bytes", voxels.deviceBytes}};
    }
    for (const ComparedMethod& method : record.comparison)
        json["comparison"].push_back(toJson(method));
    if (record.renderer)
        json["renderer"] = toJson(*record.renderer);
    Json files = Json::array();
    for (const FileFacts& file : record.files)
        files.push_back({{"file", file.file.string()},
                         {"format", file.format},
                         {"bytes", file.bytes},
                         {"milliseconds", rounded(file.milliseconds)}});
    json["files"] = std::move(files);
    Json times = Json::object();
    for (const StageTime& stage : record.stages)
        times[stage.name] = rounded(stage.milliseconds);
    times["total"] = rounded(record.totalMilliseconds);
    json["milliseconds"] = std::move(times);
    // File names need not be UTF-8.
    return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

std::string summary(const RunRecord& record) {
    std::string text =
        fmt::format("mesh      {}: {} triangles, {} vertices\n", record.mesh.file.string(),
                    record.mesh.triangles, record.mesh.vertices);
    if (record.grid)
        text += fmt::format("grid      {}\n", gridText(*record.grid));
    if (record.voxels)
        text +=
            fmt::format("voxels    {} set ({:.3g} %), {} coverage by {}{}{}\n", record.voxels->set,
                        100.0 * static_cast<double>(record.voxels->set) / voxelCount(*record.grid),
                        record.voxels->coverage, record.voxels->backend,
                        record.voxels->hasColors ? ", colours" : "",
                        record.voxels->hasNormals ? ", normals" : "");
    if (record.voxels && record.voxels->solid)
        text += fmt::format("inside    {}{}\n", wordOf(kSolidRules, record.voxels->solid->rule),
                            record.voxels->solid->isRuleChosen ? " (chosen)" : "");
    if (record.renderer)
        text += fmt::format("renderer  {}, {}\n", record.renderer->context.kind,
                            record.renderer->context.renderer);
    text += "time     ";
    for (const StageTime& stage : record.stages)
        text += fmt::format(" {} {:.0f} ms,", stage.name, stage.milliseconds);
    text += fmt::format(" total {:.2f} s\n", record.totalMilliseconds / 1000.0);
    for (const FileFacts& file : record.files)
        text += fmt::format("wrote     {} ({}, {:.0f} ms)\n", file.file.string(),
                            bytesText(static_cast<double>(file.bytes)), file.milliseconds);
    return text;
}

std::string comparisonTable(const RunRecord& record) {
    std::string text =
        fmt::format("mesh      {}: {} triangles\ngrid      {}\nrenderer  {}\n\n"
                    "{:<13} {:<15} {:>10} {:>6} {:>12} {:>9} {:>8} {:>10} {:>9}\n",
                    record.mesh.file.string(), record.mesh.triangles, gridText(*record.grid),
                    record.renderer->context.renderer, "coverage", "backend", "ms", "passes",
                    "voxels", "MiB", "IoU", "missing %", "extra %");
    std::string exactSolid;
    for (const ComparedMethod& method : record.comparison) {
        const bool isSolid = !method.solidRule.empty();
        text += fmt::format(
            "{:<13} {:<15} {:>10.2f} {:>6} {:>12} {:>9.1f} {:>8.5f} {:>10.4f} {:>9.4f}\n",
            method.coverage + (isSolid ? " " + method.solidRule : ""), method.backend,
            method.milliseconds, method.passes, method.set,
            static_cast<double>(method.deviceBytes) / kMebibyte, method.againstExact.iou(),
            percentOfExact(method, method.againstExact.onlyFirst),
            percentOfExact(method, method.againstExact.onlySecond));
        if (isSolid)
            exactSolid = method.exact;
    }
    text += "\nms: median of up to 7 voxelizations, until the GPU is done, without upload and "
            "read-back.\nIoU, missing, extra: against the exact set of all voxels that a triangle "
            "touches. Sampled, filled\nand separating6 are thinner by definition.\n";
    if (!exactSolid.empty())
        text += exactSolid == "solid parity"
                    ? "Solids: against all voxels whose centre lies inside, by parity. Flood adds "
                      "the surface's voxels\nby definition.\n"
                    : "Solids: against those by the voted rule: the mesh is not watertight or has "
                      "several parts, for which\nparity is not exact. Flood adds the surface's "
                      "voxels by definition.\n";
    return text;
}

std::string meshDescription(const RunRecord& record) {
    const MeshFacts& mesh = record.mesh;
    const Box3& box = mesh.bounds;
    const glm::dvec3 size = box.size();
    std::string text =
        fmt::format("file                {} ({})\n"
                    "triangles           {}\n"
                    "vertices            {}{}{}\n"
                    "box                 ({:g}, {:g}, {:g}) to ({:g}, {:g}, {:g})\n"
                    "size                {:g} x {:g} x {:g}\n",
                    mesh.file.string(), bytesText(static_cast<double>(mesh.fileBytes)),
                    mesh.triangles, mesh.vertices, mesh.hasColors ? ", with colours" : "",
                    mesh.hasNormals ? ", with normals" : "", box.min.x, box.min.y, box.min.z,
                    box.max.x, box.max.y, box.max.z, size.x, size.y, size.z);
    if (mesh.report) {
        const MeshReport& report = *mesh.report;
        text += fmt::format("watertight          {}\n"
                            "parts               {}\n"
                            "open edges          {} in {} loops\n"
                            "non-manifold edges  {}\n"
                            "flipped edges       {}\n"
                            "degenerate          {} triangles\n"
                            "signed volume       {:g}\n",
                            report.watertight() ? "yes" : "no", report.components, report.openEdges,
                            report.openLoops, report.nonManifoldEdges, report.flippedEdges,
                            report.degenerateTriangles, report.signedVolume);
    }
    if (record.grid)
        text += fmt::format("grid                {}, {}\n", gridText(*record.grid),
                            bytesText(record.grid->bytes()));
    return text;
}

} // namespace lamina::tool
