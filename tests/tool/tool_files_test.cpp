#include "support/mesh_files.hpp"
#include "support/npy_array.hpp"
#include "support/temporary_folder.hpp"
#include "support/tool_process.hpp"

#include <lamina/grid_io/grid_file.hpp>

#include <reference/shapes.hpp>

#include <gmock/gmock.h>

#include <chrono>
#include <csignal>
#include <filesystem>
#include <thread>

namespace lamina::test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::StartsWith;

class ToolFiles : public testing::Test {
protected:
    ToolFiles() { writePly(mesh, reference::makeIcosphere({0, 0, 0}, 1, 3)); }

    TemporaryFolder folder;
    std::string mesh = folder / "ball.ply";
};

TEST_F(ToolFiles, SeveralOutputsHoldTheSameVoxels) {
    std::vector<std::string> arguments{mesh,
                                       "-r",
                                       "40",
                                       "-o",
                                       folder / "a.npy",
                                       "--output",
                                       folder / "B.BINVOX",
                                       "-o",
                                       folder / "c.vox",
                                       "-o",
                                       folder / "d.vti"};
    if (canWrite(GridFormat::Vdb))
        arguments.insert(arguments.end(), {"-o", folder / "e.vdb"});
    const ToolResult result = runTool(arguments);
    ASSERT_EQ(result.exitCode, 0) << result.err;
    const NpyArray array = readNpyArray(folder / "a.npy");
    const auto binvox = readGrid(folder / "B.BINVOX");
    ASSERT_TRUE(binvox.hasValue()) << binvox.error().text;
    EXPECT_EQ(binvox->count(), array.setCount());
    EXPECT_THAT(readBytes(folder / "c.vox"), StartsWith("VOX "));
    EXPECT_THAT(readBytes(folder / "d.vti"), HasSubstr("ImageData"));
    EXPECT_EQ(folder.names().size(), canWrite(GridFormat::Vdb) ? 6u : 5u);
}

TEST_F(ToolFiles, ExistingFilesAreReplacedAndLinksFollowed) {
    writeBytes(folder / "old.npy", "old");
    std::filesystem::create_symlink(folder / "old.npy", folder / "link.npy");
    ASSERT_EQ(runTool({mesh, "-r", "4", "-o", folder / "link.npy"}).exitCode, 0);
    EXPECT_TRUE(std::filesystem::is_symlink(folder / "link.npy"));
    EXPECT_EQ(readNpyArray(folder / "old.npy").counts, glm::uvec3(4));
}

TEST_F(ToolFiles, WhatDoesNotFitLeavesTheOldFile) {
    writeBytes(folder / "ball.npy", "old");
    ToolOptions options;
    options.maxFileBytes = 100000;
    const ToolResult result = runTool({mesh, "-r", "64", "-o", folder / "ball.npy"}, options);
    EXPECT_EQ(result.exitCode, 1);
    EXPECT_THAT(result.err, HasSubstr("File too large"));
    EXPECT_EQ(readBytes(folder / "ball.npy"), "old");
    EXPECT_THAT(folder.names(), ElementsAre("ball.npy", "ball.ply"));
}

TEST_F(ToolFiles, StandardOutputThatTakesNothingIsAFailure) {
    ToolOptions options;
    options.maxFileBytes = 10;
    const ToolResult result = runTool({mesh, "-r", "4", "--info"}, options);
    EXPECT_EQ(result.exitCode, 1);
}

/// Sends `signal` as soon as a hidden (temporary) file in `folder` has some size.
void signalWhileWriting(pid_t process, int signal, const TemporaryFolder& folder) {
    const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(60);
    while (std::chrono::steady_clock::now() < deadline) {
        for (const std::string& name : folder.names()) {
            std::error_code gone;
            const auto bytes = std::filesystem::file_size(folder / name, gone);
            if (name.front() == '.' && !gone && bytes > 0) {
                kill(process, signal);
                return;
            }
        }
        std::this_thread::sleep_for(std::chrono::microseconds(200));
    }
    ADD_FAILURE() << "no temporary file seen";
}

TEST_F(ToolFiles, SignalsEndWritingAndLeaveNoFile) {
    for (const int signal : {SIGINT, SIGTERM}) {
        ToolOptions options;
        options.whileRunning = [&](pid_t process) { signalWhileWriting(process, signal, folder); };
        const ToolResult result = runTool(
            {mesh, "-r", "700", "-o", folder / "ball.npy", "-o", folder / "later.npy"}, options);
        EXPECT_EQ(result.signal, signal) << "exit code " << result.exitCode << result.err;
        for (const std::string& name : folder.names())
            EXPECT_NE(name.front(), '.') << name;
        // 343 MB are not written to the end.
        EXPECT_FALSE(std::filesystem::exists(folder / "ball.npy"));
        EXPECT_FALSE(std::filesystem::exists(folder / "later.npy"));
    }
}

} // namespace
} // namespace lamina::test
