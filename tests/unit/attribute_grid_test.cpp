// spreadColors(): against the nearest voxel with hits, found by brute force.

#include <lamina/grid/attribute_grid.hpp>

#include <gmock/gmock.h>

#include <glm/common.hpp>

#include <limits>
#include <random>

namespace lamina {
namespace {

using testing::HasSubstr;

BitGrid emptyGrid(const glm::uvec3& size) {
    return BitGrid::create(GridTransform::box({glm::dvec3(0), glm::dvec3(size)}, size).value())
        .value();
}

std::vector<glm::uvec3> setVoxels(const BitGrid& grid) {
    std::vector<glm::uvec3> voxels;
    grid.forEachSet([&](const glm::uvec3& voxel) { voxels.push_back(voxel); });
    return voxels;
}

/// Colours that tell voxels apart.
glm::u8vec4 colorOf(std::size_t index) {
    return {index & 255u, (index >> 8u) & 255u, (index >> 16u) & 255u, 255};
}

int stepsBetween(const glm::uvec3& a, const glm::uvec3& b) {
    const glm::ivec3 d = glm::abs(glm::ivec3(a) - glm::ivec3(b));
    return d.x + d.y + d.z;
}

TEST(SpreadColors, InnerVoxelsTakeTheNearestColour) {
    // A full box: as many steps as the coordinates differ by. Layers of slices meet at 128.
    const glm::uvec3 size(9, 7, 140);
    BitGrid grid = emptyGrid(size);
    for (std::uint32_t x = 0; x < size.x; ++x)
        for (std::uint32_t y = 0; y < size.y; ++y)
            for (std::uint32_t z = 0; z < size.z; ++z)
                grid.set({x, y, z});
    const std::vector<glm::uvec3> voxels = setVoxels(grid);
    std::mt19937 random(3);
    std::bernoulli_distribution isHit(0.01);
    AttributeGrid attributes;
    std::vector<std::size_t> sources;
    for (std::size_t i = 0; i < voxels.size(); ++i) {
        attributes.hits.push_back(isHit(random) ? 2 : 0);
        attributes.colors.push_back(attributes.hits[i] > 0 ? colorOf(i) : glm::u8vec4(0));
        if (attributes.hits[i] > 0)
            sources.push_back(i);
    }
    ASSERT_GT(sources.size(), 20u);
    const std::vector<std::uint32_t> hits = attributes.hits;
    ASSERT_TRUE(spreadColors(grid, attributes));
    EXPECT_EQ(attributes.hits, hits);
    for (std::size_t i = 0; i < voxels.size(); ++i) {
        int nearest = std::numeric_limits<int>::max();
        for (const std::size_t source : sources)
            nearest = std::min(nearest, stepsBetween(voxels[i], voxels[source]));
        const glm::u8vec4 found = attributes.colors[i];
        const std::size_t from = found.x + 256u * found.y + 65536u * found.z;
        ASSERT_LT(from, voxels.size());
        EXPECT_GT(hits[from], 0u);
        EXPECT_EQ(stepsBetween(voxels[i], voxels[from]), nearest);
    }
}

TEST(SpreadColors, StepsDoNotLeaveTheSetVoxels) {
    // A wall of unset voxels between two halves: each keeps to itself, and one without hits stays.
    BitGrid grid = emptyGrid({5, 1, 3});
    for (const std::uint32_t x : {0u, 1u, 3u, 4u})
        for (std::uint32_t z = 0; z < 3; ++z)
            grid.set({x, 0, z});
    AttributeGrid attributes;
    for (const glm::uvec3& voxel : setVoxels(grid)) {
        const bool isSource = voxel == glm::uvec3(0, 0, 0);
        attributes.hits.push_back(isSource ? 1 : 0);
        attributes.colors.emplace_back(isSource ? glm::u8vec4(1, 2, 3, 4) : glm::u8vec4(0));
    }
    ASSERT_TRUE(spreadColors(grid, attributes));
    std::size_t index = 0;
    grid.forEachSet([&](const glm::uvec3& voxel) {
        EXPECT_EQ(attributes.colors[index++],
                  voxel.x < 2 ? glm::u8vec4(1, 2, 3, 4) : glm::u8vec4(0));
    });
}

TEST(SpreadColors, OtherNumbersOfValuesAreRefused) {
    BitGrid grid = emptyGrid({2, 2, 2});
    grid.set({1, 1, 1});
    AttributeGrid attributes;
    attributes.colors = {{1, 1, 1, 1}};
    const auto refused = spreadColors(grid, attributes);
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().code, ErrorCode::InvalidArgument);
    EXPECT_THAT(refused.error().text, HasSubstr("expected 1 colours and hits"));
}

} // namespace
} // namespace lamina
