#include "grid_io/palette.hpp"

#include "grid_fixture.hpp"

#include <lamina/grid_io/grid_file.hpp>

#include <gmock/gmock.h>

#include <random>

namespace lamina::detail {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

int distance2(std::uint32_t a, std::uint32_t b) {
    int sum = 0;
    for (int shift = 0; shift < 24; shift += 8) {
        const int d = int(a >> shift & 0xffu) - int(b >> shift & 0xffu);
        sum += d * d;
    }
    return sum;
}

TEST(Palette, AsManyColoursAsFitAreKept) {
    PaletteBuilder builder;
    for (const std::uint32_t color : {0x0000ffu, 0xff0000u, 0x123456u, 0x0000ffu, 0x000000u})
        builder.add(color);
    const Palette palette = builder.build(4);
    EXPECT_THAT(palette.colors(), ElementsAre(0x000000u, 0x0000ffu, 0x123456u, 0xff0000u));
    for (std::size_t i = 0; i < 4; ++i)
        EXPECT_EQ(palette.index(palette.colors()[i]), i);
}

TEST(Palette, ClustersGetTheirMeans) {
    // Three clouds of unequal size far apart, into three colours.
    PaletteBuilder builder;
    for (std::uint32_t i = 0; i < 5; ++i) {
        builder.add(0x101010u + i); // red 16 to 20
        for (int k = 0; k < 100; ++k)
            builder.add(0xc0c0c0u + (i << 8u)); // green 192 to 196
        builder.add(0x2000f0u + (i << 16u));    // blue 32 to 36
    }
    const Palette palette = builder.build(3);
    EXPECT_THAT(palette.colors(), testing::UnorderedElementsAre(0x101012u, 0xc0c2c0u, 0x2200f0u));
    EXPECT_EQ(palette.colors()[palette.index(0xc0c4c0u)], 0xc0c2c0u);
}

TEST(Palette, ManyColoursStayNear) {
    // A sphere of colours, as normals give: its surface in 255 patches of some 25 across.
    PaletteBuilder builder;
    std::mt19937 random(1);
    std::normal_distribution<double> normal;
    std::vector<std::uint32_t> colors;
    for (int i = 0; i < 100000; ++i) {
        const glm::dvec3 v(normal(random), normal(random), normal(random));
        const glm::dvec3 unit = v / std::sqrt(v.x * v.x + v.y * v.y + v.z * v.z);
        std::uint32_t color = 0;
        for (int c = 0; c < 3; ++c)
            color |= static_cast<std::uint32_t>(std::lround(127.5 + 127.5 * unit[c])) << 8 * c;
        colors.push_back(color);
        builder.add(color);
    }
    const Palette palette = builder.build(kPaletteColors);
    EXPECT_EQ(palette.colors().size(), kPaletteColors);
    double sum = 0.0;
    int worst = 0;
    for (const std::uint32_t color : colors) {
        const int error = distance2(color, palette.colors()[palette.index(color)]);
        sum += error;
        worst = std::max(worst, error);
    }
    // The mean over a square of 28 across is 28 / sqrt(6) = 11.5; patches are not squares.
    EXPECT_LT(std::sqrt(sum / static_cast<double>(colors.size())), 14.0);
    EXPECT_LT(std::sqrt(worst), 45.0);
}

TEST(Palette, NoColourGivesNone) {
    EXPECT_TRUE(PaletteBuilder().build(255).colors().empty());
}

TEST(GridAttributes, OfAnotherGridAreRefused) {
    const test::TemporaryFolder folder;
    const BitGrid grid = test::randomGrid({{0, 0, 0}, {4, 4, 4}}, glm::uvec3(4), Axis::Z);
    AttributeGrid attributes;
    attributes.colors.resize(grid.count() + 1);
    GridWriteOptions options;
    options.attributes = &attributes;
    const auto written = writeGrid(folder / "grid.vox", grid, options);
    ASSERT_FALSE(written);
    EXPECT_EQ(written.error().code, ErrorCode::InvalidArgument);
    EXPECT_THAT(written.error().text, HasSubstr(std::to_string(grid.count())));
    EXPECT_EQ(folder.names().size(), 0u);
    // A format that holds none does not look at them.
    EXPECT_TRUE(writeGrid(folder / "grid.binvox", grid, options));
}

TEST(GridAttributes, FilesBesideAreNamedAndMade) {
    AttributeGrid attributes;
    attributes.normals.resize(1);
    GridWriteOptions options;
    options.attributes = &attributes;
    EXPECT_THAT(gridFiles("a/b.npy", options).value(), ElementsAre("a/b.npy", "a/b.normal.npy"));
    EXPECT_THAT(gridFiles("a/b.vdb", options).value(), ElementsAre("a/b.vdb"));
    EXPECT_THAT(gridFiles("a/b.npy").value(), ElementsAre("a/b.npy"));
}

} // namespace
} // namespace lamina::detail
