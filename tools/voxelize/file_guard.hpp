#pragma once

#include <array>
#include <csignal>

namespace lamina::tool {

/// While a file is being made, signals that end the process wait: the temporary file is removed or
/// put in place first. Without a guard they end the process at once, as usual. One guard at a time.
/// Work that takes long asks isSignalled() and stops.
class FileGuard {
public:
    FileGuard();
    /// Ends the process here if a signal came meanwhile.
    ~FileGuard();
    FileGuard(const FileGuard&) = delete;
    FileGuard& operator=(const FileGuard&) = delete;

    /// Does a signal wait?
    [[nodiscard]] bool isSignalled() const;

private:
    static constexpr std::array kSignals{SIGINT, SIGTERM, SIGHUP};
    std::array<struct sigaction, kSignals.size()> mUsual{};
};

} // namespace lamina::tool
