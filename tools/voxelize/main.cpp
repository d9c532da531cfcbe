#include "command_line.hpp"
#include "context_list.hpp"
#include "failure.hpp"
#include "run.hpp"

#include <csignal>
#include <cstdio>
#include <exception>
#include <new>

namespace {

using lamina::tool::ExitCode;

int fail(int status, const char* text) {
    std::fprintf(stderr, "lamina-voxelize: error: %s\n", text);
    return status;
}

} // namespace

int main(int argc, char** argv) {
    using namespace lamina::tool;
    // Past a file size limit write() then fails, and the temporary file is removed.
    std::signal(SIGXFSZ, SIG_IGN);
    try {
        const auto request = parseCommandLine(argc, argv);
        if (!request)
            return static_cast<int>(ExitCode::Success);
        if (request->listContexts)
            listContexts();
        else
            run(*request);
        return static_cast<int>(ExitCode::Success);
    } catch (const Failure& failure) {
        return fail(failure.status(), failure.what());
    } catch (const std::bad_alloc&) {
        return fail(static_cast<int>(ExitCode::Failed), "out of memory; use a coarser grid");
    } catch (const std::exception& error) {
        return fail(static_cast<int>(ExitCode::Failed), error.what());
    }
}
