#pragma once

#include "option_words.hpp"

#include <lamina/core/result.hpp>

#include <stdexcept>
#include <string>
#include <utility>

namespace lamina::tool {

/// What the process returns; --help lists them.
enum class ExitCode : int {
    Success = 0,
    Failed = 1,         ///< Reading, writing, memory or OpenGL failed.
    BadCommandLine = 2, ///< The request itself is wrong.
    BadMesh = 3,        ///< The mesh file cannot be read or holds nothing to voxelize.
    Unsupported = 4,    ///< A combination that is not served, or over a limit.
};

/// Ends the run; main() turns it into a message and an exit code.
class Failure : public std::runtime_error {
public:
    Failure(ExitCode code, const std::string& text)
        : Failure(static_cast<int>(code), text) {}
    Failure(int status, const std::string& text)
        : std::runtime_error(text)
        , mStatus(status) {}

    [[nodiscard]] int status() const { return mStatus; }

private:
    int mStatus;
};

[[nodiscard]] inline Failure failure(const Error& error) {
    switch (error.code) {
    case ErrorCode::InvalidMesh:
    case ErrorCode::InvalidFile:
        return {ExitCode::BadMesh, error.text};
    case ErrorCode::Unsupported:
    case ErrorCode::DeviceLimit:
        return {ExitCode::Unsupported, inOptionWords(error.text)};
    default:
        return {ExitCode::Failed, error.text};
    }
}

/// The value, or a Failure thrown.
template<class T>
[[nodiscard]] T require(Result<T>&& result) {
    if (!result)
        throw failure(result.error());
    return std::move(*result);
}

inline void require(Result<void>&& result) {
    if (!result)
        throw failure(result.error());
}

} // namespace lamina::tool
