#include "output_plan.hpp"

#include "failure.hpp"
#include "file_guard.hpp"

#include <lamina/grid_io/atomic_file.hpp>
#include <lamina/grid_io/grid_file.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <string>
#include <system_error>
#include <vector>

namespace lamina::tool {
namespace {

namespace fs = std::filesystem;

/// One file to be written, and the option it stands for.
struct Target {
    std::string option;
    fs::path file;
};

std::vector<Target> targets(const Request& request) {
    std::vector<Target> all;
    AttributeGrid wanted;
    wanted.colors.resize(request.attributes.color);
    wanted.normals.resize(request.attributes.normal);
    GridWriteOptions options;
    options.attributes = &wanted;
    for (const fs::path& output : request.outputs) {
        // Known formats: checked before.
        const auto files = gridFiles(output, options);
        for (const fs::path& file : *files)
            all.push_back({"-o", file});
    }
    if (request.preview)
        all.push_back({"--preview", request.preview->file});
    if (request.stats && !request.stats->toStandardOutput())
        all.push_back({"--stats", request.stats->file});
    return all;
}

/// Two names of one file give equal paths, whether it exists or not.
fs::path identity(const fs::path& file) {
    std::error_code error;
    fs::path absolute = fs::weakly_canonical(fs::absolute(file, error), error);
    return error ? file.lexically_normal() : absolute;
}

void checkCubes(const fs::path& file, const GridRequest& grid) {
    if (!grid.bounds)
        return;
    const glm::dvec3 edge = grid.bounds->size() / glm::dvec3(*grid.counts);
    if (!isCubic(edge))
        throw Failure(
            ExitCode::Unsupported,
            fmt::format("-o {}: .binvox holds cubic voxels only, --bounds and --grid give "
                        "edges {:g}, {:g}, {:g}; choose .vti, .vdb or .npy",
                        file.string(), edge.x, edge.y, edge.z));
}

void checkVoxelFormat(const fs::path& file, const GridRequest& grid) {
    const auto format = gridFormat(file);
    if (!format)
        throw Failure(ExitCode::BadCommandLine, "-o " + file.string() + ": " + format.error().text);
    if (!canWrite(*format))
        throw Failure(
            ExitCode::Unsupported,
            fmt::format("-o {}: this build was made without .{} files; choose another format",
                        file.string(), name(*format)));
    if (*format == GridFormat::Binvox)
        checkCubes(file, grid);
}

void checkPictureFormat(const fs::path& file) {
    std::string extension = file.extension().string();
    std::transform(extension.begin(), extension.end(), extension.begin(),
                   [](unsigned char letter) { return static_cast<char>(std::tolower(letter)); });
    if (extension != ".png")
        throw Failure(
            ExitCode::BadCommandLine,
            fmt::format("--preview {}: expected a file name that ends in .png, found '{}'",
                        file.string(), extension));
}

void checkNoneTwice(const std::vector<Target>& all, const fs::path& mesh) {
    for (std::size_t i = 0; i < all.size(); ++i) {
        const fs::path file = identity(all[i].file);
        if (file == identity(mesh))
            throw Failure(ExitCode::BadCommandLine,
                          fmt::format("{} {}: this is the mesh file; choose another name",
                                      all[i].option, all[i].file.string()));
        for (std::size_t k = 0; k < i; ++k)
            if (file == identity(all[k].file))
                throw Failure(ExitCode::BadCommandLine,
                              fmt::format("{} {}: the same file as {} {}; choose another name",
                                          all[i].option, all[i].file.string(), all[k].option,
                                          all[k].file.string()));
    }
}

void checkWritable(const Target& target) {
    const FileGuard guard;
    if (const auto opened = AtomicFile::create(target.file); !opened)
        throw Failure(ExitCode::Failed, fmt::format("{} {}: {}", target.option,
                                                    target.file.string(), opened.error().text));
}

} // namespace

void checkOutputs(const Request& request) {
    for (const fs::path& output : request.outputs)
        checkVoxelFormat(output, request.grid);
    if (request.preview)
        checkPictureFormat(request.preview->file);
    const std::vector<Target> all = targets(request);
    checkNoneTwice(all, request.mesh);
    for (const Target& target : all)
        checkWritable(target);
}

} // namespace lamina::tool
