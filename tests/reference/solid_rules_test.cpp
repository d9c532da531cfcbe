#include <reference/solid_rules.hpp>

#include <reference/crossings.hpp>
#include <reference/overlap.hpp>
#include <reference/shapes.hpp>
#include <reference/test_support.hpp>

#include <gtest/gtest.h>

#include <algorithm>

namespace lamina::reference {
namespace {

bool isEvery(const std::vector<SolidVotes>& votes, int axes, int diagonals) {
    return std::ranges::all_of(
        votes, [=](const SolidVotes& v) { return v.axes == axes && v.diagonals == diagonals; });
}

TEST(SolidRulesTest, ClosedMeshesAreUnanimousAndEqualParity) {
    for (const Axis axis : {Axis::X, Axis::Y, Axis::Z}) {
        const GridTransform grid =
            *GridTransform::box({{-1, -0.9, -1.1}, {1, 1.2, 0.9}}, {21, 26, 23}, axis);
        const TriangleMesh mesh = makeTorus({0.01f, 0.02f, 0.03f}, 0.6f, 0.25f, 24, 12);
        const auto votes = solidVotes(mesh, grid);
        const auto flippedVotes = solidVotes(flipped(mesh), grid);
        const BitGrid expected = *inside(mesh, grid);
        std::size_t index = 0;
        for (std::uint32_t z = 0; z < grid.size().z; ++z)
            for (std::uint32_t y = 0; y < grid.size().y; ++y)
                for (std::uint32_t x = 0; x < grid.size().x; ++x, ++index)
                    for (const SolidVotes& v : {votes[index], flippedVotes[index]}) {
                        ASSERT_EQ(v.axes, expected.test({x, y, z}) ? 6 : 0);
                        ASSERT_EQ(v.diagonals, expected.test({x, y, z}) ? 8 : 0);
                    }
    }
}

TEST(SolidRulesTest, AWallIsSeenByTheRaysThatMeetIt) {
    // A square at x = 3.25, larger than the grid. Of the lines through a voxel all but those along
    // y and z meet it once: whatever the side, one end finds it and the other does not.
    TriangleMesh wall = makePlane({3.25f, 3.5f, 3.5f}, {1, 0, 0}, 60.0f);
    const auto votes = solidVotes(wall, unitGrid({7, 7, 7}));
    EXPECT_TRUE(isEvery(votes, 1, 4));
    // The same wall twice: their crossings pair up without cancelling.
    const auto twice = solidVotes(merged(wall, wall), unitGrid({7, 7, 7}));
    EXPECT_TRUE(isEvery(twice, 0, 0));
}

TEST(SolidRulesTest, AFloodStopsAtClosedBoxesAndEntersOpenOnes) {
    const GridTransform grid = unitGrid({12, 11, 10});
    TriangleMesh box = makeBox({2.5f, 2.5f, 2.5f}, {8.5f, 7.5f, 6.5f});
    const BitGrid solid = *unreached(*overlap(box, grid));
    EXPECT_EQ(differences(solid,
                          [](const glm::ivec3& v) {
                              return v.x >= 2 && v.x <= 8 && v.y >= 2 && v.y <= 7 && v.z >= 2 &&
                                     v.z <= 6;
                          }),
              0u);
    box.triangles.resize(10);
    const BitGrid open = *overlap(box, grid);
    EXPECT_TRUE(compare(*unreached(open), open)->equal());
}

} // namespace
} // namespace lamina::reference
