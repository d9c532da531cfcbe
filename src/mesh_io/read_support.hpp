#pragma once

#include "core/finite.hpp"

#include <lamina/core/result.hpp>
#include <lamina/core/triangle_mesh.hpp>

#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace lamina::detail {

/// A place in a mesh file, for messages.
struct SourceLocation {
    enum class Unit : std::uint8_t { Line, Byte };
    Unit unit = Unit::Line;
    std::uint64_t number = 0; ///< Lines from 1, bytes from 0.
};

[[nodiscard]] inline SourceLocation atLine(std::uint64_t line) {
    return {SourceLocation::Unit::Line, line};
}
[[nodiscard]] inline SourceLocation atByte(std::uint64_t byte) {
    return {SourceLocation::Unit::Byte, byte};
}

/// "line 12: expected <expected>, found <found>".
[[nodiscard]] Error readError(ErrorCode code, SourceLocation where, std::string_view expected,
                              std::string_view found);

/// A piece of a file in quotes, printable and short, for messages.
[[nodiscard]] std::string quoted(std::string_view text);

/// A double as float; infinite beyond float's range (the plain conversion is undefined there).
[[nodiscard]] inline float toFloat(double value) {
    constexpr double kLargest = std::numeric_limits<float>::max();
    if (value > kLargest)
        return std::numeric_limits<float>::infinity();
    if (value < -kLargest)
        return -std::numeric_limits<float>::infinity();
    return static_cast<float>(value);
}

/// Limits a colour component to [0,1]; NaN becomes 0.
[[nodiscard]] inline float unitRange(float value) {
    return value > 0.0f ? (value < 1.0f ? value : 1.0f) : 0.0f;
}

/// What a reader shares with its caller: progress out, the first error in.
class ReadJob {
public:
    ReadJob(const std::function<bool(float)>& progress, std::size_t totalBytes)
        : mProgress(progress)
        , mTotalBytes(totalBytes)
        , mNextReport(progress ? 0 : std::numeric_limits<std::size_t>::max()) {}

    /// Reports progress each megabyte or so. False (and an error is set) if the caller cancels.
    [[nodiscard]] bool advance(std::size_t bytesDone) {
        return bytesDone < mNextReport || report(bytesDone);
    }

    /// Keeps the first error. Always false, so that a parsing step can `return job.fail(...)`.
    bool fail(Error error) {
        if (!mError)
            mError = std::move(error);
        return false;
    }
    bool fail(SourceLocation where, std::string_view expected, std::string_view found) {
        return fail(readError(ErrorCode::InvalidFile, where, expected, found));
    }
    /// Call after a step returned false.
    [[nodiscard]] Error takeError() {
        return mError ? std::move(*mError) : Error{ErrorCode::InvalidFile, "unknown failure"};
    }

private:
    bool report(std::size_t bytesDone);

    const std::function<bool(float)>& mProgress;
    std::size_t mTotalBytes;
    std::size_t mNextReport;
    std::optional<Error> mError;
};

/// Remembers vertices that are not finite until it is known whether a triangle uses them.
class NonFiniteVertices {
public:
    /// Call for each vertex in the order of their indices.
    void check(std::size_t vertex, const glm::vec3& position, SourceLocation where) {
        if (!isFinite(position)) [[unlikely]]
            mEntries.push_back({vertex, where});
    }
    /// Moves unused ones to the origin. Errors: InvalidMesh if a triangle uses one.
    [[nodiscard]] Result<void> resolve(TriangleMesh& mesh) const;

private:
    struct Entry {
        std::size_t vertex;
        SourceLocation where;
    };
    std::vector<Entry> mEntries;
};

/// Checks vertex indices, which may refer to vertices that come later in the file.
class IndexCheck {
public:
    void note(std::uint64_t index, SourceLocation where) {
        if (!mSeen || index > mLargest) {
            mSeen = true;
            mLargest = index;
            mWhere = where;
        }
    }
    /// Errors: InvalidMesh if an index is not below `count`. `base` is the file's first index.
    [[nodiscard]] Result<void> resolve(std::uint64_t count, std::uint64_t base,
                                       std::string_view what) const;

private:
    bool mSeen = false;
    std::uint64_t mLargest = 0;
    SourceLocation mWhere;
};

/// Indices are 32 bits wide.
inline constexpr std::uint64_t kMaxVertexCount = std::numeric_limits<std::uint32_t>::max();

} // namespace lamina::detail
