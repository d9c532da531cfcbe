#include <lamina/mesh_io/mesh_file.hpp>
#include <lamina/mesh_io/mesh_normals.hpp>

#include "mesh_io/mesh_readers.hpp"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cerrno>
#include <memory>
#include <new>
#include <stdexcept>
#include <string>
#include <system_error>
#include <utility>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

namespace lamina {
namespace {

struct FileBytes {
    std::unique_ptr<char[]> data;
    std::size_t size = 0;
};

class FileDescriptor {
public:
    explicit FileDescriptor(int descriptor)
        : mDescriptor(descriptor) {}
    ~FileDescriptor() {
        if (mDescriptor >= 0)
            ::close(mDescriptor);
    }
    FileDescriptor(const FileDescriptor&) = delete;
    FileDescriptor& operator=(const FileDescriptor&) = delete;
    [[nodiscard]] int get() const { return mDescriptor; }

private:
    int mDescriptor;
};

Error systemError(int number) {
    const std::string reason = std::generic_category().message(number);
    if (number == ENOENT)
        return {ErrorCode::NotFound, "expected a file, found none; check the name"};
    return {ErrorCode::InputOutput, "expected a readable file, found '" + reason + "'"};
}

std::string_view kindOf(mode_t mode) {
    if (S_ISDIR(mode))
        return "a directory";
    if (S_ISFIFO(mode))
        return "a pipe";
    if (S_ISSOCK(mode))
        return "a socket";
    return "a device";
}

/// Reads a regular file whole. Not a memory map: a file that another process cuts short would kill
/// this one with SIGBUS, and a network file's error too; the copy costs a tenth of the parsing.
Result<FileBytes> readFile(const std::filesystem::path& file, std::uint64_t maxBytes) {
    struct stat status {};
    // Before open(), which has side effects on devices and waits on pipes.
    if (::stat(file.c_str(), &status) != 0)
        return systemError(errno);
    const auto refuseOddKinds = [&status]() -> Result<void> {
        if (S_ISREG(status.st_mode))
            return {};
        return Error{ErrorCode::InputOutput,
                     "expected a regular file, found " + std::string(kindOf(status.st_mode))};
    };
    if (const auto regular = refuseOddKinds(); !regular)
        return regular.error();
    const FileDescriptor descriptor(::open(file.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK));
    if (descriptor.get() < 0 || ::fstat(descriptor.get(), &status) != 0)
        return systemError(errno);
    if (const auto regular = refuseOddKinds(); !regular)
        return regular.error();

    const auto size = static_cast<std::uint64_t>(status.st_size);
    if (maxBytes != 0 && size > maxBytes)
        return Error{ErrorCode::OutOfMemory, "expected at most " + std::to_string(maxBytes) +
                                                 " bytes (MeshReadOptions::maxFileBytes), found " +
                                                 std::to_string(size)};
    FileBytes bytes{std::make_unique_for_overwrite<char[]>(size), 0};
    while (bytes.size < size) {
        constexpr std::uint64_t kLargestRead = std::uint64_t{1} << 30u;
        const ssize_t got = ::read(descriptor.get(), bytes.data.get() + bytes.size,
                                   std::min(size - bytes.size, kLargestRead));
        if (got == 0)
            break;
        if (got < 0 && errno != EINTR)
            return systemError(errno);
        bytes.size += got > 0 ? static_cast<std::size_t>(got) : 0;
    }
    return bytes;
}

Result<MeshFormat> formatOf(const std::filesystem::path& file) {
    std::string extension = file.extension().string();
    for (char& c : extension)
        c = c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : c;
    constexpr std::pair<std::string_view, MeshFormat> kExtensions[] = {
        {".obj", MeshFormat::Obj},
        {".ply", MeshFormat::Ply},
        {".stl", MeshFormat::Stl},
        {".off", MeshFormat::Off},
    };
    for (const auto& [name, format] : kExtensions)
        if (extension == name)
            return format;
    return Error{ErrorCode::UnknownFormat,
                 "expected a file name that ends with .obj, .ply, .stl or "
                 ".off, found " +
                     detail::quoted(file.filename().string()) +
                     "; rename it or set MeshReadOptions::format"};
}

/// OBJ has no signature: it is what remains.
MeshFormat formatOf(std::string_view bytes) {
    if (bytes.starts_with("ply\n") || bytes.starts_with("ply\r"))
        return MeshFormat::Ply;
    if (detail::isBinaryStl(bytes))
        return MeshFormat::Stl;
    if (bytes.starts_with("\xEF\xBB\xBF"))
        bytes.remove_prefix(3);
    const std::string_view line = bytes.substr(0, bytes.substr(0, 256).find_first_of("\r\n"));
    if (line.starts_with("solid"))
        return MeshFormat::Stl;
    const std::string_view word = line.substr(0, line.find_first_of(" \t#"));
    return word.size() >= 3 && word.size() <= 8 && word.ends_with("OFF") ? MeshFormat::Off
                                                                         : MeshFormat::Obj;
}

Result<TriangleMesh> readAs(MeshFormat format, std::string_view bytes, detail::ReadJob& job) {
    if (bytes.empty())
        return Error{ErrorCode::InvalidFile, "expected a mesh, found an empty file"};
    switch (format) {
    case MeshFormat::Obj:
        return detail::readObj(bytes, job);
    case MeshFormat::Ply:
        return detail::readPly(bytes, job);
    case MeshFormat::Stl:
        return detail::readStl(bytes, job);
    case MeshFormat::Off:
        return detail::readOff(bytes, job);
    case MeshFormat::Automatic:
        break;
    }
    return Error{ErrorCode::InvalidArgument,
                 "expected a MeshFormat, found " + std::to_string(static_cast<int>(format))};
}

/// Makes the file's normals unit vectors, and fills in those that are missing or have no direction.
void finishNormals(TriangleMesh& mesh, bool compute) {
    std::vector<glm::vec3> fromFile = std::move(mesh.normals);
    mesh.normals.clear();
    bool complete = !fromFile.empty();
    for (glm::vec3& normal : fromFile) {
        const glm::dvec3 exact(normal);
        const double length = std::sqrt(glm::dot(exact, exact));
        const bool usable = length > 0.0 && std::isfinite(length);
        complete = complete && usable;
        normal = usable ? glm::vec3(exact / length) : glm::vec3(0.0f);
    }
    if (!complete && (compute || !fromFile.empty()))
        computeNormals(mesh);
    if (complete) {
        mesh.normals = std::move(fromFile);
        return;
    }
    for (std::size_t i = 0; i < fromFile.size(); ++i)
        if (fromFile[i] != glm::vec3(0.0f))
            mesh.normals[i] = fromFile[i];
}

Result<TriangleMesh> parse(MeshFormat format, std::string_view bytes,
                           const MeshReadOptions& options) {
    detail::ReadJob job(options.progress, bytes.size());
    Result<TriangleMesh> mesh = readAs(format, bytes, job);
    if (!mesh)
        return mesh;
    if (mesh->triangles.empty())
        return Error{ErrorCode::InvalidMesh, "expected at least one triangle, found " +
                                                 std::to_string(mesh->positions.size()) +
                                                 " vertices and no face"};
    finishNormals(*mesh, options.computeNormals);
    if (!job.advance(bytes.size()))
        return job.takeError();
    return mesh;
}

/// Runs a step that may run out of memory; puts `subject` in front of error texts.
template<class Step>
Result<TriangleMesh> guarded(const std::string& subject, Step&& step) {
    const auto outOfMemory = [&subject] {
        return Error{ErrorCode::OutOfMemory,
                     subject + ": expected enough memory for the mesh, found too little"};
    };
    try {
        Result<TriangleMesh> mesh = step();
        if (!mesh)
            return Error{mesh.error().code, subject + ": " + mesh.error().text};
        return mesh;
    } catch (const std::bad_alloc&) {
        return outOfMemory();
    } catch (const std::length_error&) {
        return outOfMemory();
    }
}

} // namespace

std::string_view name(MeshFormat format) {
    switch (format) {
    case MeshFormat::Automatic:
        return "automatic";
    case MeshFormat::Obj:
        return "OBJ";
    case MeshFormat::Ply:
        return "PLY";
    case MeshFormat::Stl:
        return "STL";
    case MeshFormat::Off:
        return "OFF";
    }
    return "unknown";
}

Result<TriangleMesh> readMesh(const std::filesystem::path& file, const MeshReadOptions& options) {
    return guarded("read mesh " + file.string(), [&]() -> Result<TriangleMesh> {
        const Result<MeshFormat> format = options.format == MeshFormat::Automatic
                                              ? formatOf(file)
                                              : Result<MeshFormat>(options.format);
        // A missing file is worse news than a strange name.
        std::error_code ignored;
        if (!format && std::filesystem::is_regular_file(file, ignored))
            return format.error();
        const Result<FileBytes> bytes = readFile(file, options.maxFileBytes);
        if (!bytes)
            return bytes.error();
        return parse(*format, {bytes->data.get(), bytes->size}, options);
    });
}

Result<TriangleMesh> parseMesh(std::span<const std::byte> bytes, const MeshReadOptions& options) {
    const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    const MeshFormat format =
        options.format == MeshFormat::Automatic ? formatOf(text) : options.format;
    return guarded("parse mesh (" + std::string(name(format)) + ")",
                   [&] { return parse(format, text, options); });
}

} // namespace lamina
