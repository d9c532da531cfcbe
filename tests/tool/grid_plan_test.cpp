#include "failure.hpp"
#include "grid_plan.hpp"

#include <reference/overlap.hpp>
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
    EXPECT_EQ(statusOf([&] { checkMemory(plan, 0, 2 * bytes); }), 0);
    EXPECT_EQ(statusOf([&] { checkMemory(plan, 0, 2 * bytes - 1); }), 4);
}

TEST(GridPlan, MemoryCountsAttributes) {
    const GridPlan plan = planGrid(byResolution(256), reference::makeCube({0, 0, 0}, 1));
    EXPECT_EQ(attributeBytes(plan, 0), 0.0);
    // 16 bytes on the device, 64 while they are made, 22 on the host; 12 for each 128 slices.
    const double ranks = 256.0 * 256 * 2 * 12;
    EXPECT_EQ(attributeBytes(plan, 1e6), 102e6 + ranks);
    // The sums of 2^23 voxels are the most that is kept at a time.
    EXPECT_EQ(attributeBytes(plan, 1e8) - attributeBytes(plan, 0.9e8), 38e7);
    const double all = 2 * plan.bytes() + attributeBytes(plan, 1e6);
    EXPECT_EQ(statusOf([&] { checkMemory(plan, 1e6, all); }), 0);
    EXPECT_EQ(statusOf([&] { checkMemory(plan, 1e6, all - 1); }), 4);
}

TEST(GridPlan, ExpectedVoxelsAreAboutThoseThatAreSet) {
    const TriangleMesh shapes[] = {
        reference::makeIcosphere({0.1f, 0, 0}, 1, 4),
        reference::makeTorusKnot({0, 0, 0}, 0.5f, 0.2f, 2, 3, 256, 32),
        reference::makePlane({0.01f, 0.02f, 0.03f}, {1, 2, 3}, 1),
    };
    for (const TriangleMesh& mesh : shapes)
        for (const std::uint32_t resolution : {64u, 200u}) {
            const GridPlan plan = planGrid(byResolution(resolution), mesh);
            const auto grid = GridTransform::box(plan.bounds, plan.counts, plan.axis).value();
            const auto surface = reference::overlap(mesh, grid).value().count();
            const double expected = expectedVoxels(plan, mesh, Coverage::Conservative);
            // Voxels that two sheets share count twice, those that only an edge touches not at all.
            EXPECT_GT(expected, 0.8 * static_cast<double>(surface));
            EXPECT_LT(expected, 1.25 * static_cast<double>(surface));
        }
    const TriangleMesh& ball = shapes[0];
    const GridPlan plan = planGrid(byResolution(100), ball);
    const double inside = 4.18879 * 50 * 50 * 50;
    EXPECT_NEAR(expectedVoxels(plan, ball, Coverage::Solid) -
                    expectedVoxels(plan, ball, Coverage::Conservative),
                inside, 0.02 * inside);
    // Never more than there are.
    const TriangleMesh crumpled =
        reference::makeTriangleSoup({{0, 0, 0}, {1, 1, 1}}, 5000, 0.5f, 1);
    EXPECT_EQ(expectedVoxels(planGrid(byResolution(8), crumpled), crumpled, Coverage::Solid),
              512.0);
}

} // namespace
} // namespace lamina::tool
