#include "support/mesh_files.hpp"
#include "support/npy_array.hpp"
#include "support/temporary_folder.hpp"
#include "support/tool_process.hpp"

#include <lamina/grid_io/grid_file.hpp>
#include <lamina/grid_io/image.hpp>

#include <reference/shapes.hpp>

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include <cstring>

namespace lamina::test {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;
using testing::StartsWith;

/// The rows of a .npy file of our own writing, header checked as text.
template<class Row>
std::vector<Row> readRows(const std::string& file, const std::string& header) {
    const std::string bytes = readBytes(file);
    EXPECT_THAT(bytes.substr(0, 128), HasSubstr(header)) << file;
    const std::size_t begin = bytes.find('\n') + 1;
    std::vector<Row> rows((bytes.size() - begin) / sizeof(Row));
    std::memcpy(rows.data(), bytes.data() + begin, rows.size() * sizeof(Row));
    return rows;
}

class ToolAttributes : public testing::Test {
protected:
    ToolAttributes() {
        // Red below z = 0, blue above; each triangle of one colour.
        TriangleMesh box = reference::makeBox({-1, -1, -1}, {1, 1, 0});
        const TriangleMesh top = reference::makeBox({-1, -1, 0.25f}, {1, 1, 1});
        box.colors.assign(box.positions.size(), {1, 0, 0, 1});
        for (const glm::uvec3& triangle : top.triangles)
            box.triangles.push_back(triangle + static_cast<std::uint32_t>(box.positions.size()));
        box.positions.insert(box.positions.end(), top.positions.begin(), top.positions.end());
        box.colors.resize(box.positions.size(), {0, 0, 1, 1});
        writePly(painted, box);
        box.colors.clear();
        writePly(plain, box);
    }

