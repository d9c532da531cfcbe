#include "file_size_limit.hpp"
#include "grid_fixture.hpp"

#include <lamina/grid_io/grid_file.hpp>

#include <gmock/gmock.h>

namespace lamina {
namespace {

using test::TemporaryFolder;
using testing::HasSubstr;

const glm::uvec3 kCounts(40, 33, 70);

BitGrid cubicGrid() {
    return test::randomGrid(test::boxOf(kCounts, {0.5, 0.5, 0.5}), kCounts, Axis::Y);
}

std::string extension(GridFormat format) {
    return "." + std::string(name(format));
}

class GridWrite : public testing::TestWithParam<GridFormat> {
protected:
    void SetUp() override {
        if (!canWrite(GetParam()))
            GTEST_SKIP() << "built without OpenVDB";
    }
    TemporaryFolder mFolder;
};

TEST_P(GridWrite, WritesAnEmptyGrid) {
    const BitGrid grid = test::emptyGrid(test::boxOf(kCounts, {1, 1, 1}), kCounts, Axis::Z);
    const auto written = writeGrid(mFolder / ("empty" + extension(GetParam())), grid);
    EXPECT_TRUE(written) << written.error().text;
    EXPECT_EQ(mFolder.names().size(), 1u);
}

TEST_P(GridWrite, FormatMayBeChosenAgainstTheExtension) {
    GridWriteOptions options;
    options.format = GetParam();
    ASSERT_TRUE(writeGrid(mFolder / "grid.data", cubicGrid(), options));
    ASSERT_TRUE(writeGrid(mFolder / ("grid" + extension(GetParam())), cubicGrid()));
    const std::string chosen = test::readBytes(mFolder / "grid.data");
    const std::string automatic = test::readBytes(mFolder / ("grid" + extension(GetParam())));
    ASSERT_FALSE(chosen.empty());
    // OpenVDB puts a random identity into each file.
    EXPECT_EQ(chosen.size(), automatic.size());
    EXPECT_TRUE(chosen == automatic || GetParam() == GridFormat::Vdb);
}

TEST_P(GridWrite, ReportsProgressUpToOne) {
    GridWriteOptions options;
    std::vector<double> fractions;
    options.progress = [&](double fraction) {
        fractions.push_back(fraction);
        return true;
    };
    ASSERT_TRUE(writeGrid(mFolder / ("grid" + extension(GetParam())), cubicGrid(), options));
    ASSERT_FALSE(fractions.empty());
    EXPECT_TRUE(std::is_sorted(fractions.begin(), fractions.end()));
    EXPECT_GE(fractions.front(), 0.0);
    EXPECT_EQ(fractions.back(), 1.0);
}

TEST_P(GridWrite, IsCancelledAtAnyReportAndKeepsTheOldFile) {
    const std::filesystem::path file = mFolder / ("grid" + extension(GetParam()));
    const BitGrid grid = cubicGrid();
    // With all attributes, for every stage of the writers.
    AttributeGrid attributes;
    attributes.colors.resize(grid.count(), glm::u8vec4(10, 20, 30, 255));
    attributes.normals.resize(grid.count(), glm::vec3(0, 0, 1));
    GridWriteOptions options;
    options.attributes = &attributes;
    int reports = 0;
    options.progress = [&](double) { return ++reports != 0; };
    ASSERT_TRUE(writeGrid(file, grid, options));
    const std::vector<std::filesystem::path> files = gridFiles(file, options).value();
    for (const std::filesystem::path& made : files)
        std::filesystem::remove(made);
    test::writeBytes(file, "old");
    ASSERT_GT(reports, 0);
    ASSERT_LT(reports, 500);
    for (int last = 1; last <= reports; ++last) {
        int asked = 0;
        options.progress = [&](double) { return ++asked < last; };
        const auto written = writeGrid(file, grid, options);
        ASSERT_FALSE(written) << last << " of " << reports;
        EXPECT_EQ(written.error().code, ErrorCode::Cancelled) << written.error().text;
        EXPECT_THAT(written.error().text, HasSubstr("cancelled by the progress callback"));
        EXPECT_EQ(asked, last) << "asked again";
        EXPECT_EQ(test::readBytes(file), "old");
        EXPECT_EQ(mFolder.names().size(), 1u);
    }
}

TEST_P(GridWrite, KeepsTheOldFileWhenThereIsNoRoom) {
    const std::filesystem::path file = mFolder / ("grid" + extension(GetParam()));
    test::writeBytes(file, "old");
    {
        const test::FileSizeLimit limit(200);
        const auto written = writeGrid(file, cubicGrid());
        ASSERT_FALSE(written);
        EXPECT_EQ(written.error().code, ErrorCode::InputOutput);
        EXPECT_THAT(written.error().text, HasSubstr("expected room for"));
    }
    EXPECT_EQ(test::readBytes(file), "old");
    EXPECT_EQ(mFolder.names().size(), 1u);
}

TEST_P(GridWrite, RefusesCameraGridsAndUnequalSlices) {
    const std::filesystem::path file = mFolder / ("grid" + extension(GetParam()));
    const BitGrid camera = *BitGrid::create(*GridTransform::camera(GridCamera(), {4, 4, 4}));
    const BitGrid uneven =
        *BitGrid::create(*GridTransform::box({{0, 0, 0}, {1, 1, 1}}, {4, 4, 2}, Axis::Z,
                                             SliceDistribution::custom({0.0f, 0.25f, 1.0f})));
    for (const BitGrid* grid : {&camera, &uneven}) {
        const auto written = writeGrid(file, *grid);
        ASSERT_FALSE(written);
        EXPECT_EQ(written.error().code, ErrorCode::Unsupported);
        EXPECT_THAT(written.error().text, HasSubstr("slices of equal depth, found 4 x 4 x"));
    }
    EXPECT_EQ(mFolder.names().size(), 0u);
}

TEST_P(GridWrite, NamesAMissingDirectory) {
    const auto written = writeGrid(mFolder / ("nowhere/grid" + extension(GetParam())), cubicGrid());
    ASSERT_FALSE(written);
    EXPECT_EQ(written.error().code, ErrorCode::NotFound);
}

INSTANTIATE_TEST_SUITE_P(AllFormats, GridWrite,
                         testing::Values(GridFormat::Binvox, GridFormat::Vox, GridFormat::Npy,
                                         GridFormat::Vti, GridFormat::Vdb),
                         [](const auto& info) { return std::string(name(info.param)); });

TEST(GridFormatOf, ReadsTheExtensionInAnyCase) {
    EXPECT_EQ(*gridFormat("a.vox"), GridFormat::Vox);
    EXPECT_EQ(*gridFormat("dir.npy/a.VDB"), GridFormat::Vdb);
    EXPECT_EQ(*gridFormat("a.tar.binvox"), GridFormat::Binvox);
}

TEST(GridFormatOf, ListsTheExtensionsThereAre) {
    for (const char* file : {"a.obj", "a", ".vox", "a.vox.", "npy"}) {
        const auto format = gridFormat(file);
        ASSERT_FALSE(format) << file;
        EXPECT_EQ(format.error().code, ErrorCode::UnknownFormat);
        EXPECT_THAT(format.error().text, HasSubstr(".binvox, .vox, .npy, .vti, .vdb"));
    }
}

TEST(BinvoxWriter, RefusesVoxelsThatAreNotCubes) {
    TemporaryFolder folder;
    const BitGrid grid = test::emptyGrid({{0, 0, 0}, {1, 1, 2}}, {4, 4, 4}, Axis::Z);
    const auto written = writeGrid(folder / "a.binvox", grid);
    ASSERT_FALSE(written);
    EXPECT_EQ(written.error().code, ErrorCode::Unsupported);
    EXPECT_THAT(written.error().text,
                HasSubstr("expected cubic voxels, found edges 0.25, 0.25, 0.5"));
    EXPECT_EQ(folder.names().size(), 0u);
}

TEST(VdbWriter, IsAClearErrorInABuildWithoutIt) {
    if (canWrite(GridFormat::Vdb))
        GTEST_SKIP() << "this build has OpenVDB";
    TemporaryFolder folder;
    const auto written = writeGrid(folder / "a.vdb", cubicGrid());
    ASSERT_FALSE(written);
    EXPECT_EQ(written.error().code, ErrorCode::Unsupported);
    EXPECT_THAT(written.error().text, HasSubstr("built with OpenVDB"));
}

} // namespace
} // namespace lamina
