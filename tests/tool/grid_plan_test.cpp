#include "failure.hpp"
#include "grid_plan.hpp"

#include <reference/shapes.hpp>

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <random>

namespace lamina::tool {
namespace {

GridRequest byResolution(std::uint32_t resolution) {
    GridRequest request;
    request.resolution = resolution;
    return request;
}

GridRequest byVoxelSize(double size) {
    GridRequest request;
    request.voxelSize = size;
    return request;
}

void expectHolds(const GridPlan& plan, const Box3& mesh) {
    for (int axis = 0; axis < 3; ++axis) {
        EXPECT_EQ(plan.bounds.min[axis], mesh.min[axis]);
        EXPECT_GE(plan.bounds.max[axis], mesh.max[axis]);
        EXPECT_NEAR(plan.bounds.size()[axis], plan.voxelSize[axis] * plan.counts[axis],
                    1e-12 * plan.bounds.size()[axis]);
    }
}

TEST(GridPlan, ResolutionCountsAlongTheLongestSideAndRoundsUp) {
    const TriangleMesh box = reference::makeBox({1, 2, 3}, {5, 4.1f, 3.9f});
    const GridPlan plan = planGrid(byResolution(8), box);
    EXPECT_EQ(plan.counts, glm::uvec3(8, 5, 2));
    EXPECT_EQ(plan.voxelSize, glm::dvec3(0.5));
    expectHolds(plan, box.bounds());
}

TEST(GridPlan, VoxelSizeIsKeptWhereSidesAreExact) {
    const TriangleMesh box = reference::makeBox({-1, 0, 0}, {1, 0.5f, 0.3f});
    const GridPlan plan = planGrid(byVoxelSize(0.25), box);
    EXPECT_EQ(plan.counts, glm::uvec3(8, 2, 2));
    EXPECT_EQ(plan.voxelSize, glm::dvec3(0.25));
    expectHolds(plan, box.bounds());
}

// Sides and corners are products of decimal numbers rounded to float: none is an exact multiple.
TEST(GridPlan, RoundedMultiplesGetNoExtraVoxel) {
    std::mt19937 random(7);
    std::uniform_int_distribution<int> count(1, 300);
    std::uniform_int_distribution<int> corner(-300, 300);
    for (int trial = 0; trial < 2000; ++trial) {
        const double edge = 0.1 * count(random);
        const glm::uvec3 counts(count(random), count(random), count(random));
        const glm::dvec3 low = edge * glm::dvec3(corner(random), corner(random), corner(random));
        const TriangleMesh box =
            reference::makeBox(glm::vec3(low), glm::vec3(low + edge * glm::dvec3(counts)));
        for (const GridRequest& request :
             {byVoxelSize(edge), byResolution(std::max({counts.x, counts.y, counts.z}))}) {
            const GridPlan plan = planGrid(request, box);
            ASSERT_EQ(plan.counts, counts) << "edge " << edge << ", trial " << trial;
            ASSERT_NEAR(plan.voxelSize.x, edge, 1e-4 * edge);
            expectHolds(plan, box.bounds());
        }
    }
}

TEST(GridPlan, ClearlyLongerSidesGetAnotherVoxel) {
    for (const double excess : {0.002, 0.01, 0.5, 0.999}) {
        const TriangleMesh box =
            reference::makeBox({0, 0, 0}, {10, static_cast<float>(3 + excess), 1});
        EXPECT_EQ(planGrid(byVoxelSize(1.0), box).counts, glm::uvec3(10, 4, 1)) << excess;
    }
}

TEST(GridPlan, FlatSidesAreOneVoxelThick) {
    for (int axis = 0; axis < 3; ++axis) {
        glm::vec3 normal(0);
        normal[axis] = 1;
        const TriangleMesh plane = reference::makePlane({1, 2, 3}, normal, 4);
        const GridPlan plan = planGrid(byResolution(16), plane);
        glm::uvec3 expected(16);
        expected[axis] = 1;
        EXPECT_EQ(plan.counts, expected);
        EXPECT_EQ(plan.axis, static_cast<Axis>(axis));
        EXPECT_GT(plan.bounds.max[axis], plan.bounds.min[axis]);
        EXPECT_EQ(planGrid(byVoxelSize(0.25), plane).counts, expected);
    }
}

TEST(GridPlan, AxisIsTheOneThatSeesMostTriangles) {
    const TriangleMesh slab = reference::makeBox({0, 0, 0}, {1, 4, 4});
    const GridPlan chosen = planGrid(byResolution(4), slab);
    EXPECT_EQ(chosen.axis, Axis::X);
    EXPECT_TRUE(chosen.isAxisChosen);
    EXPECT_EQ(chosen.coveredColumns, glm::dvec3(32, 8, 8));

    GridRequest given = byResolution(4);
    given.axis = Axis::Y;
    EXPECT_EQ(planGrid(given, slab).axis, Axis::Y);
    EXPECT_FALSE(planGrid(given, slab).isAxisChosen);
    EXPECT_EQ(planGrid(byResolution(4), reference::makeCube({0, 0, 0}, 1)).axis, Axis::Z);
}

// Seen along y this box covers most world area, but few of the long columns' voxels.
TEST(GridPlan, AxisIsChosenInVoxelsNotInWorldUnits) {
    GridRequest request;
    request.bounds = Box3{{0, 0, 0}, {8, 4, 8}};
    request.counts = glm::uvec3(8, 64, 8);
    const GridPlan plan = planGrid(request, reference::makeBox({0, 0, 0}, {8, 4, 8}));
    EXPECT_EQ(plan.coveredColumns, glm::dvec3(1024, 128, 1024));
    EXPECT_NE(plan.axis, Axis::Y);
    EXPECT_EQ(plan.counts, *request.counts);
    EXPECT_EQ(plan.voxelSize, glm::dvec3(1, 0.0625, 1));
}

int statusOf(const std::function<void()>& call) {
    try {
        call();
    } catch (const Failure& failure) {
        return failure.status();
    }
    return 0;
}

TEST(GridPlan, RefusesPointsAndBoundlessCounts) {
    TriangleMesh point;
    point.positions.assign(3, glm::vec3(1, 2, 3));
    point.triangles.emplace_back(0, 1, 2);
    EXPECT_EQ(statusOf([&] { (void)planGrid(byResolution(4), point); }), 3);
    EXPECT_EQ(statusOf([&] { (void)planGrid(byVoxelSize(1), point); }), 3);
    const TriangleMesh cube = reference::makeCube({0, 0, 0}, 1);
    EXPECT_EQ(statusOf([&] { (void)planGrid(byVoxelSize(1e-300), cube); }), 4);
    EXPECT_EQ(statusOf([&] { (void)planGrid(byVoxelSize(1e-12), cube); }), 4);
}

TEST(GridPlan, MemoryCountsWholeGroupsOf128SlicesTwice) {
    const GridPlan plan = planGrid(byResolution(129), reference::makeCube({0, 0, 0}, 1));
    const double bytes = 129.0 * 129.0 * 2 * 16;
    EXPECT_EQ(plan.bytes(), bytes);
    EXPECT_EQ(statusOf([&] { checkMemory(plan, 2 * bytes); }), 0);
    EXPECT_EQ(statusOf([&] { checkMemory(plan, 2 * bytes - 1); }), 4);
}

} // namespace
} // namespace lamina::tool
