#include <lamina/grid_io/atomic_file.hpp>

#include <algorithm>
#include <atomic>
#include <cassert>
#include <cerrno>
#include <cstring>
#include <string>
#include <system_error>
#include <utility>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

namespace lamina {
namespace {

constexpr std::size_t kPendingBytes = std::size_t{1} << 20;

std::string reason(int error) {
    return std::generic_category().message(error);
}

Error failure(const std::filesystem::path& target, const std::string& expected, int error) {
    const ErrorCode code = error == ENOENT ? ErrorCode::NotFound : ErrorCode::InputOutput;
    return {code, "write file: expected " + expected + " '" + target.string() +
                      "', found: " + reason(error)};
}

/// Where a chain of symbolic links leads, also when nothing is there yet; `path` if it is no link.
Result<std::filesystem::path> followLinks(const std::filesystem::path& path) {
    std::filesystem::path target = path;
    std::error_code error;
    for (int links = 0; std::filesystem::is_symlink(target, error); ++links) {
        if (links == 40) // As many as Linux follows.
            return failure(path, "a symbolic link that leads to a file,", ELOOP);
        target = target.parent_path() / std::filesystem::read_symlink(target, error);
    }
    return target;
}

/// A name no other writer of this machine uses at the moment.
std::filesystem::path temporaryName(const std::filesystem::path& target) {
    static std::atomic<unsigned> counter{0};
    // Long target names leave no room for a suffix within the file system's limit.
    const std::string stem = target.filename().string().substr(0, 100);
    return target.parent_path() /
           ("." + stem + "." + std::to_string(getpid()) + "-" + std::to_string(counter++) + ".tmp");
}

} // namespace

Result<AtomicFile> AtomicFile::create(const std::filesystem::path& target) {
    if (target.filename().empty() || target.filename() == "." || target.filename() == "..")
        return Error{ErrorCode::InputOutput,
                     "write file: expected a file name, found '" + target.string() + "'"};
    auto followed = followLinks(target);
    if (!followed)
        return followed.error();
    AtomicFile file;
    file.mTarget = std::move(*followed);

    struct stat existing {};
    const bool exists = stat(file.mTarget.c_str(), &existing) == 0;
    if (exists && !S_ISREG(existing.st_mode))
        return Error{ErrorCode::InputOutput,
                     "write file: expected a regular file or a new name, '" + target.string() +
                         "' is " + (S_ISDIR(existing.st_mode) ? "a directory" : "a special file") +
                         "; choose another name"};
    if (exists && access(file.mTarget.c_str(), W_OK) != 0)
        return failure(target, "permission to replace", errno);

    file.mTemporary = temporaryName(file.mTarget);
    file.mDescriptor =
        open(file.mTemporary.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, mode_t{0666});
    if (file.mDescriptor < 0)
        return failure(target,
                       errno == ENOENT ? "an existing directory for" : "a directory that takes",
                       errno);
    if (exists && fchmod(file.mDescriptor, existing.st_mode & mode_t{07777}) != 0)
        return failure(target, "to keep the permissions of", errno);
    file.mPending.reserve(kPendingBytes);
    return file;
}

AtomicFile::AtomicFile(AtomicFile&& other) noexcept {
    *this = std::move(other);
}

AtomicFile& AtomicFile::operator=(AtomicFile&& other) noexcept {
    if (this != &other) {
        discard();
        mTarget = std::move(other.mTarget);
        mTemporary = std::move(other.mTemporary);
        mDescriptor = std::exchange(other.mDescriptor, -1);
        mFailure = other.mFailure;
        mSize = other.mSize;
        mPending = std::move(other.mPending);
    }
    return *this;
}

AtomicFile::~AtomicFile() {
    discard();
}

Result<void> AtomicFile::write(std::span<const std::byte> bytes) {
    if (bytes.size() >= kPendingBytes) {
        if (auto flushed = flush(); !flushed)
            return flushed;
        mSize += bytes.size();
        return store(bytes, mSize - bytes.size());
    }
    mSize += bytes.size();
    mPending.insert(mPending.end(), bytes.begin(), bytes.end());
    return mPending.size() >= kPendingBytes ? flush() : Result<void>();
}

Result<void> AtomicFile::overwrite(std::uint64_t offset, std::span<const std::byte> bytes) {
    assert(offset + bytes.size() <= mSize);
    if (auto flushed = flush(); !flushed)
        return flushed;
    return store(bytes, offset);
}

Result<void> AtomicFile::commit() {
    if (auto flushed = flush(); !flushed) {
        discard();
        return flushed;
    }
    // A file system may report a full disk as late as here.
    int error = fsync(mDescriptor) != 0 ? errno : 0;
    if (close(mDescriptor) != 0 && error == 0)
        error = errno;
    mDescriptor = -1;
    if (error == 0 && rename(mTemporary.c_str(), mTarget.c_str()) != 0)
        error = errno;
    if (error != 0) {
        unlink(mTemporary.c_str());
        return failure(mTarget, "to finish", error);
    }
    const std::filesystem::path directory =
        mTarget.has_parent_path() ? mTarget.parent_path() : std::filesystem::path(".");
    // The new name itself survives a power cut only once its directory is on disk; the content is
    // safe without, so a directory that cannot be synchronized is no failure.
    if (const int handle = open(directory.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
        handle >= 0) {
        (void)fsync(handle);
        close(handle);
    }
    return {};
}

Result<void> AtomicFile::flush() {
    const std::uint64_t offset = mSize - mPending.size();
    auto stored = store(mPending, offset);
    mPending.clear();
    return stored;
}

Result<void> AtomicFile::store(std::span<const std::byte> bytes, std::uint64_t offset) {
    assert(mDescriptor >= 0 && "AtomicFile used after commit()");
    while (!bytes.empty() && mFailure == 0) {
        const ssize_t stored =
            pwrite(mDescriptor, bytes.data(), bytes.size(), static_cast<off_t>(offset));
        if (stored < 0 && errno == EINTR)
            continue;
        if (stored <= 0) {
            mFailure = stored < 0 ? errno : ENOSPC;
            break;
        }
        bytes = bytes.subspan(static_cast<std::size_t>(stored));
        offset += static_cast<std::uint64_t>(stored);
    }
    if (mFailure != 0)
        return failure(mTarget, "room for " + std::to_string(mSize) + " bytes of", mFailure);
    return {};
}

void AtomicFile::discard() {
    if (mDescriptor < 0)
        return;
    close(mDescriptor);
    unlink(mTemporary.c_str());
    mDescriptor = -1;
}

} // namespace lamina
