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
    /// attributes: two more arguments of the checker.
    Outcome check(const std::filesystem::path& file, const BitGrid& grid, const glm::uvec3& counts,
                  const char* up = "y", const std::string& attributes = "") {
        const Box3& box = grid.transform().boxBounds();
        test::writeBytes(mFolder / "occupancy", test::occupancy(grid, counts));
        std::string command = quoted(LAMINA_TEST_PYTHON) + " " + quoted(LAMINA_TEST_GRID_CHECKER) +
                              " " + quoted(file) + " " + quoted(mFolder / "occupancy");
        for (int i = 0; i < 3; ++i)
            command += " " + std::to_string(counts[i]);
        for (int i = 0; i < 3; ++i)
            command += " " + exact(box.min[i]);
        for (int i = 0; i < 3; ++i)
            command += " " + exact(box.size()[i] / counts[i]);
        return runCommand(command + " " + up + attributes);
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

/// Colours and normals of the set voxels, and the same for every voxel by world position.
struct Painted {
    AttributeGrid attributes;
    std::string colors, normals; ///< Bytes of RGBA and of three floats, zero without; x fastest.
};

/// steps: different values of each channel.
Painted paint(const BitGrid& grid, const glm::uvec3& counts, unsigned steps) {
    Painted painted;
    const auto colorOf = [&](const glm::uvec3& v) {
        const auto level = [&](std::uint32_t i, std::uint32_t count) {
            return static_cast<std::uint8_t>(i * steps / count * 255 / std::max(steps - 1, 1u));
        };
        return glm::u8vec4(level(v.x, counts.x), level(v.y, counts.y), level(v.z, counts.z),
                           200 + v.x % 50);
    };
    const auto normalOf = [&](const glm::uvec3& v) {
        return glm::vec3(v) / glm::vec3(counts) + glm::vec3(0.25f);
    };
    const auto hitsOf = [](const glm::uvec3& v) { return (v.x + v.y + v.z) % 7; };
    const auto append = [](std::string& bytes, const auto& value) {
        bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
    };
    const Box3& box = grid.transform().boxBounds();
    const auto worldVoxel = [&](const glm::uvec3& voxel) {
        const glm::dvec3 place = (grid.transform().voxelCenter(voxel) - box.min) / box.size();
        return glm::uvec3(place * glm::dvec3(counts));
    };
    grid.forEachSet([&](const glm::uvec3& voxel) {
        const glm::uvec3 v = worldVoxel(voxel);
        painted.attributes.colors.push_back(colorOf(v));
        painted.attributes.normals.push_back(normalOf(v));
        painted.attributes.hits.push_back(hitsOf(v));
    });
    for (std::uint32_t k = 0; k < counts.z; ++k)
        for (std::uint32_t j = 0; j < counts.y; ++j)
            for (std::uint32_t i = 0; i < counts.x; ++i) {
                const glm::uvec3 v(i, j, k);
                const bool isKnown =
                    hitsOf(v) != 0 &&
                    grid.at(box.min + (glm::dvec3(v) + 0.5) * box.size() / glm::dvec3(counts));
                append(painted.colors, isKnown ? colorOf(v) : glm::u8vec4(0));
                append(painted.normals, isKnown ? normalOf(v) : glm::vec3(0.0f));
            }
    return painted;
}

class ForeignAttributeReader : public ForeignReader {};

TEST_P(ForeignAttributeReader, FindsEveryColourAndNormal) {
    const auto& [format, shape, axis] = GetParam();
    if (!canWrite(format))
        GTEST_SKIP() << "built without OpenVDB";
    if (std::string(LAMINA_TEST_PYTHON).empty())
        GTEST_SKIP() << "no python3 found when configured";
    const BitGrid grid =
        test::randomGrid(test::boxOf(shape.counts, shape.edge), shape.counts, axis);
    // Some 200 colours, which a palette holds, and more.
    for (const unsigned steps : {6u, 40u}) {
        const Painted painted = paint(grid, shape.counts, steps);
        test::writeBytes(mFolder / "colors", painted.colors);
        test::writeBytes(mFolder / "normals", painted.normals);
        const std::filesystem::path file = mFolder / ("grid." + std::string(name(format)));
        GridWriteOptions options;
        options.attributes = &painted.attributes;
        double last = 0.0;
        options.progress = [&](double fraction) {
            EXPECT_GE(fraction, last);
            last = fraction;
            return true;
        };
        const auto written = writeGrid(file, grid, options);
        ASSERT_TRUE(written) << written.error().text;
        EXPECT_EQ(last, 1.0);
        const std::vector<std::filesystem::path> files = gridFiles(file, options).value();
        for (const std::filesystem::path& made : files)
            EXPECT_TRUE(std::filesystem::exists(made)) << made;
        const Outcome outcome =
            check(file, grid, shape.counts, "y",
                  " " + quoted(mFolder / "colors") + " " + quoted(mFolder / "normals"));
        if (outcome.code == 77)
            GTEST_SKIP() << "reader not installed: " << outcome.output;
        EXPECT_EQ(outcome.code, 0) << outcome.output;
    }
}

INSTANTIATE_TEST_SUITE_P(Attributes, ForeignAttributeReader,
                         testing::Combine(testing::Values(GridFormat::Npy, GridFormat::Vti,
                                                          GridFormat::Vdb, GridFormat::Vox),
                                          testing::Values(kNonCubic), testing::Values(Axis::X)),
                         caseName);
INSTANTIATE_TEST_SUITE_P(SplitModels, ForeignAttributeReader,
                         testing::Combine(testing::Values(GridFormat::Vox),
                                          testing::Values(kPast256), testing::Values(Axis::Z)),
                         caseName);

} // namespace
} // namespace lamina
