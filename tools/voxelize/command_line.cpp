#include "command_line.hpp"

#include "choices.hpp"
#include "failure.hpp"
#include "help.hpp"

#include <lamina/core/version.hpp>

#include <CLI/CLI.hpp>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <memory>

namespace lamina::tool {
namespace {

constexpr std::uint32_t kDefaultResolution = 256;
constexpr std::uint32_t kMaxCount = 1u << 24;
constexpr std::uint32_t kMaxPixels = 16384;
constexpr double kDefaultMemoryShare = 0.75;
constexpr double kMebibyte = 1048576.0;

template<class Number>
std::optional<Number> parseNumber(const std::string& text) {
    Number value{};
    const char* const begin = text.data() + (text.starts_with('+') ? 1 : 0);
    const char* const end = text.data() + text.size();
    const auto parsed = std::from_chars(begin, end, value);
    return parsed.ec == std::errc() && parsed.ptr == end ? std::optional(value) : std::nullopt;
}

CLI::Validator wholeNumber(std::uint32_t low, std::uint32_t high) {
    return CLI::Validator(
        [low, high](std::string& text) {
            const auto value = parseNumber<std::uint32_t>(text);
            return value && *value >= low && *value <= high
                       ? std::string()
                       : fmt::format("expected a whole number from {} to {}, found '{}'", low, high,
                                     text);
        },
        "");
}

CLI::Validator realNumber(bool positive) {
    return CLI::Validator(
        [positive](std::string& text) {
            const auto value = parseNumber<double>(text);
            return value && std::isfinite(*value) && (!positive || *value > 0.0)
                       ? std::string()
                       : fmt::format("expected a {} number, found '{}'",
                                     positive ? "positive" : "finite", text);
        },
        "");
}

/// The command line as CLI11 fills it, before words and groups of numbers get their meaning.
struct Arguments {
    std::string mesh;
    std::optional<std::uint32_t> resolution;
    std::optional<double> voxelSize;
    std::vector<double> bounds;
    std::vector<std::uint32_t> counts;
    std::string axis = "auto";
    std::optional<std::string> coverage;
    std::string solidRule = "auto";
    std::string backend = "auto";
    std::string attributes = "auto";
    std::string context = "auto";
    std::string up = "y";
    std::optional<double> memoryLimit;
    std::vector<std::string> outputs;
    std::string preview;
    std::vector<double> view;
    std::vector<std::uint32_t> previewSize;
    std::string stats;
};

void addGridOptions(CLI::App& app, Arguments& args) {
    const std::string group = "Grid";
    auto* resolution =
        app.add_option(
               "-r,--resolution", args.resolution,
               fmt::format("Voxels along the mesh's longest side (default {})", kDefaultResolution))
            ->type_name("N")
            ->check(wholeNumber(1, kMaxCount))
            ->group(group);
    auto* voxelSize =
        app.add_option("--voxel-size", args.voxelSize, "Edge of a voxel, in the mesh's units")
            ->type_name("H")
            ->check(realNumber(true))
            ->group(group);
    auto* bounds =
        app.add_option("--bounds", args.bounds,
                       "Low and high corner of the grid, in the mesh's units; with --grid")
            ->type_name("X0 Y0 Z0 X1 Y1 Z1")
            ->type_size(6)
            ->expected(1)
            ->check(realNumber(false))
            ->group(group);
    auto* counts = app.add_option("--grid", args.counts, "Voxels along x, y, z; with --bounds")
                       ->type_name("NX NY NZ")
                       ->type_size(3)
                       ->expected(1)
                       ->check(wholeNumber(1, kMaxCount))
                       ->group(group);
    resolution->excludes(voxelSize)->excludes(bounds)->excludes(counts);
    voxelSize->excludes(bounds)->excludes(counts);
    bounds->needs(counts);
    counts->needs(bounds);
    app.add_option("--axis", args.axis, "Direction of projection: auto, x, y, z (default auto)")
        ->type_name("AXIS")
        ->group(group);
    app.add_option("--memory-limit", args.memoryLimit,
                   "Most memory of the grid and its attributes on device and host together, in MiB "
                   "(default three quarters of the machine's)")
        ->type_name("MIB")
        ->check(realNumber(true))
        ->group(group);
}

void addMethodOptions(CLI::App& app, Arguments& args) {
    const std::string group = "Method";
    app.add_option(
           "--coverage", args.coverage,
           fmt::format("Which voxels count as hit: {} (default conservative)", words(kCoverages)))
        ->type_name("WORD")
        ->group(group);
    app.add_option("--solid-rule", args.solidRule,
                   fmt::format("What solid takes for the inside: auto, {} (default auto)",
                               words(kSolidRules)))
        ->type_name("WORD")
        ->group(group);
    app.add_option("--backend", args.backend,
                   fmt::format("How voxels are made: {} (default auto)", words(kBackends)))
        ->type_name("WORD")
        ->group(group);
    app.add_option("--attributes", args.attributes,
                   "What voxels keep of the surface: auto, none, or color, normal or color,normal "
                   "(default auto: colours that the mesh has)")
        ->type_name("LIST")
        ->group(group);
    app.add_option("--context", args.context,
                   fmt::format("Where OpenGL comes from: {} (default auto: EGL, then OSMesa)",
                               words(kContexts)))
        ->type_name("WORD")
        ->group(group);
}

void addOutputOptions(CLI::App& app, Arguments& args, Request& request) {
    const std::string group = "Output";
    app.add_option(
           "-o,--output", args.outputs,
           "Voxel file, by extension .npy .binvox .vox .vti .vdb; may be given several times")
        ->type_name("FILE")
        ->allow_extra_args(false)
        ->group(group);
    auto* preview = app.add_option("--preview", args.preview, "Picture of the voxels")
                        ->type_name("FILE.png")
                        ->group(group);
    app.add_option(
           "--view", args.view,
           "Where the picture is seen from: a direction from the mesh to the viewer (default "
           "0.62 0.42 0.86)")
        ->type_name("X Y Z")
        ->type_size(3)
        ->expected(1)
        ->check(realNumber(false))
        ->needs(preview)
        ->group(group);
    app.add_option("--preview-size", args.previewSize,
                   "Of the picture, in pixels (default 1024 1024)")
        ->type_name("W H")
        ->type_size(2)
        ->expected(1)
        ->check(wholeNumber(1, kMaxPixels))
        ->needs(preview)
        ->group(group);
    app.add_option(
           "--up", args.up,
           fmt::format("The mesh's axis that points up in pictures and .vox files: {} (default "
                       "y)",
                       words(kAxes)))
        ->type_name("AXIS")
        ->group(group);
    app.add_option(
           "--stats", args.stats,
           "JSON about mesh, grid, voxels, renderer and milliseconds; '-' is standard output")
        ->type_name("FILE.json|-")
        ->group(group);
    app.add_flag("-q,--quiet", request.quiet, "No progress, no summary, no warnings; errors only")
        ->group(group);
    app.add_flag("-v,--verbose", request.verbose,
                 "Summary and notes on standard error also if that is no terminal")
        ->group(group)
        ->excludes(app.get_option("--quiet"));
}

void addOtherModes(CLI::App& app, Request& request) {
    const std::string group = "Instead of voxelizing";
    auto* info =
        app.add_flag("--info", request.infoOnly,
                     "Describe the mesh (triangles, holes, watertight or not) and the grid it "
                     "would get")
            ->group(group);
    info->excludes(app.get_option("--output"))->excludes(app.get_option("--preview"));
    auto* compare =
        app.add_flag("--compare", request.compare,
                     "Time every backend, coverage and solid rule (or the coverage of --coverage) "
                     "on this mesh and grid, and set their voxels beside the exact ones")
            ->group(group);
    compare->excludes(app.get_option("--output"))
        ->excludes(app.get_option("--preview"))
        ->excludes(app.get_option("--backend"))
        ->excludes(info);
    app.add_flag("--list-contexts", request.listContexts,
                 "Say which OpenGL contexts this machine offers, and why others fail")
        ->group(group);
    app.set_version_flag("--version", "lamina-voxelize " LAMINA_VERSION_STRING, "Print the version")
        ->group(group);
    app.set_help_flag("-h,--help", "Print this text")->group(group);
}

void takeGrid(const Arguments& args, GridRequest& grid) {
    grid.resolution = args.resolution;
    grid.voxelSize = args.voxelSize;
    if (!args.bounds.empty()) {
        const std::vector<double>& b = args.bounds;
        grid.bounds = Box3{{b[0], b[1], b[2]}, {b[3], b[4], b[5]}};
        grid.counts = glm::uvec3(args.counts[0], args.counts[1], args.counts[2]);
        for (int axis = 0; axis < 3; ++axis)
            if (!(b[axis] < b[axis + 3]) || !std::isfinite(b[axis + 3] - b[axis]))
                throw Failure(
                    ExitCode::BadCommandLine,
                    fmt::format("--bounds: expected a low corner below the high corner on "
                                "each axis, found {1}0 = {2:g} and {1}1 = {3:g}{0}",
                                "; a flat grid needs some thickness", "XYZ"[axis], b[axis],
                                b[axis + 3]));
    } else if (!grid.voxelSize && !grid.resolution) {
        grid.resolution = kDefaultResolution;
    }
    if (args.axis != "auto")
        grid.axis = choose("--axis", kAxes, args.axis);
}

void takePreview(const Arguments& args, Request& request) {
    if (args.preview.empty())
        return;
    PreviewRequest preview;
    preview.file = args.preview;
    if (!args.view.empty())
        preview.view = {args.view[0], args.view[1], args.view[2]};
    if (preview.view == glm::dvec3(0.0))
        throw Failure(ExitCode::BadCommandLine,
                      "--view: expected a direction, found 0 0 0; 0 0 1 looks from +z");
    if (!args.previewSize.empty())
        preview.size = {args.previewSize[0], args.previewSize[1]};
    request.preview = preview;
}

AttributeRequest attributes(std::string_view list) {
    AttributeRequest request;
    if (list == "auto")
        return request;
    request.isAutomatic = false;
    if (list == "none")
        return request;
    for (std::size_t begin = 0; begin <= list.size();) {
        const std::size_t end = std::min(list.find(',', begin), list.size());
        const std::string_view word = list.substr(begin, end - begin);
        if (word != "color" && word != "normal")
            throw Failure(ExitCode::BadCommandLine,
                          fmt::format("--attributes: expected auto, none, color, normal or "
                                      "color,normal, found '{}'",
                                      list));
        (word == "color" ? request.color : request.normal) = true;
        begin = end + 1;
    }
    return request;
}

void takeArguments(const Arguments& args, Request& request) {
    request.mesh = args.mesh;
    takeGrid(args, request.grid);
    if (args.coverage)
        request.coverage = choose("--coverage", kCoverages, *args.coverage);
    if (request.compare && args.coverage)
        request.comparedCoverage = request.coverage;
    if (args.solidRule != "auto") {
        request.solidRule = choose("--solid-rule", kSolidRules, args.solidRule);
        if (request.coverage != Coverage::Solid || request.compare)
            throw Failure(
                ExitCode::BadCommandLine,
                fmt::format("--solid-rule: expected --coverage solid without --compare, "
                            "found {}",
                            request.compare ? "--compare" : wordOf(kCoverages, request.coverage)));
    }
    request.backend = choose("--backend", kBackends, args.backend);
    request.attributes = attributes(args.attributes);
    request.context = choose("--context", kContexts, args.context);
    request.up = choose("--up", kAxes, args.up);
    request.memoryLimitBytes =
        args.memoryLimit ? *args.memoryLimit * kMebibyte : kDefaultMemoryShare * physicalMemory();
    for (const std::string& output : args.outputs)
        request.outputs.emplace_back(output);
    takePreview(args, request);
    if (!args.stats.empty())
        request.stats = StatsRequest{args.stats};
    if (request.listContexts)
        return;
    if (request.mesh.empty())
        throw Failure(ExitCode::BadCommandLine,
                      "expected a mesh file (.obj .ply .stl .off), found none; see --help");
    if (!request.infoOnly && !request.compare && request.outputs.empty() && !request.preview &&
        !request.stats)
        throw Failure(
            ExitCode::BadCommandLine,
            "nothing to make: expected -o FILE, --preview FILE.png, --stats FILE, --compare or "
            "--info");
}

} // namespace

std::optional<Request> parseCommandLine(int argc, const char* const* argv) {
    CLI::App app(kHelpDescription, "lamina-voxelize");
    app.footer(kHelpFooter);
    app.formatter(std::make_shared<HelpFormatter>());
    Request request;
    Arguments args;
    app.add_option("mesh", args.mesh, "Mesh file: .obj .ply .stl .off")->type_name("MESH");
    addGridOptions(app, args);
    addMethodOptions(app, args);
    addOutputOptions(app, args, request);
    addOtherModes(app, request);
    try {
        app.parse(argc, argv);
    } catch (const CLI::CallForHelp&) {
        fmt::print("{}", app.help());
        return std::nullopt;
    } catch (const CLI::CallForVersion& version) {
        fmt::print("{}\n", version.what());
        return std::nullopt;
    } catch (const CLI::ParseError& error) {
        throw Failure(ExitCode::BadCommandLine, std::string(error.what()) + "; see --help");
    }
    takeArguments(args, request);
    return request;
}

} // namespace lamina::tool