    TemporaryFolder folder;
    std::string painted = folder / "painted.ply";
    std::string plain = folder / "plain.ply";
};

TEST_F(ToolAttributes, RowsBesideAnArrayAreTheSetVoxelsInOrder) {
    const ToolResult result = runTool({painted, "-r", "16", "--attributes", "color,normal", "-o",
                                       folder / "a.npy", "--stats", "-"});
    ASSERT_EQ(result.exitCode, 0) << result.err;
    EXPECT_THAT(result.err, IsEmpty());
    const NpyArray array = readNpyArray(folder / "a.npy");
    const std::string count = std::to_string(array.setCount());
    const auto colors = readRows<glm::u8vec4>(
        folder / "a.color.npy", "'|u1', 'fortran_order': False, 'shape': (" + count + ", 4)");
    const auto normals = readRows<glm::vec3>(
        folder / "a.normal.npy", "'<f4', 'fortran_order': False, 'shape': (" + count + ", 3)");
    ASSERT_EQ(colors.size(), array.setCount());
    ASSERT_EQ(normals.size(), array.setCount());
    std::size_t row = 0;
    for (std::uint32_t k = 0; k < 16; ++k)
        for (std::uint32_t j = 0; j < 16; ++j)
            for (std::uint32_t i = 0; i < 16; ++i)
                if (array.at({i, j, k}) != 0) {
                    EXPECT_EQ(colors[row],
                              k < 9 ? glm::u8vec4(255, 0, 0, 255) : glm::u8vec4(0, 0, 255, 255))
                        << i << ' ' << j << ' ' << k;
                    if (k == 0 && i > 0 && i < 15 && j > 0 && j < 15) {
                        EXPECT_NEAR(normals[row].z, -1.0f, 1e-4f);
                    }
                    ++row;
                }
    const auto json = nlohmann::json::parse(result.out);
    EXPECT_EQ(json["voxels"]["attributes"], nlohmann::json({"color", "normal"}));
    EXPECT_EQ(json["mesh"]["colors"], true);
    EXPECT_EQ(json["files"].size(), 3u);
    EXPECT_TRUE(json["milliseconds"].contains("attributes"));
}

TEST_F(ToolAttributes, ColoursOfTheMeshAreKeptUnasked) {
    ASSERT_EQ(
        runTool({painted, "-r", "16", "-o", folder / "a.vox", "-o", folder / "a.npy", "--preview",
                 folder / "a.png", "--preview-size", "64", "64", "--stats", folder / "a.json"})
            .exitCode,
        0);
    // The palette begins with red (low bytes first) and blue.
    const std::string vox = readBytes(folder / "a.vox");
    const std::size_t palette = vox.find("RGBA");
    ASSERT_NE(palette, std::string::npos);
    EXPECT_EQ(vox.substr(palette + 12, 8), std::string("\xff\x00\x00\xff\x00\x00\xff\xff", 8));
    // No further file beside the array unless asked for.
    EXPECT_FALSE(std::filesystem::exists(folder / "a.color.npy"));
    const Image image = readPng(folder / "a.png").value();
    bool red = false, blue = false;
    for (std::uint32_t y = 0; y < 64; ++y)
        for (std::uint32_t x = 0; x < 64; ++x) {
            const auto pixel = image.pixel(x, y);
            red = red || (pixel[0] > 100 && pixel[2] < 20);
            blue = blue || (pixel[2] > 100 && pixel[0] < 20);
        }
    EXPECT_TRUE(red && blue);
    EXPECT_EQ(nlohmann::json::parse(readBytes(folder / "a.json"))["voxels"]["attributes"],
              nlohmann::json({"color"}));

    ASSERT_EQ(
        runTool({painted, "-r", "16", "--attributes", "none", "-o", folder / "b.vox"}).exitCode, 0);
    const std::string grey = readBytes(folder / "b.vox");
    EXPECT_EQ(grey.substr(grey.find("RGBA") + 12, 4), "\xe8\x8d\x52\xff");
}

TEST_F(ToolAttributes, TheInsideOfSolidsTakesTheNearestColour) {
    const ToolResult result =
        runTool({painted, "-r", "16", "--coverage", "solid", "--attributes", "color,normal", "-o",
                 folder / "a.npy", "-o", folder / "a.vox"});
    ASSERT_EQ(result.exitCode, 0) << result.err;
    const NpyArray array = readNpyArray(folder / "a.npy");
    const auto colors = readRows<glm::u8vec4>(folder / "a.color.npy", "'|u1'");
    const auto normals = readRows<glm::vec3>(folder / "a.normal.npy", "'<f4'");
    ASSERT_EQ(colors.size(), array.setCount());
    ASSERT_EQ(normals.size(), array.setCount());
    // Each of the two boxes is of one colour through and through.
    std::size_t inner = 0;
    std::size_t row = 0;
    for (std::uint32_t k = 0; k < 16; ++k)
        for (std::uint32_t j = 0; j < 16; ++j)
            for (std::uint32_t i = 0; i < 16; ++i)
                if (array.at({i, j, k}) != 0) {
                    EXPECT_EQ(colors[row],
                              k < 8 ? glm::u8vec4(255, 0, 0, 255) : glm::u8vec4(0, 0, 255, 255))
                        << i << ' ' << j << ' ' << k;
                    inner += normals[row] == glm::vec3(0.0f) ? 1 : 0;
                    ++row;
                }
    // More voxels have no surface in them than have.
    EXPECT_GT(2 * inner, row);
}

TEST_F(ToolAttributes, FormatsAndMeshesWithoutAreToldOf) {
    ToolResult result = runTool({painted, "-r", "16", "--attributes", "color,normal", "-o",
                                 folder / "a.binvox", "-o", folder / "a.vox"});
    EXPECT_EQ(result.exitCode, 0);
    EXPECT_THAT(result.err, AllOf(HasSubstr(".binvox files hold no colours and no normals"),
                                  HasSubstr(".vox files hold no normals")));
    result = runTool({plain, "-r", "16", "--attributes", "color", "-o", folder / "b.vox"});
    EXPECT_EQ(result.exitCode, 0);
    EXPECT_THAT(result.err, HasSubstr("the mesh has no colours: voxels are white"));
    result = runTool({painted, "-r", "16", "-o", folder / "c.binvox"});
    EXPECT_THAT(result.err, IsEmpty());
    result = runTool({painted, "-r", "16", "-o", folder / "c.vox"});
    EXPECT_THAT(result.err, IsEmpty());
    result = runTool({painted, "--bounds", "-2", "-2", "-2", "2", "2", "2", "--grid", "16", "16",
                      "8", "-o", folder / "d.vox"});
    EXPECT_EQ(result.exitCode, 0);
    EXPECT_THAT(result.err, AllOf(HasSubstr("d.vox: .vox files show cubes"),
                                  HasSubstr("0.25, 0.25, 0.5: the shape is distorted")));
}

TEST_F(ToolAttributes, BadRequestsAreRefusedBeforeWork) {
    ToolResult result = runTool({painted, "--attributes", "colour", "-o", folder / "a.vox"});
    EXPECT_EQ(result.exitCode, 2);
    EXPECT_THAT(result.err, HasSubstr("expected auto, none, color, normal or color,normal, found "
                                      "'colour'"));
    result = runTool(
        {painted, "--attributes", "color", "-o", folder / "a.npy", "-o", folder / "a.color.npy"});
    EXPECT_EQ(result.exitCode, 2);
    EXPECT_THAT(result.err, HasSubstr("the same file as"));
}

} // namespace
} // namespace lamina::test
