#include <lamina/core/triangle_mesh.hpp>
#include <lamina/grid/bit_grid.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <set>
#include <tuple>

namespace lamina {
namespace {

using testing::HasSubstr;

GridTransform boxGrid(const glm::uvec3& counts, Axis axis = Axis::Z) {
    return GridTransform::box({{0, 0, 0}, {1, 2, 3}}, counts, axis).value();
}

/// A grid with every third-or-so voxel set, and the set voxels.
std::pair<BitGrid, std::set<std::tuple<unsigned, unsigned, unsigned>>>
randomGrid(const GridTransform& transform) {
    BitGrid grid = BitGrid::create(transform).value();
    std::set<std::tuple<unsigned, unsigned, unsigned>> voxels;
    std::mt19937 random(11);
    const glm::uvec3 size = transform.size();
    for (unsigned i = 0; i < size.x * size.y * size.z / 3; ++i) {
        const glm::uvec3 voxel{random() % size.x, random() % size.y, random() % size.z};
        grid.set(voxel);
        voxels.emplace(voxel.x, voxel.y, voxel.z);
    }
    return {std::move(grid), std::move(voxels)};
}

TEST(BitGrid, SetsCountsAndVisitsEveryVoxelOnce) {
    for (const std::uint32_t slices : {1u, 31u, 32u, 33u, 127u, 128u, 129u, 300u}) {
        const auto made = randomGrid(boxGrid({7, 5, slices}));
        const BitGrid& grid = made.first;
        const auto& voxels = made.second;
        EXPECT_EQ(grid.count(), voxels.size());
        EXPECT_EQ(grid.groupCount(), (slices + 127) / 128);
        EXPECT_EQ(grid.words().size(), 7u * 5u * 4u * grid.groupCount());
        std::set<std::tuple<unsigned, unsigned, unsigned>> visited;
        grid.forEachSet([&](const glm::uvec3& voxel) {
            EXPECT_TRUE(visited.emplace(voxel.x, voxel.y, voxel.z).second);
            EXPECT_TRUE(grid.test(voxel));
        });
        EXPECT_EQ(visited, voxels);
    }
}

TEST(BitGrid, ClearsVoxels) {
    BitGrid grid = BitGrid::create(boxGrid({2, 2, 200})).value();
    grid.set({1, 1, 150});
    grid.set({1, 1, 151});
    grid.set({1, 1, 150}, false);
    EXPECT_EQ(grid.count(), 1u);
    EXPECT_FALSE(grid.test({1, 1, 150}));
}

TEST(BitGrid, WordsStandAsInTheTexture) {
    BitGrid grid = BitGrid::create(boxGrid({4, 3, 200})).value();
    grid.set({2, 1, 128 + 32 + 5});
    // Group 1, row 1, column 2, word 1.
    EXPECT_EQ(grid.words()[((1 * 3 + 1) * 4 + 2) * 4 + 1], 1u << 5);
}

TEST(BitGrid, CountsNearerVoxels) {
    const auto [grid, voxels] = randomGrid(boxGrid({3, 2, 300}));
    for (std::uint32_t slice : {0u, 1u, 31u, 32u, 33u, 127u, 128u, 129u, 255u, 299u, 300u, 5000u}) {
        std::uint32_t expected = 0;
        for (const auto& [x, y, z] : voxels)
            expected += x == 2 && y == 1 && z < slice ? 1 : 0;
        EXPECT_EQ(grid.countNearer({2, 1}, slice), expected) << slice;
    }
}

TEST(BitGrid, AnswersForWorldPoints) {
    BitGrid grid = BitGrid::create(boxGrid({4, 4, 4})).value();
    grid.set({3, 0, 2});
    EXPECT_TRUE(grid.at({0.8, 0.1, 2.0}));
    EXPECT_FALSE(grid.at({0.7, 0.1, 2.0}));
    EXPECT_FALSE(grid.at({1.1, 0.1, 2.0})) << "outside the grid";
    EXPECT_TRUE(grid.at(grid.transform().voxelCenter({3, 0, 2})));
}

TEST(BitGrid, Compares) {
    BitGrid a = BitGrid::create(boxGrid({4, 4, 140})).value();
    BitGrid b = a;
    EXPECT_TRUE(compare(a, b)->equal());
    EXPECT_EQ(compare(a, b)->iou(), 1.0);
    a.set({0, 0, 0});
    a.set({1, 2, 135});
    b.set({1, 2, 135});
    b.set({3, 3, 64});
    b.set({3, 3, 65});
    const BitGridComparison found = compare(a, b).value();
    EXPECT_EQ(found.both, 1u);
    EXPECT_EQ(found.onlyFirst, 1u);
    EXPECT_EQ(found.onlySecond, 2u);
    EXPECT_DOUBLE_EQ(found.iou(), 0.25);
    const auto unequal = compare(a, BitGrid::create(boxGrid({4, 4, 141})).value());
    ASSERT_FALSE(unequal);
    EXPECT_THAT(unequal.error().text, HasSubstr("4 x 4 x 140"));
}

TEST(BitGrid, ReorientedGridsHoldTheSameWorldVoxels) {
    // Sides that straddle words and groups, and each axis the longest once.
    const glm::uvec3 sizes[] = {{5, 6, 7},     {1, 1, 1},    {31, 32, 33}, {129, 2, 40},
                                {3, 127, 130}, {64, 1, 257}, {1, 300, 33}, {128, 33, 7}};
    for (const glm::uvec3& size : sizes)
        for (const Axis from : {Axis::X, Axis::Y, Axis::Z})
            for (const Axis to : {Axis::X, Axis::Y, Axis::Z}) {
                const BitGrid grid = randomGrid(boxGrid(size, from)).first;
                const BitGrid turned = grid.reoriented(to).value();
                ASSERT_EQ(turned.transform().boxAxis(), to);
                // Voxel by voxel, by the places of their centres in the world.
                BitGrid expected = BitGrid::create(turned.transform()).value();
                grid.forEachSet([&](const glm::uvec3& voxel) {
                    expected.set(
                        expected.transform().voxelAt(grid.transform().voxelCenter(voxel)).value());
                });
                EXPECT_TRUE(std::ranges::equal(turned.words(), expected.words()))
                    << size.x << " x " << size.y << " x " << size.z << " from "
                    << static_cast<int>(from) << " to " << static_cast<int>(to);
            }
    const GridTransform camera =
        GridTransform::camera(GridCamera{.near = 1, .far = 2}, {2, 2, 2}).value();
    EXPECT_THAT(BitGrid::create(camera)->reoriented(Axis::X).error().text, HasSubstr("box grid"));
}

/// Columns 0 to 3 of a row: a range, all depths, no extent, empty.
BitGrid localGrid(std::uint32_t slices) {
    return BitGrid::create(boxGrid({4, 1, slices}), {{1.0f, 2.0f}, {0.0f, 3.0f}, {1.5f, 1.5f}, {}})
        .value();
}

TEST(BitGrid, LocalRangesDivideEachColumnsOwnDepths) {
    BitGrid grid = localGrid(10);
    ASSERT_TRUE(grid.hasLocalRanges());
    EXPECT_EQ(grid.columnRange({0, 0}), (ColumnRange{1.0f, 2.0f}));
    EXPECT_TRUE(grid.columnRange({3, 0}).isEmpty());
    const auto at = [&](double x, double z) { return grid.voxelAt({(x + 0.5) / 4, 1.0, z}); };
    EXPECT_EQ(at(0, 0.99), std::nullopt);
    EXPECT_EQ(at(0, 1.0), glm::uvec3(0, 0, 0));
    EXPECT_EQ(at(0, 1.55), glm::uvec3(0, 0, 5));
    EXPECT_EQ(at(0, 2.0), glm::uvec3(0, 0, 9));
    EXPECT_EQ(at(0, 2.01), std::nullopt);
    EXPECT_EQ(at(1, 1.55), glm::uvec3(1, 0, 5));
    EXPECT_EQ(at(2, 1.5), glm::uvec3(2, 0, 0));
    EXPECT_EQ(at(2, 1.51), std::nullopt);
    EXPECT_EQ(at(3, 1.5), std::nullopt);
    EXPECT_DOUBLE_EQ(grid.depthAt({0, 0}, 5.0), 1.5);
    EXPECT_DOUBLE_EQ(grid.depthAt({1, 0}, 5.0), 1.5);
    EXPECT_DOUBLE_EQ(grid.depthAt({0, 0}, 1.0), 1.0 + (double(2.0f) - 1.0) / 10);
    EXPECT_DOUBLE_EQ(grid.depthAt({2, 0}, 7.0), 1.5);
}

TEST(BitGrid, CountsNearerPointsInLocalRanges) {
    BitGrid grid = localGrid(10);
    for (const std::uint32_t slice : {0u, 4u, 9u})
        for (const std::uint32_t x : {0u, 1u})
            grid.set({x, 0, slice});
    grid.set({2, 0, 0});
    const auto nearer = [&](double x, double z) {
        return grid.countNearer(glm::dvec3((x + 0.5) / 4, 1.0, z));
    };
    EXPECT_EQ(nearer(0, 0.5), 0u);
    EXPECT_EQ(nearer(0, 1.05), 0u);
    EXPECT_EQ(nearer(0, 1.45), 1u);
    EXPECT_EQ(nearer(0, 1.55), 2u);
    EXPECT_EQ(nearer(0, 1.95), 2u);
    EXPECT_EQ(nearer(0, 2.5), 3u);
    EXPECT_EQ(nearer(0, 100.0), 3u);
    EXPECT_EQ(nearer(1, 2.5), 2u);
    EXPECT_EQ(nearer(2, 1.4), 0u);
    EXPECT_EQ(nearer(2, 1.6), 1u);
    EXPECT_EQ(nearer(3, 2.5), 0u);
    EXPECT_EQ(nearer(4, 2.5), 0u);
    EXPECT_TRUE(grid.at({0.125, 1.0, 1.05}));
    EXPECT_FALSE(grid.at({0.125, 1.0, 0.05}));
}

TEST(BitGrid, CountsNearerPointsInUniformGrids) {
    BitGrid grid = BitGrid::create(boxGrid({4, 1, 3})).value();
    grid.set({1, 0, 0});
    grid.set({1, 0, 2});
    EXPECT_EQ(grid.countNearer(glm::dvec3(0.3, 1, -1)), 0u);
    EXPECT_EQ(grid.countNearer(glm::dvec3(0.3, 1, 2.5)), 1u);
    EXPECT_EQ(grid.countNearer(glm::dvec3(0.3, 1, 3.5)), 2u);
    EXPECT_EQ(grid.countNearer(glm::dvec3(1.3, 1, 3.5)), 0u);
}

TEST(BitGrid, UniformGridsHoldAllThatLocalOnesDo) {
    BitGrid grid = localGrid(10);
    grid.set({0, 0, 3});
    grid.set({1, 0, 9});
    grid.set({2, 0, 0});
    // Depths 1.3 to 1.4, 2.7 to 3 and 1.5 in slices of a quarter.
    const BitGrid uniform = grid.toUniform(12).value();
    EXPECT_FALSE(uniform.hasLocalRanges());
    EXPECT_EQ(uniform.size(), glm::uvec3(4, 1, 12));
    EXPECT_EQ(uniform.transform().boxAxis(), Axis::Z);
    std::vector<glm::uvec3> voxels;
    uniform.forEachSet([&](const glm::uvec3& voxel) { voxels.push_back(voxel); });
    EXPECT_THAT(voxels, testing::ElementsAre(glm::uvec3(0, 0, 5), glm::uvec3(1, 0, 10),
                                             glm::uvec3(1, 0, 11), glm::uvec3(2, 0, 6)));
    // A hundred random grids: every set voxel's middle is in a set voxel.
    std::mt19937 random(3);
    std::uniform_real_distribution<float> depth(0.0f, 3.0f);
    for (int round = 0; round < 100; ++round) {
        std::vector<ColumnRange> ranges(4);
        for (ColumnRange& range : ranges) {
            const auto [near, far] = std::minmax({depth(random), depth(random)});
            range = {near, far};
        }
        BitGrid local = BitGrid::create(boxGrid({4, 1, 40}), ranges).value();
        for (int i = 0; i < 20; ++i)
            local.set({random() % 4, 0, random() % 40});
        const BitGrid resampled = local.toUniform(1 + random() % 200).value();
        local.forEachSet([&](const glm::uvec3& voxel) {
            const double middle = local.depthAt(glm::uvec2(voxel), voxel.z + 0.5);
            EXPECT_TRUE(resampled.at({(voxel.x + 0.5) / 4, 1.0, middle}));
        });
    }
    EXPECT_THAT(grid.toUniform(0).error().text, HasSubstr("at least one voxel"));
}

TEST(BitGrid, LocalRangesThatDoNotFitAreNamed) {
    const auto wrong = BitGrid::create(boxGrid({4, 2, 8}), std::vector<ColumnRange>(7));
    ASSERT_FALSE(wrong);
    EXPECT_THAT(wrong.error().text, HasSubstr("each of 8 columns, found 7"));
    EXPECT_THAT(localGrid(4).reoriented(Axis::X).error().text,
                HasSubstr("with local ranges; use toUniform() first"));
}

TEST(BitGrid, TooLargeForTheHostIsAnError) {
    const auto huge = BitGrid::create(boxGrid({2000000000u, 2000000000u, 2000000000u}));
    ASSERT_FALSE(huge);
    EXPECT_EQ(huge.error().code, ErrorCode::OutOfMemory);
    EXPECT_THAT(huge.error().text, HasSubstr("MiB"));
}

TEST(TriangleMesh, BoundsAndValidation) {
    TriangleMesh mesh;
    mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 2, 0}, {9, 9, 9}};
    EXPECT_TRUE(mesh.bounds().isEmpty());
    EXPECT_THAT(validate(mesh).error().text, HasSubstr("found none"));
    mesh.triangles = {{0, 1, 2}};
    EXPECT_TRUE(validate(mesh));
    EXPECT_EQ(mesh.bounds().max, glm::dvec3(1, 2, 0)) << "vertex 3 belongs to no triangle";
    mesh.normals.resize(3);
    EXPECT_THAT(validate(mesh).error().text, HasSubstr("one normal a vertex (4), found 3"));
    mesh.normals.clear();
    mesh.colors.resize(5);
    EXPECT_THAT(validate(mesh).error().text, HasSubstr("one colour a vertex (4), found 5"));
}

TEST(Result, ValuesAndErrors) {
    const Result<int> value = 3;
    EXPECT_TRUE(value);
    EXPECT_EQ(*value, 3);
    Result<std::string> error = Error{ErrorCode::NotFound, "text"};
    EXPECT_FALSE(error);
    EXPECT_EQ(error.error().text, "text");
    error = std::string("now a value");
    EXPECT_EQ(error->size(), 11u);
    EXPECT_TRUE(Result<void>());
    EXPECT_EQ(Result<void>(Error{ErrorCode::DeviceLimit, ""}).error().code, ErrorCode::DeviceLimit);
    EXPECT_EQ(name(ErrorCode::InvalidMesh), "InvalidMesh");
}

} // namespace
} // namespace lamina
