#include "support/tool_process.hpp"

#include <gtest/gtest.h>

#include <array>
#include <csignal>
#include <cstdio>
#include <cstdlib>

#include <fcntl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

namespace lamina::test {
namespace {

std::string content(std::FILE* file) {
    std::rewind(file);
    std::string text;
    std::array<char, 4096> buffer{};
    while (const std::size_t count = std::fread(buffer.data(), 1, buffer.size(), file))
        text.append(buffer.data(), count);
    std::fclose(file);
    return text;
}

int openTerminal() {
    const int terminal = posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC);
    EXPECT_TRUE(terminal >= 0 && grantpt(terminal) == 0 && unlockpt(terminal) == 0);
    return terminal;
}

/// All that is written to the terminal until nobody holds it any more.
std::string drain(int terminal) {
    std::string text;
    std::array<char, 4096> buffer{};
    ssize_t count = 0;
    while ((count = read(terminal, buffer.data(), buffer.size())) > 0)
        text.append(buffer.data(), static_cast<std::size_t>(count));
    close(terminal);
    return text;
}

[[noreturn]] void becomeTool(const std::vector<std::string>& arguments, const ToolOptions& options,
                             int out, int err, int terminal) {
    const char* const name = terminal >= 0 ? ptsname(terminal) : nullptr;
    dup2(out, STDOUT_FILENO);
    dup2(name ? open(name, O_RDWR | O_NOCTTY) : err, STDERR_FILENO);
    if (options.maxFileBytes != 0) {
        const rlimit limit{options.maxFileBytes, options.maxFileBytes};
        setrlimit(RLIMIT_FSIZE, &limit);
    }
    // A test driver may run in the background, where these are ignored.
    for (const int number : {SIGINT, SIGTERM, SIGHUP})
        std::signal(number, SIG_DFL);
    setenv("TERM", "xterm", 1);
    std::vector<char*> pointers{const_cast<char*>(LAMINA_TOOL)};
    for (const std::string& argument : arguments)
        pointers.push_back(const_cast<char*>(argument.c_str()));
    pointers.push_back(nullptr);
    execv(LAMINA_TOOL, pointers.data());
    _exit(127);
}

} // namespace

ToolResult runTool(const std::vector<std::string>& arguments, const ToolOptions& options) {
    std::FILE* const out = std::tmpfile();
    std::FILE* const err = std::tmpfile();
    const int terminal = options.errorIsTerminal ? openTerminal() : -1;
    const pid_t process = fork();
    if (process == 0)
        becomeTool(arguments, options, fileno(out), fileno(err), terminal);
    if (options.whileRunning)
        options.whileRunning(process);

    ToolResult result;
    if (terminal >= 0) {
        result.err = drain(terminal);
        std::fclose(err);
    }
    int status = 0;
    EXPECT_EQ(waitpid(process, &status, 0), process);
    result.exitCode = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
    result.signal = WIFSIGNALED(status) ? WTERMSIG(status) : 0;
    result.out = content(out);
    if (terminal < 0)
        result.err = content(err);
    return result;
}

} // namespace lamina::test
