#pragma once

#include "request.hpp"

#include <optional>

namespace lamina::tool {

/// Nothing if --help or --version was asked for and has been answered.
/// Throws Failure: BadCommandLine, Unsupported (a word of a later version).
[[nodiscard]] std::optional<Request> parseCommandLine(int argc, const char* const* argv);

} // namespace lamina::tool
