#include "grid_fixture.hpp"

#include "grid_io/voxel_tree.hpp"

#include <cmath>

namespace lamina::detail {
namespace {

constexpr double kFar = std::numeric_limits<double>::infinity();

/// Where a ray enters the unit box at `low`, by the slab method; infinity if it does not.
double entry(const VoxelRay& ray, const glm::ivec3& low) {
    double first = 0.0, last = kFar;
    for (int i = 0; i < 3; ++i) {
        const double a = (low[i] - ray.origin[i]) / ray.direction[i];
        const double b = (low[i] + 1 - ray.origin[i]) / ray.direction[i];
        first = std::max(first, std::min(a, b));
        last = std::min(last, std::max(a, b));
    }
    return first < last ? first : kFar;
}

struct Scene {
    glm::uvec3 counts;
    std::vector<glm::ivec3> set;
    BitGrid grid;
    VoxelTree tree;

    explicit Scene(const glm::uvec3& size, int share, unsigned seed, Axis axis = Axis::Z)
        : counts(size)
        , grid(test::emptyGrid({glm::dvec3(0), glm::dvec3(size)}, size, axis))
        , tree(fill(share, seed)) {}

private:
    VoxelTree fill(int share, unsigned seed) {
        std::mt19937 random(seed);
        for (std::uint32_t k = 0; k < counts.z; ++k)
            for (std::uint32_t j = 0; j < counts.y; ++j)
                for (std::uint32_t i = 0; i < counts.x; ++i)
                    if (static_cast<int>(random() % 1000) < share) {
                        test::setWorld(grid, counts, {i, j, k});
                        set.emplace_back(i, j, k);
                    }
        return VoxelTree(*BoxVoxels::create(grid));
    }
};

TEST(VoxelTree, KnowsEveryVoxel) {
    for (const Axis axis : {Axis::X, Axis::Y, Axis::Z}) {
        const Scene scene({70, 19, 133}, 200, 1, axis);
        for (int k = -1; k <= 133; ++k)
            for (int j = -1; j <= 19; ++j)
                for (int i = -1; i <= 70; ++i)
                    ASSERT_EQ(scene.tree.test({i, j, k}),
                              scene.grid.at({i + 0.5, j + 0.5, k + 0.5}));
    }
}

TEST(VoxelTree, HoldsTheBoxOfSetVoxels) {
    BitGrid grid = test::emptyGrid({{0, 0, 0}, {200, 100, 90}}, {200, 100, 90}, Axis::X);
    EXPECT_TRUE(VoxelTree(*BoxVoxels::create(grid)).isEmpty());
    test::setWorld(grid, {200, 100, 90}, {31, 64, 5});
    test::setWorld(grid, {200, 100, 90}, {130, 7, 88});
    const VoxelTree tree(*BoxVoxels::create(grid));
    EXPECT_EQ(tree.low(), glm::ivec3(31, 7, 5));
    EXPECT_EQ(tree.high(), glm::ivec3(131, 65, 89));
}

TEST(VoxelTree, FindsTheFirstVoxelOnARay) {
    int hits = 0, casts = 0;
    for (const int share : {1, 20, 300}) {
        const Scene scene({70, 19, 133}, share, static_cast<unsigned>(share));
        std::mt19937 random(2);
        std::uniform_real_distribution<double> unit(-1.0, 1.0);
        for (int n = 0; n < 300; ++n, ++casts) {
            const auto around = [&](double reach) {
                return glm::dvec3(35, 10, 66) +
                       reach * glm::dvec3(unit(random), unit(random), unit(random));
            };
            const glm::dvec3 origin = around(90.0);
            const VoxelRay ray{origin, 0.01 * (around(30.0) - origin)};
            double nearest = kFar;
            for (const glm::ivec3& voxel : scene.set)
                nearest = std::min(nearest, entry(ray, voxel));
            const auto hit = scene.tree.cast(ray, kFar);
            ASSERT_EQ(hit.has_value(), nearest < kFar) << "ray " << n;
            if (!hit)
                continue;
            ++hits;
            ASSERT_NEAR(hit->distance, nearest, 1e-9);
            ASSERT_NEAR(entry(ray, hit->voxel), nearest, 1e-9);
            ASSERT_TRUE(scene.tree.test(hit->voxel));
            if (nearest > 0.0) { // The ray goes through the face it is said to enter.
                const double at = (ray.origin + nearest * ray.direction)[hit->axis];
                ASSERT_NEAR(at, hit->voxel[hit->axis] + (hit->side > 0 ? 1 : 0), 1e-9);
                ASSERT_LT(hit->side * ray.direction[hit->axis], 0.0);
            }
            ASSERT_FALSE(scene.tree.cast(ray, nearest * (1.0 - 1e-9)));
        }
    }
    EXPECT_GT(hits, casts / 10);
    EXPECT_LT(hits, casts);
}

TEST(VoxelTree, FollowsRaysAlongAnAxisOnVoxelBorders) {
    BitGrid grid = test::emptyGrid({{0, 0, 0}, {100, 100, 100}}, {100, 100, 100}, Axis::Z);
    test::setWorld(grid, {100, 100, 100}, {10, 50, 64});
    test::setWorld(grid, {100, 100, 100}, {80, 50, 64});
    const VoxelTree tree(*BoxVoxels::create(grid));
    for (const double y : {50.0, 50.5})
        for (const double z : {64.0, 64.5}) {
            const auto forward = tree.cast({{-5, y, z}, {1, 0, 0}}, kFar);
            ASSERT_TRUE(forward);
            EXPECT_EQ(forward->voxel, glm::ivec3(10, 50, 64));
            EXPECT_EQ(forward->distance, 15.0);
            const auto backward = tree.cast({{200, y, z}, {-2, 0.0, -0.0}}, kFar);
            ASSERT_TRUE(backward);
            EXPECT_EQ(backward->voxel, glm::ivec3(80, 50, 64));
            EXPECT_EQ(backward->distance, 59.5);
            EXPECT_EQ(backward->side, 1);
            const auto between = tree.cast({{11.5, y, z}, {1, 0, 0}}, kFar);
            ASSERT_TRUE(between);
            EXPECT_EQ(between->voxel, glm::ivec3(80, 50, 64));
        }
    EXPECT_FALSE(tree.cast({{-5, 51, 64.5}, {1, 0, 0}}, kFar));
    EXPECT_FALSE(tree.cast({{-5, 49.9, 64.5}, {1, 0, 0}}, kFar));
}

} // namespace
} // namespace lamina::detail
