#include <reference/volume_integral.hpp>

#include <gtest/gtest.h>

#include <string_view>

namespace lamina::reference {
namespace {

/// '.' empty, 'F' front, 'B' back, 'X' both.
std::vector<Facing> column(std::string_view text) {
    std::vector<Facing> column;
    for (const char c : text)
        column.push_back(c == 'F'   ? Facing::Front
                         : c == 'B' ? Facing::Back
                         : c == 'X' ? Facing::Both
                                    : Facing::Empty);
    return column;
}

TEST(VolumeIntegral, CountsByTheRules) {
    EXPECT_EQ(countInner(column("........")), 0u);
    EXPECT_EQ(countInner(column(".F...B..")), 5u);
    EXPECT_EQ(countInner(column("F......B")), 8u);
    EXPECT_EQ(countInner(column("F..B.F.B")), 6u);
    EXPECT_EQ(countInner(column("...X....")), 1u);
    EXPECT_EQ(countInner(column("F..X..B.")), 7u) << "ambiguous, then a back voxel: inside";
    EXPECT_EQ(countInner(column("F..X..F.B")), 7u) << "ambiguous, then a front voxel: outside";
    EXPECT_EQ(countInner(column("F..X..X.B")), 7u) << "between two ambiguous ones: left out";
    EXPECT_EQ(countInner(column("..X.X..")), 2u);
    EXPECT_EQ(countInner(column("..B.F..")), 1u) << "outside before the first and after the last";
    EXPECT_EQ(countInner(column("X..B..X..B")), 7u);
}

TEST(VolumeIntegral, TellsClosedColumns) {
    EXPECT_TRUE(looksClosed(column("....")));
    EXPECT_TRUE(looksClosed(column(".F.B")));
    EXPECT_TRUE(looksClosed(column(".X..")));
    EXPECT_FALSE(looksClosed(column(".B..")));
    EXPECT_FALSE(looksClosed(column("F.B.F.")));
}

TEST(VolumeIntegral, QuantisesIntoSlices) {
    const Crossing crossings[] = {{2.0, 0, true}, {2.9, 0, false}, {3.1, 0, true}, {6.0, 0, false}};
    EXPECT_EQ(quantised(crossings, 2.0, 6.0, 4), column("XF.B"));
    EXPECT_EQ(quantised({crossings, 1}, 2.0, 2.0, 3), column("F.."));
}

} // namespace
} // namespace lamina::reference
