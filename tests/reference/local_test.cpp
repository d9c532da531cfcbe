#include <reference/local.hpp>
#include <reference/shapes.hpp>

#include <gtest/gtest.h>

namespace lamina {
namespace {

namespace ref = reference;

GridTransform unitGrid(std::uint32_t slices,
                       const SliceDistribution& distribution = SliceDistribution::linear()) {
    return GridTransform::box({{0, 0, 0}, {1, 1, 1}}, {4, 4, slices}, Axis::Z, distribution)
        .value();
}

/// z = 0.25 + 0.5 x over x in [0, 1], y in [0, 0.5].
TriangleMesh makeRamp() {
    TriangleMesh mesh;
    mesh.positions = {{0, 0, 0.25f}, {1, 0, 0.75f}, {1, 0.5f, 0.75f}, {0, 0.5f, 0.25f}};
    mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
    return mesh;
}

TEST(Local, SpansOfARampAreItsDepthsAtCentresAndOverSquares) {
    const auto centers = ref::columnSpans(makeRamp(), unitGrid(8), ref::ColumnRule::Centre);
    const auto squares = ref::columnSpans(makeRamp(), unitGrid(8), ref::ColumnRule::Footprint);
    for (std::size_t y = 0; y < 4; ++y)
        for (std::size_t x = 0; x < 4; ++x) {
            const auto& center = centers[y * 4 + x];
            const auto& square = squares[y * 4 + x];
            ASSERT_EQ(center.has_value(), y < 2);
            ASSERT_EQ(square.has_value(), y < 2);
            if (y >= 2)
                continue;
            const double middle = 0.25 + 0.125 * (static_cast<double>(x) + 0.5);
            EXPECT_DOUBLE_EQ(center->min, middle);
            EXPECT_DOUBLE_EQ(center->max, middle);
            EXPECT_DOUBLE_EQ(square->min, middle - 0.0625);
            EXPECT_DOUBLE_EQ(square->max, middle + 0.0625);
        }
}

TEST(Local, SlicesDivideTheColumnsRange) {
    // Two planes at 0.25 and 0.5 in ranges [0.25, 0.5], [0, 1], [0.5, 0.5] and none.
    const TriangleMesh mesh = ref::makeParallelQuads({0.5f, 0.5f, 0.25f}, 4.0f, 2, 0.25f);
    std::vector<ColumnRange> ranges(16, ColumnRange{0.25f, 0.5f});
    ranges[1] = {0.0f, 1.0f};
    ranges[2] = {0.5f, 0.5f};
    ranges[3] = {};
    const BitGrid grid = ref::local(mesh, unitGrid(8), ranges, ref::ColumnRule::Centre).value();
    const auto slices = [&](std::uint32_t x) {
        std::vector<std::uint32_t> set;
        for (std::uint32_t k = 0; k < 8; ++k)
            if (grid.test({x, 0, k}))
                set.push_back(k);
        return set;
    };
    EXPECT_EQ(slices(0), (std::vector<std::uint32_t>{0, 7}));
    EXPECT_EQ(slices(1), (std::vector<std::uint32_t>{2, 4}));
    EXPECT_EQ(slices(2), (std::vector<std::uint32_t>{0}));
    EXPECT_TRUE(slices(3).empty());
}

TEST(Local, CustomBoundariesAreFractionsOfTheColumnsRange) {
    const TriangleMesh mesh = ref::makePlane({0.5f, 0.5f, 0.375f}, {0, 0, 1}, 4.0f);
    const GridTransform transform =
        unitGrid(3, SliceDistribution::custom({0.0f, 0.25f, 0.75f, 1.0f}));
    const std::vector<ColumnRange> ranges(16, ColumnRange{0.25f, 0.75f});
    const BitGrid grid = ref::local(mesh, transform, ranges, ref::ColumnRule::Centre).value();
    // A quarter into the range: on boundary 1.
    EXPECT_EQ(grid.count(), 16u);
    EXPECT_TRUE(grid.test({0, 0, 1}));
}

} // namespace
} // namespace lamina
