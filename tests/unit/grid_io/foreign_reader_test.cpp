#include "grid_fixture.hpp"

#include <lamina/grid_io/grid_file.hpp>

#include <array>
#include <charconv>
#include <cstdio>
#include <sys/wait.h>

namespace lamina {
namespace {

using test::TemporaryFolder;

std::string exact(double value) {
    std::array<char, 32> text{};
    return {text.data(), std::to_chars(text.data(), text.data() + text.size(), value).ptr};
}

std::string quoted(const std::filesystem::path& path) {
    return "'" + path.string() + "'";
}

struct Outcome {
    int code = -1;
    std::string output;
};

Outcome runCommand(const std::string& command) {
    Outcome outcome;
    FILE* pipe = popen((command + " 2>&1").c_str(), "r");
    if (pipe == nullptr)
        return outcome;
    std::array<char, 512> buffer{};
    while (fgets(buffer.data(), buffer.size(), pipe) != nullptr)
        outcome.output += buffer.data();
    const int status = pclose(pipe);
    outcome.code = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
    return outcome;
}

struct Case {
    const char* name;
    glm::uvec3 counts;
    glm::dvec3 edge;
};

void PrintTo(const Case& value, std::ostream* stream) {
    *stream << value.name;
}

const Case kNonCubic{"NonCubicVoxels", {37, 70, 131}, {0.25, 0.125, 0.3}};
const Case kCubic{"CubicVoxels", {37, 70, 131}, {0.1, 0.1, 0.1}};
const Case kSingle{"SingleVoxel", {1, 1, 1}, {2.0, 2.0, 2.0}};
const Case kWordEdges{"WordEdges", {64, 33, 128}, {1.0, 1.0, 1.0}};
const Case kPast256{"Past256", {300, 20, 270}, {0.5, 0.5, 0.5}};
const Case kLong{"Long", {9, 600, 257}, {0.5, 0.5, 0.5}};

/// Every format, all that its grids may be, checked in full by a reader that is not ours.
class ForeignReader : public testing::TestWithParam<std::tuple<GridFormat, Case, Axis>> {
protected:
    Outcome check(const std::filesystem::path& file, const BitGrid& grid, const glm::uvec3& counts,
                  const char* up = "y") {
        const Box3& box = grid.transform().boxBounds();
        test::writeText(mFolder / "occupancy", test::occupancy(grid, counts));
        std::string command = quoted(LAMINA_TEST_PYTHON) + " " + quoted(LAMINA_TEST_GRID_CHECKER) +
                              " " + quoted(file) + " " + quoted(mFolder / "occupancy");
        for (int i = 0; i < 3; ++i)
            command += " " + std::to_string(counts[i]);
        for (int i = 0; i < 3; ++i)
            command += " " + exact(box.min[i]);
        for (int i = 0; i < 3; ++i)
            command += " " + exact(box.size()[i] / counts[i]);
        return runCommand(command + " " + up);
    }

    TemporaryFolder mFolder;
};

TEST_P(ForeignReader, FindsEveryVoxelInItsPlace) {
    const auto& [format, shape, axis] = GetParam();
    if (!canWrite(format))
        GTEST_SKIP() << "built without OpenVDB";
    if (std::string(LAMINA_TEST_PYTHON).empty())
        GTEST_SKIP() << "no python3 found when configured";
    const BitGrid grid =
        test::randomGrid(test::boxOf(shape.counts, shape.edge), shape.counts, axis);
    ASSERT_GT(grid.count(), 0u);
    const std::filesystem::path file = mFolder / ("grid." + std::string(name(format)));
    const auto written = writeGrid(file, grid);
    ASSERT_TRUE(written) << written.error().text;
    const Outcome outcome = check(file, grid, shape.counts);
    if (outcome.code == 77)
        GTEST_SKIP() << "reader not installed: " << outcome.output;
    EXPECT_EQ(outcome.code, 0) << outcome.output;
}

std::string caseName(const testing::TestParamInfo<ForeignReader::ParamType>& info) {
    const auto& [format, shape, axis] = info.param;
    return std::string(name(format)) + shape.name + "XYZ"[static_cast<int>(axis)];
}

const auto kAxes = testing::Values(Axis::X, Axis::Y, Axis::Z);

INSTANTIATE_TEST_SUITE_P(AnyVoxels, ForeignReader,
                         testing::Combine(testing::Values(GridFormat::Npy, GridFormat::Vti,
                                                          GridFormat::Vdb, GridFormat::Vox),
                                          testing::Values(kNonCubic, kSingle, kWordEdges), kAxes),
                         caseName);
INSTANTIATE_TEST_SUITE_P(CubicVoxels, ForeignReader,
                         testing::Combine(testing::Values(GridFormat::Binvox),
                                          testing::Values(kCubic, kSingle, kWordEdges), kAxes),
                         caseName);
INSTANTIATE_TEST_SUITE_P(SplitModels, ForeignReader,
                         testing::Combine(testing::Values(GridFormat::Vox),
                                          testing::Values(kPast256, kLong), kAxes),
                         caseName);

class ForeignVoxReader : public ForeignReader {};

TEST_P(ForeignVoxReader, FindsTheChosenAxisUp) {
    const auto& [format, shape, up] = GetParam();
    if (std::string(LAMINA_TEST_PYTHON).empty())
        GTEST_SKIP() << "no python3 found when configured";
    const BitGrid grid =
        test::randomGrid(test::boxOf(shape.counts, shape.edge), shape.counts, Axis::Z);
    GridWriteOptions options;
    options.up = up;
    ASSERT_TRUE(writeGrid(mFolder / "grid.vox", grid, options));
    const char axis[2] = {"xyz"[static_cast<int>(up)], 0};
    const Outcome outcome = check(mFolder / "grid.vox", grid, shape.counts, axis);
    if (outcome.code == 77)
        GTEST_SKIP() << "reader not installed: " << outcome.output;
    EXPECT_EQ(outcome.code, 0) << outcome.output;
}

INSTANTIATE_TEST_SUITE_P(Up, ForeignVoxReader,
                         testing::Combine(testing::Values(GridFormat::Vox),
                                          testing::Values(kNonCubic, kPast256), kAxes),
                         caseName);

} // namespace
} // namespace lamina
