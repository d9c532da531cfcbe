#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include <sys/types.h>

namespace lamina::test {

struct ToolOptions {
    bool errorIsTerminal = false;   ///< Standard error is a pseudo terminal instead of a file.
    std::uint64_t maxFileBytes = 0; ///< RLIMIT_FSIZE; 0: as inherited.
    /// Called once with the process while it runs.
    std::function<void(pid_t)> whileRunning;
};

struct ToolResult {
    int exitCode = -1; ///< -1: ended by `signal`.
    int signal = 0;
    std::string out; ///< Standard output.
    std::string err; ///< Standard error.
};

/// Runs lamina-voxelize with these arguments and waits for it.
ToolResult runTool(const std::vector<std::string>& arguments, const ToolOptions& options = {});

} // namespace lamina::test
