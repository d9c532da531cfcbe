#pragma once

#include <lamina/core/export.hpp>
#include <lamina/core/result.hpp>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string_view>
#include <vector>

namespace lamina {

/// A file that appears whole or not at all.
///
/// Bytes go to a temporary file beside the target; commit() puts it in the target's place in one
/// step, after they reached the disk. Without commit() the temporary is removed and the target is
/// left as it was, also when the process is out of disk space. A target that is a symbolic link
/// is replaced where the link points; an existing target keeps its permissions.
/// Move-only; use one object from one thread.
class LAMINA_API AtomicFile {
public:
    /// Opens a temporary file beside `target`.
    /// Errors: NotFound (the directory does not exist), InputOutput (no permission, or `target`
    /// exists and is not a regular file).
    [[nodiscard]] static Result<AtomicFile> create(const std::filesystem::path& target);

    AtomicFile(AtomicFile&& other) noexcept;
    AtomicFile& operator=(AtomicFile&& other) noexcept;
    ~AtomicFile();

    /// Appends bytes; small pieces are collected.
    /// Errors: InputOutput (e.g. no space left); later calls and commit() then fail alike.
    Result<void> write(std::span<const std::byte> bytes);
    Result<void> write(std::string_view text) {
        return write(std::as_bytes(std::span(text.data(), text.size())));
    }
    /// Overwrites bytes written earlier, e.g. a size known only at the end.
    /// offset + bytes.size() must not exceed size() (asserted).
    Result<void> overwrite(std::uint64_t offset, std::span<const std::byte> bytes);

    /// Bytes appended so far.
    [[nodiscard]] std::uint64_t size() const { return mSize; }

    /// Puts the file in the target's place. Waits for the disk. Call it once, last.
    /// Errors: InputOutput; the target is then as it was and the temporary is gone.
    Result<void> commit();

private:
    AtomicFile() = default;
    Result<void> flush();
    Result<void> store(std::span<const std::byte> bytes, std::uint64_t offset);
    void discard();

    std::filesystem::path mTarget;
    std::filesystem::path mTemporary;
    int mDescriptor = -1;
    int mFailure = 0; ///< The first errno; a failed file stays failed.
    std::uint64_t mSize = 0;
    std::vector<std::byte> mPending;
};

} // namespace lamina
