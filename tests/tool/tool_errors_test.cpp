#include "support/mesh_files.hpp"
#include "support/temporary_folder.hpp"
#include "support/tool_process.hpp"

#include <reference/shapes.hpp>

#include <gmock/gmock.h>

#include <algorithm>
#include <filesystem>
#include <limits>

namespace lamina::test {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;
using testing::StartsWith;

enum Exit { kFailed = 1, kCommandLine = 2, kBadMesh = 3, kUnsupported = 4 };

class ToolErrors : public testing::Test {
protected:
    ToolErrors() {
        writePly(mesh, reference::makeIcosphere({0, 0, 0}, 1, 2));
        std::filesystem::create_directory(folder / "folder.npy");
        mBefore = folder.names();
    }

    /// The tool fails with this code and one line that holds each of `texts`, prints nothing else
    /// and leaves no new file.
    void expectFailure(const std::vector<std::string>& arguments, Exit code,
                       const std::vector<std::string>& texts) {
        const ToolResult result = runTool(arguments);
        SCOPED_TRACE(testing::PrintToString(arguments));
        EXPECT_EQ(result.exitCode, static_cast<int>(code)) << result.err;
        EXPECT_THAT(result.out, IsEmpty());
        EXPECT_THAT(result.err, StartsWith("lamina-voxelize: error: "));
        EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
        for (const std::string& text : texts)
            EXPECT_THAT(result.err, HasSubstr(text));
        EXPECT_EQ(folder.names(), mBefore);
    }

    /// As expectFailure(), for a mesh file of this content.
    void expectBadMesh(const std::string& name, const std::string& content,
                       const std::vector<std::string>& texts) {
        writeBytes(folder / name, content);
        mBefore = folder.names();
        expectFailure({folder / name, "-r", "8", "-o", out}, kBadMesh, texts);
    }

