#include "support/mesh_files.hpp"
#include "support/temporary_folder.hpp"
#include "support/tool_process.hpp"

#include <lamina/core/version.hpp>
#include <lamina/grid_io/image.hpp>

#include <reference/shapes.hpp>

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cstdlib>
#include <sstream>

namespace lamina::test {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

class ToolInterface : public testing::Test {
protected:
    ToolInterface() { writePly(mesh, reference::makeIcosphere({0, 0, 0}, 1, 2)); }

    TemporaryFolder folder;
    std::string mesh = folder / "ball.ply";
    std::string voxels = folder / "ball.npy";
};

TEST_F(ToolInterface, HelpNamesEveryOptionWordAndExitCode) {
    const ToolResult help = runTool({"--help"});
    EXPECT_EQ(help.exitCode, 0);
    EXPECT_THAT(help.err, IsEmpty());
    for (const char* text : {"-r,--resolution N",
                             "--voxel-size H",
                             "--bounds X0 Y0 Z0 X1 Y1 Z1",
                             "--grid NX NY NZ",
                             "--axis",
                             "--memory-limit MIB",
                             "--coverage",
                             "--attributes LIST",
                             "--backend",
                             "--context",
                             "-o,--output FILE",
                             "--preview FILE.png",
                             "--view X Y Z",
                             "--preview-size W H",
                             "--up",
                             "--stats FILE.json|-",
                             "-q,--quiet",
                             "-v,--verbose",
                             "--info",
                             "--compare",
                             "--list-contexts",
                             "--version",
                             "-h,--help",
                             "sampled",
                             "filled",
                             "conservative",
                             "separating6",
                             "solid",
                             "--solid-rule",
                             "parity",
                             "voted",
                             "flood",
                             "slicemap",
                             "local_slicemap",
                             "mrt_slicemap",
                             "volume",
                             "overlap",
                             "egl",
                             "osmesa",
                             ".npy",
                             ".binvox",
                             ".vox",
                             ".vti",
                             ".vdb",
                             "Exit codes",
                             "Examples",
                             "default 256",
                             "a[k][j][i]",
                             "mesh's units"})
        EXPECT_THAT(help.out, HasSubstr(text));
    EXPECT_THAT(help.out, HasSubstr(".off\n\nGrid:\n"));
    EXPECT_THAT(help.out, Not(HasSubstr("\n\n\n")));
    std::size_t longest = 0;
    std::istringstream lines(help.out);
    for (std::string line; std::getline(lines, line);)
        longest = std::max(longest, line.size());
    EXPECT_LE(longest, 102u);
    EXPECT_EQ(runTool({"-h"}).out, help.out);
}

TEST_F(ToolInterface, VersionIsTheLibrarys) {
    const ToolResult version = runTool({"--version"});
    EXPECT_EQ(version.exitCode, 0);
    EXPECT_EQ(version.out, "lamina-voxelize " LAMINA_VERSION_STRING "\n");
}

TEST_F(ToolInterface, SilentWhenPiped) {
    const ToolResult result = runTool({mesh, "-r", "20", "-o", voxels, "--preview",
                                       folder / "ball.png", "--preview-size", "40", "30"});
    EXPECT_EQ(result.exitCode, 0);
    EXPECT_THAT(result.out, IsEmpty());
    EXPECT_THAT(result.err, IsEmpty());
}

TEST_F(ToolInterface, TerminalShowsProgressAndSummary) {
    ToolOptions terminal;
    terminal.errorIsTerminal = true;
    const ToolResult result = runTool({mesh, "-r", "20", "-o", voxels}, terminal);
    EXPECT_EQ(result.exitCode, 0);
    EXPECT_THAT(result.out, IsEmpty());
    for (const char* text : {"reading ball.ply", "voxelizing", "writing ball.npy", "%",
                             "320 triangles", "20 x 20 x 20 voxels", "set (", "renderer", "total"})
        EXPECT_THAT(result.err, HasSubstr(text));
}

TEST_F(ToolInterface, QuietIsSilentOnATerminalToo) {
    ToolOptions terminal;
    terminal.errorIsTerminal = true;
    for (const char* flag : {"-q", "--quiet"}) {
        const ToolResult result = runTool({mesh, "-r", "20", flag, "-o", voxels}, terminal);
        EXPECT_EQ(result.exitCode, 0);
        EXPECT_THAT(result.out + result.err, IsEmpty());
    }
}

TEST_F(ToolInterface, VerboseTellsWhenPiped) {
    const ToolResult result = runTool({mesh, "-r", "20", "-v", "-o", voxels});
    EXPECT_EQ(result.exitCode, 0);
    EXPECT_THAT(result.out, IsEmpty());
    for (const char* text : {"320 triangles", "20 x 20 x 20 voxels", "overlap", "wrote"})
        EXPECT_THAT(result.err, HasSubstr(text));
    EXPECT_THAT(result.err, Not(HasSubstr("\r")));
}

TEST_F(ToolInterface, StatsOnStandardOutputAreJsonAlone) {
    const ToolResult result = runTool({mesh, "-r", "20", "-o", voxels, "-o", folder / "ball.vox",
                                       "--preview", folder / "ball.png", "--preview-size", "32",
                                       "32", "--context", "osmesa", "--axis", "y", "--stats", "-"});
    ASSERT_EQ(result.exitCode, 0) << result.err;
    EXPECT_THAT(result.err, IsEmpty());
    const auto json = nlohmann::json::parse(result.out, nullptr, false);
    ASSERT_FALSE(json.is_discarded()) << result.out;

    EXPECT_EQ(json["tool"]["version"], LAMINA_VERSION_STRING);
    EXPECT_EQ(json["mesh"]["file"], mesh);
    EXPECT_EQ(json["mesh"]["bytes"], readBytes(mesh).size());
    EXPECT_EQ(json["mesh"]["triangles"], 320);
    EXPECT_EQ(json["mesh"]["vertices"], 162);
    EXPECT_EQ(json["mesh"]["watertight"], true);
    EXPECT_EQ(json["mesh"]["open_edges"], 0);
    EXPECT_EQ(json["mesh"]["components"], 1);
    EXPECT_EQ(json["grid"]["size"], nlohmann::json({20, 20, 20}));
    EXPECT_EQ(json["grid"]["bounds"]["min"], json["mesh"]["bounds"]["min"]);
    EXPECT_NEAR(json["grid"]["voxel_size"][1].get<double>(), 0.1, 1e-6);
    EXPECT_EQ(json["grid"]["axis"], "y");
    EXPECT_EQ(json["grid"]["axis_chosen_by"], "command line");
    EXPECT_GT(json["voxels"]["set"], 800);
    EXPECT_EQ(json["voxels"]["share"].get<double>(), json["voxels"]["set"].get<double>() / 8000);
    EXPECT_EQ(json["voxels"]["coverage"], "conservative");
    EXPECT_EQ(json["backend"]["name"], "overlap");
    EXPECT_THAT(json["backend"]["reason"].get<std::string>(), HasSubstr("conservative"));
    EXPECT_EQ(json["backend"]["passes"], 1);
    EXPECT_GT(json["backend"]["grid_bytes"], 20 * 20 * 16 - 1);
    EXPECT_EQ(json["renderer"]["context"], "osmesa");
    EXPECT_EQ(json["renderer"]["software"], true);
    EXPECT_THAT(json["renderer"]["version"].get<std::string>(), HasSubstr("4.5"));
    ASSERT_EQ(json["files"].size(), 3u);
    EXPECT_EQ(json["files"][0]["file"], voxels);
    EXPECT_EQ(json["files"][0]["format"], "npy");
    EXPECT_EQ(json["files"][0]["bytes"], readBytes(voxels).size());
    EXPECT_EQ(json["files"][1]["format"], "vox");
    EXPECT_EQ(json["files"][2]["format"], "png");
    double sum = 0;
    for (const char* stage : {"load", "inspect", "context", "programs", "upload", "voxelize",
                              "download", "write", "preview"}) {
        ASSERT_TRUE(json["milliseconds"].contains(stage)) << stage;
        sum += json["milliseconds"][stage].get<double>();
    }
    EXPECT_GT(sum, 0.0);
    EXPECT_LE(sum, json["milliseconds"]["total"].get<double>());
}

TEST_F(ToolInterface, StatsInAFileAndNothingElse) {
    const ToolResult result = runTool({mesh, "-r", "5", "--stats", folder / "ball.json"});
    EXPECT_EQ(result.exitCode, 0) << result.err;
    EXPECT_THAT(result.out + result.err, IsEmpty());
    const auto json = nlohmann::json::parse(readBytes(folder / "ball.json"), nullptr, false);
    ASSERT_FALSE(json.is_discarded());
    EXPECT_EQ(json["grid"]["axis_chosen_by"], "most columns covered");
    EXPECT_EQ(json["files"].size(), 0u);
}

TEST_F(ToolInterface, StatsNameFilesThatAreNoUtf8) {
    const std::string odd = folder / "b\xff.ply";
    std::filesystem::copy_file(mesh, odd);
    const ToolResult result = runTool({odd, "-r", "5", "--stats", "-"});
    EXPECT_EQ(result.exitCode, 0) << result.err;
    EXPECT_FALSE(nlohmann::json::parse(result.out, nullptr, false).is_discarded());
}

TEST_F(ToolInterface, InfoDescribesMeshAndGrid) {
    const ToolResult closed = runTool({mesh, "--info", "-r", "50"});
    EXPECT_EQ(closed.exitCode, 0) << closed.err;
    EXPECT_THAT(closed.out, testing::ContainsRegex("triangles +320\n"));
    EXPECT_THAT(closed.out, testing::ContainsRegex("watertight +yes\n"));
    EXPECT_THAT(closed.out, HasSubstr("50 x 50 x 50 voxels"));

    writePly(folder / "open.ply", reference::makePlane({0, 0, 0}, {0, 0, 1}, 1));
    const ToolResult open = runTool({folder / "open.ply", "--info"});
    EXPECT_THAT(open.out, testing::ContainsRegex("watertight +no\n"));
    EXPECT_THAT(open.out, HasSubstr("4 in 1 loops"));
    EXPECT_EQ(folder.names(), (std::vector<std::string>{"ball.ply", "open.ply"}));

    const ToolResult json = runTool({mesh, "--info", "--stats", "-"});
    EXPECT_FALSE(nlohmann::json::parse(json.out, nullptr, false).is_discarded()) << json.out;
}

TEST_F(ToolInterface, ContextListNamesEveryWay) {
    const ToolResult result = runTool({"--list-contexts"});
    EXPECT_EQ(result.exitCode, 0) << result.out;
    EXPECT_THAT(result.out, testing::ContainsRegex("osmesa +works: .*4\\.5"));
    EXPECT_THAT(result.out, testing::ContainsRegex("egl, [a-z]+ +works: .*"));
    EXPECT_EQ(std::count(result.out.begin(), result.out.end(), '\n'), 4);
}

/// Pixels of the picture that show voxels: background and shadow are nearly grey.
std::uint64_t colouredPixels(const Image& image) {
    std::uint64_t count = 0;
    for (std::size_t i = 0; i < image.rgba.size(); i += 4)
        count += std::abs(image.rgba[i] - image.rgba[i + 2]) > 40;
    return count;
}

TEST_F(ToolInterface, PreviewIsSeenFromTheAskedSide) {
    // A wall across x: broad seen from +x and -x, an edge seen from +y.
    writePly(folder / "wall.ply", reference::makeBox({-0.1f, -2, -2}, {0.1f, 2, 2}));
    const auto pictureFrom = [&](std::vector<std::string> view) {
        std::vector<std::string> arguments{
            folder / "wall.ply", "-r", "20", "--preview", folder / "wall.png",
            "--preview-size",    "80", "60", "--view"};
        arguments.insert(arguments.end(), view.begin(), view.end());
        const ToolResult result = runTool(arguments);
        EXPECT_EQ(result.exitCode, 0) << result.err;
        return *readPng(folder / "wall.png");
    };
    const Image front = pictureFrom({"1", "0", "0"});
    EXPECT_EQ(front.width, 80u);
    EXPECT_EQ(front.height, 60u);
    const Image side = pictureFrom({"0", "0", "-1"});
    EXPECT_GT(colouredPixels(front), 1000u);
    EXPECT_GT(colouredPixels(side), 20u);
    EXPECT_GT(colouredPixels(front), 5 * colouredPixels(side));
}

TEST_F(ToolInterface, ViewIsTheDirectionTowardsTheViewer) {
    // A small ball stands before the middle of a big wall on its +x side only.
    writePly(folder / "scene.ply",
             reference::merged(reference::makeBox({0, -2, -2}, {0.2f, 2, 2}),
                               reference::makeIcosphere({1.5f, 1.2f, 0}, 0.4f, 2)));
    std::vector<Image> pictures;
    for (const char* x : {"1", "-1"}) {
        const ToolResult result =
            runTool({folder / "scene.ply", "-r", "32", "--axis", "x", "--preview",
                     folder / "scene.png", "--preview-size", "64", "64", "--view", x, "0", "0"});
        ASSERT_EQ(result.exitCode, 0) << result.err;
        pictures.push_back(*readPng(folder / "scene.png"));
    }
    // Rows through the ball, columns across it: brightness varies only where the ball is seen.
    const auto contrast = [](const Image& image) {
        int least = 255;
        int most = 0;
        for (std::uint32_t x = 20; x < 44; ++x) {
            least = std::min(least, int{image.pixel(x, 20)[0]});
            most = std::max(most, int{image.pixel(x, 20)[0]});
        }
        return most - least;
    };
    EXPECT_GT(contrast(pictures[0]), 2 * contrast(pictures[1]));
}

TEST_F(ToolInterface, UpTurnsPicturesAndVoxFiles) {
    writePly(folder / "stick.ply", reference::makeBox({0, 0, 0}, {1, 1, 4}));
    std::vector<std::string> vox;
    std::vector<std::string> png;
    for (const char* up : {"y", "z"}) {
        ASSERT_EQ(runTool({folder / "stick.ply", "-r", "16", "-o", folder / "stick.vox", "--up", up,
                           "--preview", folder / "stick.png", "--preview-size", "32", "32"})
                      .exitCode,
                  0);
        vox.push_back(readBytes(folder / "stick.vox"));
        png.push_back(readBytes(folder / "stick.png"));
    }
    EXPECT_NE(vox[0], vox[1]);
    EXPECT_NE(png[0], png[1]);
    // The stick stands upright: SIZE x, y, z with z up in MagicaVoxel.
    const std::size_t size = vox[1].find("SIZE");
    ASSERT_NE(size, std::string::npos);
    EXPECT_EQ(vox[1][size + 12], 4);
    EXPECT_EQ(vox[1][size + 16], 4);
    EXPECT_EQ(vox[1][size + 20], 16);
}

} // namespace
} // namespace lamina::test
