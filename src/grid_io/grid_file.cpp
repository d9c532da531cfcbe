#include "grid_io/formats.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <fcntl.h>
#include <new>
#include <sys/stat.h>
#include <system_error>
#include <unistd.h>

namespace lamina {
namespace {

constexpr std::array kFormats{GridFormat::Binvox, GridFormat::Vox, GridFormat::Npy, GridFormat::Vti,
                              GridFormat::Vdb};

Result<GridFormat> chosenFormat(const std::filesystem::path& path, GridFormat format) {
    return format == GridFormat::Automatic ? gridFormat(path) : Result<GridFormat>(format);
}

/// What stands in files of its own beside a .npy file.
std::vector<detail::NpyArray> arraysBeside(GridFormat format, const GridWriteOptions& options) {
    std::vector<detail::NpyArray> arrays;
    if (format != GridFormat::Npy || options.attributes == nullptr)
        return arrays;
    if (!options.attributes->colors.empty())
        arrays.push_back(detail::NpyArray::Color);
    if (!options.attributes->normals.empty())
        arrays.push_back(detail::NpyArray::Normal);
    return arrays;
}

std::filesystem::path besideFile(const std::filesystem::path& path, detail::NpyArray array) {
    std::filesystem::path name = path;
    name.replace_extension();
    name += array == detail::NpyArray::Color ? ".color" : ".normal";
    name += path.extension();
    return name;
}

Result<void> writeContent(GridFormat format, AtomicFile& file, const detail::BoxVoxels& voxels,
                          const GridWriteOptions& options) {
    switch (format) {
    case GridFormat::Binvox:
        return detail::writeBinvox(file, voxels, options);
    case GridFormat::Vox:
        return detail::writeVox(file, voxels, options);
    case GridFormat::Npy:
        return detail::writeNpy(file, voxels, detail::NpyArray::Occupancy, options);
    case GridFormat::Vti:
        return detail::writeVti(file, voxels, options);
    case GridFormat::Vdb:
        return detail::writeVdb(file, voxels, options);
    case GridFormat::Automatic:
        break;
    }
    return Error{ErrorCode::InvalidArgument, "write grid: expected a format of GridFormat"};
}

} // namespace

std::string_view name(GridFormat format) {
    switch (format) {
    case GridFormat::Automatic:
        return "automatic";
    case GridFormat::Binvox:
        return "binvox";
    case GridFormat::Vox:
        return "vox";
    case GridFormat::Npy:
        return "npy";
    case GridFormat::Vti:
        return "vti";
    case GridFormat::Vdb:
        return "vdb";
    }
    return "unknown";
}

Result<GridFormat> gridFormat(const std::filesystem::path& path) {
    std::string extension = path.extension().string();
    std::transform(extension.begin(), extension.end(), extension.begin(), [](char c) {
        return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
    });
    std::string known;
    for (const GridFormat format : kFormats) {
        const std::string candidate = "." + std::string(name(format));
        if (extension == candidate)
            return format;
        known += (known.empty() ? "" : ", ") + candidate;
    }
    return Error{ErrorCode::UnknownFormat,
                 "voxel file '" + path.string() + "': expected a name that ends in " + known +
                     "; found " + (extension.empty() ? "no extension" : extension)};
}

bool canWrite(GridFormat format) {
#if defined(LAMINA_HAS_OPENVDB)
    constexpr bool hasVdb = true;
#else
    constexpr bool hasVdb = false;
#endif
    return format != GridFormat::Vdb || hasVdb;
}

bool holdsColors(GridFormat format) {
    return format == GridFormat::Vox || holdsNormals(format);
}

bool holdsNormals(GridFormat format) {
    return format == GridFormat::Npy || format == GridFormat::Vti || format == GridFormat::Vdb;
}

Result<std::vector<std::filesystem::path>> gridFiles(const std::filesystem::path& path,
                                                     const GridWriteOptions& options) {
    const auto format = chosenFormat(path, options.format);
    if (!format)
        return format.error();
    std::vector<std::filesystem::path> files{path};
    for (const detail::NpyArray array : arraysBeside(*format, options))
        files.push_back(besideFile(path, array));
    return files;
}

Result<void> writeGrid(const std::filesystem::path& path, const BitGrid& grid,
                       const GridWriteOptions& options) {
    const auto format = chosenFormat(path, options.format);
    if (!format)
        return format.error();
    if (!canWrite(*format))
        return Error{
            ErrorCode::Unsupported,
            "write '" + path.string() +
                "': expected a lamina built with OpenVDB, found one without; install OpenVDB "
                "and build again, or choose .vti, .vox, .npy or .binvox"};
    const auto voxels =
        detail::BoxVoxels::create(grid, holdsColors(*format) ? options.attributes : nullptr);
    if (!voxels)
        return Error{voxels.error().code, "write '" + path.string() + "': " + voxels.error().text};
    try {
        auto file = AtomicFile::create(path);
        if (!file)
            return file.error();
        const std::vector<detail::NpyArray> arrays = arraysBeside(*format, options);
        const double share = 1.0 / static_cast<double>(1 + arrays.size());
        if (auto written =
                writeContent(*format, *file, *voxels, detail::partOf(options, 0.0, share));
            !written)
            return written;
        std::vector<AtomicFile> beside;
        for (const detail::NpyArray array : arrays) {
            auto added = AtomicFile::create(besideFile(path, array));
            if (!added)
                return added.error();
            beside.push_back(std::move(*added));
            const auto place = static_cast<double>(beside.size());
            const double end = beside.size() == arrays.size() ? 1.0 : share * (place + 1.0);
            if (auto written = detail::writeNpy(beside.back(), *voxels, array,
                                                detail::partOf(options, share * place, end));
                !written)
                return written;
        }
        for (AtomicFile& added : beside)
            if (auto committed = added.commit(); !committed)
                return committed;
        return file->commit();
    } catch (const std::bad_alloc&) {
        return Error{ErrorCode::OutOfMemory,
                     "write '" + path.string() + "': expected memory for a few slices of " +
                         grid.transform().describe() + ", found too little"};
    }
}

Result<BitGrid> readGrid(const std::filesystem::path& path) {
    const auto format = gridFormat(path);
    if (!format)
        return format.error();
    if (*format != GridFormat::Binvox && *format != GridFormat::Npy)
        return Error{ErrorCode::Unsupported,
                     "read grid '" + path.string() + "': expected .binvox or .npy, found ." +
                         std::string(name(*format)) + ", which is only written"};
    try {
        const auto bytes = detail::readFile(path);
        if (!bytes)
            return bytes.error();
        return *format == GridFormat::Npy ? detail::readNpy(*bytes, path)
                                          : detail::readBinvox(*bytes, path);
    } catch (const std::bad_alloc&) {
        return Error{ErrorCode::OutOfMemory,
                     "read grid '" + path.string() +
                         "': expected memory for its voxels, found too little"};
    }
}

namespace detail {

Result<std::vector<std::byte>> readFile(const std::filesystem::path& path) {
    const auto failure = [&](int error) {
        return Error{error == ENOENT ? ErrorCode::NotFound : ErrorCode::InputOutput,
                     "read file '" + path.string() + "': expected a readable file, found: " +
                         std::generic_category().message(error)};
    };
    // Without O_NONBLOCK, opening a named pipe would wait for a writer.
    const int descriptor = open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
    if (descriptor < 0)
        return failure(errno);
    struct Closer {
        int descriptor;
        ~Closer() { close(descriptor); }
    } closer{descriptor};
    struct stat status {};
    if (fstat(descriptor, &status) != 0)
        return failure(errno);
    if (!S_ISREG(status.st_mode))
        return Error{ErrorCode::InputOutput,
                     "read file '" + path.string() + "': expected a regular file, found " +
                         (S_ISDIR(status.st_mode) ? "a directory" : "a special file")};
    std::vector<std::byte> bytes(static_cast<std::size_t>(status.st_size));
    std::size_t filled = 0;
    while (filled < bytes.size()) {
        const ssize_t count = read(descriptor, bytes.data() + filled, bytes.size() - filled);
        if (count < 0 && errno == EINTR)
            continue;
        if (count < 0)
            return failure(errno);
        if (count == 0)
            break;
        filled += static_cast<std::size_t>(count);
    }
    bytes.resize(filled);
    return bytes;
}

std::string exactText(double value) {
    char text[32];
    const auto end = std::to_chars(text, text + sizeof text, value);
    return std::string(text, end.ptr);
}

Error invalidFile(const std::filesystem::path& path, const std::string& detail) {
    return {ErrorCode::InvalidFile, "read grid '" + path.string() + "': " + detail};
}

} // namespace detail
} // namespace lamina