    TemporaryFolder folder;
    std::string mesh = folder / "ball.ply";
    std::string out = folder / "ball.npy";

private:
    std::vector<std::string> mBefore;
};

TEST_F(ToolErrors, CommandLine) {
    expectFailure({}, kCommandLine, {"expected a mesh file", "--help"});
    expectFailure({"-o", out}, kCommandLine, {"expected a mesh file"});
    expectFailure({mesh}, kCommandLine, {"nothing to make", "-o FILE"});
    expectFailure({mesh, mesh, "-o", out}, kCommandLine, {"not expected", mesh});
    expectFailure({mesh, "--bogus", "-o", out}, kCommandLine, {"--bogus", "--help"});
    expectFailure({mesh, "-o"}, kCommandLine, {"--output"});
    expectFailure({mesh, "-o", out, "--quiet", "--verbose"}, kCommandLine,
                  {"--quiet", "--verbose"});
    expectFailure({mesh, "--info", "-o", out}, kCommandLine, {"--info", "--output"});
}

TEST_F(ToolErrors, Numbers) {
    for (const char* bad : {"0", "-5", "1.5", "abc", "", "99999999999", "0x10"})
        expectFailure({mesh, "-r", bad, "-o", out}, kCommandLine,
                      {"--resolution", "whole number from 1", std::string("'") + bad + "'"});
    for (const char* bad : {"0", "-1", "nan", "inf", "1m", "1e999"})
        expectFailure({mesh, "--voxel-size", bad, "-o", out}, kCommandLine,
                      {"--voxel-size", "positive number", bad});
    expectFailure(
        {mesh, "--bounds", "0", "0", "0", "1", "nan", "1", "--grid", "2", "2", "2", "-o", out},
        kCommandLine, {"--bounds", "finite number", "nan"});
    expectFailure({mesh, "--bounds", "0", "0", "0", "1", "1", "--grid", "2", "2", "2", "-o", out},
                  kCommandLine, {"--bounds", "--grid"});
    expectFailure(
        {mesh, "--bounds", "0", "0", "0", "1", "1", "1", "--grid", "2", "0", "2", "-o", out},
        kCommandLine, {"--grid", "from 1"});
    expectFailure(
        {mesh, "-o", out, "--preview", folder / "a.png", "--preview-size", "100", "20000"},
        kCommandLine, {"--preview-size", "16384"});
    expectFailure({mesh, "--memory-limit", "-1", "-o", out}, kCommandLine, {"--memory-limit"});
}

TEST_F(ToolErrors, ConflictsAndMissingPartners) {
    const std::vector<std::string> box{"--bounds", "0", "0", "0", "1", "1", "1"};
    const std::vector<std::string> grid{"--grid", "2", "2", "2"};
    const auto with = [&](std::vector<std::string> arguments,
                          const std::vector<std::vector<std::string>>& more) {
        for (const auto& part : more)
            arguments.insert(arguments.end(), part.begin(), part.end());
        return arguments;
    };
    expectFailure({mesh, "-r", "8", "--voxel-size", "1", "-o", out}, kCommandLine,
                  {"--resolution", "--voxel-size"});
    expectFailure(with({mesh, "-r", "8", "-o", out}, {box, grid}), kCommandLine, {"--resolution"});
    expectFailure(with({mesh, "--voxel-size", "1", "-o", out}, {box, grid}), kCommandLine,
                  {"--voxel-size"});
    expectFailure(with({mesh, "-o", out}, {box}), kCommandLine, {"--bounds", "--grid"});
    expectFailure(with({mesh, "-o", out}, {grid}), kCommandLine, {"--grid", "--bounds"});
    expectFailure({mesh, "-r", "8", "-r", "9", "-o", out}, kCommandLine, {"--resolution"});
    expectFailure({mesh, "-o", out, "--view", "0", "0", "1"}, kCommandLine,
                  {"--view", "--preview"});
    expectFailure({mesh, "-o", out, "--preview-size", "8", "8"}, kCommandLine,
                  {"--preview-size", "--preview"});
    expectFailure({mesh, "--preview", folder / "a.png", "--view", "0", "0", "0"}, kCommandLine,
                  {"--view", "direction"});
}

TEST_F(ToolErrors, BoxWithoutSize) {
    for (const char* high : {"0", "-1"})
        expectFailure(
            {mesh, "--bounds", "0", "0", "0", "1", high, "1", "--grid", "2", "2", "2", "-o", out},
            kCommandLine, {"--bounds", "low corner below the high corner", "Y1"});
}

TEST_F(ToolErrors, Words) {
    expectFailure({mesh, "--coverage", "most", "-o", out}, kCommandLine,
                  {"--coverage", "sampled, filled, conservative", "'most'"});
    expectFailure({mesh, "--backend", "cpu", "-o", out}, kCommandLine, {"--backend", "slicemap"});
    expectFailure({mesh, "--context", "glx", "-o", out}, kCommandLine,
                  {"--context", "egl, osmesa"});
    expectFailure({mesh, "--axis", "w", "-o", out}, kCommandLine, {"--axis", "x, y, z"});
    expectFailure({mesh, "--up", "auto", "-o", out}, kCommandLine, {"--up", "x, y, z"});
}

TEST_F(ToolErrors, MethodsThatDoNotFitSayWhatIsServed) {
    expectFailure({mesh, "--backend", "slicemap", "--coverage", "separating6", "-o", out},
                  kUnsupported, {"separating6", "slicemap", "overlap"});
    expectFailure({mesh, "--backend", "local_slicemap", "--coverage", "solid", "-o", out},
                  kUnsupported, {"solid", "conservative or filled", "overlap"});
}

TEST_F(ToolErrors, OutputsAreCheckedBeforeTheMeshIsRead) {
    const std::string missing = folder / "missing.ply";
    expectFailure({missing, "-o", folder / "ball.foo"}, kCommandLine, {"ball.foo", ".npy", ".vdb"});
    expectFailure({missing, "-o", folder / "ball"}, kCommandLine, {"-o", ".npy"});
    expectFailure({missing, "--preview", folder / "ball.jpg"}, kCommandLine,
                  {"--preview", ".png", ".jpg"});
    expectFailure({missing, "-o", folder / "no/where/ball.npy"}, kFailed,
                  {"existing directory", "no/where"});
    expectFailure({missing, "-o", folder / "folder.npy"}, kFailed, {"folder.npy", "directory"});
    expectFailure({missing, "-o", "/sys/ball.npy"}, kFailed, {"/sys/ball.npy", "found: "});
    expectFailure({missing, "--stats", folder / "no/where.json"}, kFailed,
                  {"--stats", "directory"});
    expectFailure({missing, "-o", out, "-o", folder / "folder.npy/../ball.npy"}, kCommandLine,
                  {"the same file as"});
    expectFailure({missing, "--stats", folder / "a.png", "--preview", folder / "a.png"},
                  kCommandLine, {"the same file as"});
    expectFailure({mesh, "--stats", mesh}, kCommandLine, {"--stats", "this is the mesh file"});
    std::filesystem::create_symlink(folder / "ball.ply", folder / "folder.npy/link.npy");
    expectFailure({mesh, "-o", folder / "folder.npy/link.npy"}, kCommandLine,
                  {"this is the mesh file"});
    expectFailure({missing, "--bounds", "0", "0", "0", "1", "1", "2", "--grid", "4", "4", "4", "-o",
                   folder / "a.binvox"},
                  kUnsupported, {".binvox", "cubic", "0.25, 0.25, 0.5"});
    expectFailure({missing, "-o", out}, kBadMesh, {"missing.ply"});
}

TEST_F(ToolErrors, MeshFiles) {
    expectFailure({folder / "missing.ply", "-o", out}, kBadMesh, {"missing.ply"});
    expectFailure({folder.path().string(), "-o", out}, kBadMesh, {folder.path().string()});
    expectBadMesh("mesh.xyz", "0 0 0", {"mesh.xyz", "xyz"});
    expectBadMesh("empty.ply", "", {"empty.ply", "empty file"});
    expectBadMesh("empty.obj", "", {"empty.obj", "empty file"});
    expectBadMesh("points.obj", "v 0 0 0\nv 1 0 0\n", {"points.obj", "triangle"});
    expectBadMesh("index.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 4\n", {"index.obj", "4"});
    expectBadMesh("nan.obj", "v 0 0 0\nv 1 nan 0\nv 0 1 0\nf 1 2 3\n", {"nan.obj"});
    const std::string whole = readBytes(mesh);
    expectBadMesh("short.ply", whole.substr(0, whole.size() - 7), {"short.ply"});

    TriangleMesh broken = reference::makeCube({0, 0, 0}, 1);
    broken.positions[3].y = std::numeric_limits<float>::quiet_NaN();
    writePly(folder / "nan.ply", broken);
    expectBadMesh("nan.ply", readBytes(folder / "nan.ply"), {"nan.ply", "finite"});
}

TEST_F(ToolErrors, AdviceIsInTheWordsOfTheCommandLine) {
    const auto expect = [&](const std::vector<std::string>& options, const std::string& advice) {
        std::vector<std::string> arguments{mesh, "-r", "8", "-o", out};
        arguments.insert(arguments.end(), options.begin(), options.end());
        expectFailure(arguments, kUnsupported, {advice});
        EXPECT_THAT(runTool(arguments).err, testing::Not(HasSubstr("::")));
    };
    expect({"--coverage", "solid", "--solid-rule", "voted", "--backend", "mrt_slicemap"},
           "use --backend auto or overlap, or --solid-rule parity");
    expect({"--coverage", "filled", "--backend", "overlap"}, "use --backend auto or mrt_slicemap");
    expect({"--coverage", "solid", "--backend", "local_slicemap"}, "--backend auto (overlap)");
}

TEST_F(ToolErrors, MeshInOnePoint) {
    expectBadMesh("point.obj", "v 1 2 3\nv 1 2 3\nv 1 2 3\nf 1 2 3\n", {"(1, 2, 3)", "extent"});
}

TEST_F(ToolErrors, GridsOverALimit) {
    expectFailure({mesh, "-r", "100000", "-o", out}, kUnsupported,
                  {"100000 x", "MiB", "--memory-limit"});
    expectFailure({mesh, "-r", "128", "--memory-limit", "0.4", "-o", out}, kUnsupported,
                  {"128 x 128 x 128", "1 MiB", "at most 0 MiB"});
    expectFailure(
        {mesh, "-r", "128", "--memory-limit", "1", "--attributes", "normal", "-o", out},
        kUnsupported,
        {"plan grid: 128 x 128 x 128", "for the attributes of about", "--attributes none"});
    expectFailure({mesh, "--voxel-size", "1e-9", "-o", out}, kUnsupported, {"larger voxel size"});
    // Small in memory, but longer than any texture.
    expectFailure({mesh, "--bounds", "-1", "-1", "-1", "1", "1", "1", "--grid", "200000", "1", "1",
                   "--axis", "z", "--coverage", "filled", "-o", out},
                  kUnsupported, {"200000 x 1 x 1", "limit"});
}

} // namespace
} // namespace lamina::test
