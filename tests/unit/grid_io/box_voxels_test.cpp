#include "grid_fixture.hpp"

#include "grid/bit_transpose.hpp"
#include "grid_io/box_voxels.hpp"

#include <gmock/gmock.h>

namespace lamina::detail {
namespace {

const glm::uvec3 kCounts(45, 70, 150);

/// Voxel at block coordinates, put back to world axes.
glm::uvec3 worldVoxel(AxisOrder order, const glm::uvec3& block) {
    glm::uvec3 world;
    world[order.fast] = block.x;
    world[order.middle] = block.y;
    world[order.slow] = block.z;
    return world;
}

class BoxVoxelsTest : public testing::TestWithParam<std::tuple<Axis, AxisOrder>> {};

TEST_P(BoxVoxelsTest, LoadsAnyBlockInAnyOrder) {
    const auto& [axis, order] = GetParam();
    const BitGrid grid = test::randomGrid(test::boxOf(kCounts, {1, 1, 1}), kCounts, axis);
    const std::string expected = test::occupancy(grid, kCounts);
    const auto voxels = BoxVoxels::create(grid);
    ASSERT_TRUE(voxels);
    EXPECT_EQ(voxels->size(), kCounts);
    const glm::uvec3 size(kCounts[order.fast], kCounts[order.middle], kCounts[order.slow]);
    const glm::uvec3 middle = size / 3u;
    const std::pair<glm::uvec3, glm::uvec3> blocks[] = {
        {glm::uvec3(0), size},
        {{0, middle.y, middle.z}, {size.x, 1, 1}},
        {{32, 5, 7}, {size.x - 32, size.y - 6, size.z - 8}},
        {{0, middle.y, 31}, {33, 9, 2}},
    };
    BitBlock block;
    for (const auto& [low, extent] : blocks) {
        voxels->load(order, low, extent, block);
        ASSERT_EQ(block.rowWords, (extent.x + 31) / 32);
        for (std::uint32_t s = 0; s < extent.z; ++s)
            for (std::uint32_t m = 0; m < extent.y; ++m)
                for (std::uint32_t f = 0; f < 32 * block.rowWords; ++f) {
                    const bool found = block.row(m, s)[f / 32] >> (f % 32) & 1u;
                    bool wanted = false; // Past the extent.
                    if (f < extent.x) {
                        const glm::uvec3 v = worldVoxel(order, low + glm::uvec3(f, m, s));
                        wanted =
                            expected[(std::size_t{v.z} * kCounts.y + v.y) * kCounts.x + v.x] != 0;
                    }
                    ASSERT_EQ(found, wanted) << f << " " << m << " " << s;
                }
    }
}

INSTANTIATE_TEST_SUITE_P(
    All, BoxVoxelsTest,
    testing::Combine(testing::Values(Axis::X, Axis::Y, Axis::Z),
                     testing::Values(AxisOrder{0, 1, 2}, AxisOrder{0, 2, 1}, AxisOrder{1, 2, 0},
                                     AxisOrder{2, 1, 0}, AxisOrder{1, 0, 2}, AxisOrder{2, 0, 1})),
    [](const auto& info) {
        const AxisOrder order = std::get<1>(info.param);
        return std::string(1, "XYZ"[static_cast<int>(std::get<0>(info.param))]) + "As" +
               "xyz"[order.fast] + "xyz"[order.middle] + "xyz"[order.slow];
    });

TEST(BoxVoxels, RefusesCameraGrids) {
    GridCamera camera;
    const BitGrid grid = *BitGrid::create(*GridTransform::camera(camera, {4, 4, 4}));
    const auto voxels = BoxVoxels::create(grid);
    ASSERT_FALSE(voxels);
    EXPECT_EQ(voxels.error().code, ErrorCode::Unsupported);
}

TEST(BoxVoxels, RefusesLocalRangesAndSaysWhatToDo) {
    const auto transform = GridTransform::box({{0, 0, 0}, {1, 1, 1}}, {2, 2, 4}).value();
    const BitGrid grid = *BitGrid::create(transform, std::vector<ColumnRange>(4));
    const auto voxels = BoxVoxels::create(grid);
    ASSERT_FALSE(voxels);
    EXPECT_EQ(voxels.error().code, ErrorCode::Unsupported);
    EXPECT_THAT(voxels.error().text, testing::HasSubstr("BitGrid::toUniform()"));
    EXPECT_TRUE(BoxVoxels::create(*grid.toUniform(4)));
}

TEST(Transpose32, SwapsRowsAndColumns) {
    std::mt19937 random(3);
    std::uint32_t before[32], after[32];
    for (int i = 0; i < 32; ++i)
        after[i] = before[i] = static_cast<std::uint32_t>(random());
    transpose32(after);
    for (int row = 0; row < 32; ++row)
        for (int column = 0; column < 32; ++column)
            ASSERT_EQ(after[column] >> row & 1u, before[row] >> column & 1u);
}

TEST(ExpandBits, WritesOneByteABitAndNoMore) {
    const std::uint32_t words[2] = {0x80000005u, 0x00000003u};
    std::vector<std::uint8_t> bytes(40, 7);
    expandBits(words, 35, bytes.data());
    for (std::size_t i = 0; i < 35; ++i)
        EXPECT_EQ(bytes[i], (words[i / 32] >> (i % 32)) & 1u) << i;
    for (std::size_t i = 35; i < 40; ++i)
        EXPECT_EQ(bytes[i], 7) << i;
}

} // namespace
} // namespace lamina::detail
