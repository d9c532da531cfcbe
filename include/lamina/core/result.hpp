#pragma once

#include <lamina/core/export.hpp>

#include <cassert>
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <variant>

namespace lamina {

/// What kind of failure an Error is; its text says the rest.
enum class ErrorCode : std::uint8_t {
    InvalidArgument,   ///< A value the caller passed is out of range or inconsistent.
    InvalidMesh,       ///< Empty, non-finite or out-of-range geometry.
    InvalidFile,       ///< A file's content is not what its format demands.
    UnknownFormat,     ///< No reader or writer for this file name extension.
    NotFound,          ///< A file, a directory or a name does not exist.
    InputOutput,       ///< The operating system refused to read or write.
    OutOfMemory,       ///< The host, the device or a stated memory budget has too little.
    DeviceLimit,       ///< The GL implementation's limit is smaller than what was asked for.
    UnsupportedDevice, ///< The GL context lacks a version, function or format.
    NoContext,         ///< No GL context is current, or none could be created.
    ShaderError,       ///< A shader did not compile or a program did not link.
    Unsupported,       ///< No implementation serves this combination of requests.
    Cancelled,         ///< The caller's progress callback asked to stop.
};

/// The enumerator's name, e.g. "InvalidMesh".
[[nodiscard]] LAMINA_API std::string_view name(ErrorCode code);

/// Why an operation failed. `text` reads "operation: what was expected, what was found; what to
/// do".
struct Error {
    ErrorCode code = ErrorCode::InvalidArgument;
    std::string text;
};

/// A value, or the Error that prevented it. Nothing in Lamina throws across its API.
/// Usage: `if (!result) return result.error(); use(*result);`
template<class T>
class [[nodiscard]] Result {
public:
    Result(T value)
        : mState(std::in_place_index<0>, std::move(value)) {}
    Result(Error error)
        : mState(std::in_place_index<1>, std::move(error)) {}

    [[nodiscard]] bool hasValue() const { return mState.index() == 0; }
    explicit operator bool() const { return hasValue(); }

    /// The value; calling it on an error is a programming mistake (asserted).
    [[nodiscard]] T& value() & { return checked(); }
    [[nodiscard]] const T& value() const& { return const_cast<Result*>(this)->checked(); }
    [[nodiscard]] T&& value() && { return std::move(checked()); }
    [[nodiscard]] T& operator*() & { return checked(); }
    [[nodiscard]] const T& operator*() const& { return value(); }
    [[nodiscard]] T&& operator*() && { return std::move(checked()); }
    [[nodiscard]] T* operator->() { return &checked(); }
    [[nodiscard]] const T* operator->() const { return &value(); }

    /// The error; calling it on a value is a programming mistake (asserted).
    [[nodiscard]] const Error& error() const {
        assert(!hasValue() && "Result::error() on a value");
        return *std::get_if<1>(&mState);
    }

private:
    T& checked() {
        assert(hasValue() && "Result::value() on an error");
        return *std::get_if<0>(&mState);
    }

    std::variant<T, Error> mState;
};

/// Success, or the Error that prevented it.
template<>
class [[nodiscard]] Result<void> {
public:
    Result() = default;
    Result(Error error)
        : mError(std::move(error))
        , mFailed(true) {}

    [[nodiscard]] bool hasValue() const { return !mFailed; }
    explicit operator bool() const { return hasValue(); }
    [[nodiscard]] const Error& error() const {
        assert(mFailed && "Result::error() on a value");
        return mError;
    }

private:
    Error mError;
    bool mFailed = false;
};

} // namespace lamina
