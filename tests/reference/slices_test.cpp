#include <reference/slices.hpp>
#include <reference/test_support.hpp>

#include <gtest/gtest.h>

#include <cmath>

namespace lamina::reference {
namespace {

GridTransform grid(const SliceDistribution& distribution, unsigned slices, double near = 2.0,
                   double far = 18.0) {
    GridCamera camera;
    camera.near = near;
    camera.far = far;
    return *GridTransform::camera(camera, {1, 1, slices}, distribution);
}

TEST(Slices, LinearCoordinatesAreProportional) {
    const GridTransform transform = grid(SliceDistribution::linear(), 8);
    EXPECT_EQ(openSliceCoordinate(transform, 2.0), 0.0);
    EXPECT_EQ(openSliceCoordinate(transform, 7.0), 2.5);
    EXPECT_EQ(openSliceCoordinate(transform, 18.0), 8.0);
    EXPECT_EQ(openSliceCoordinate(transform, 0.0), -1.0);
    EXPECT_EQ(openSliceCoordinate(transform, 22.0), 10.0);
}

TEST(Slices, CustomCoordinatesAreLinearBetweenBoundaries) {
    const GridTransform transform = grid(SliceDistribution::custom({0.0f, 0.125f, 0.25f, 1.0f}), 3);
    EXPECT_EQ(openSliceCoordinate(transform, 3.0), 0.5);
    EXPECT_EQ(openSliceCoordinate(transform, 4.0), 1.0);
    EXPECT_EQ(openSliceCoordinate(transform, 12.0), 2.5);
    EXPECT_EQ(openSliceCoordinate(transform, 1.0), -0.5);
    EXPECT_EQ(openSliceCoordinate(transform, 24.0), 3.5);
}

TEST(Slices, LogarithmicBoundariesGrowByAConstantRatio) {
    const GridTransform transform = grid(SliceDistribution::logarithmic(), 4, 1.0, 16.0);
    for (int k = 0; k <= 4; ++k) {
        EXPECT_NEAR(openSliceCoordinate(transform, std::pow(2.0, k)), k, 1e-6);
    }
}

TEST(Slices, BoundariesBelongToTheSliceBehindAndFarToTheLast) {
    for (const double far : {18.0, 2.0 + 1.0 / 3.0, 1e6}) {
        const GridTransform transform = grid(SliceDistribution::linear(), 100, 2.0, far);
        for (int k = 0; k <= 100; ++k) {
            const double depth = 2.0 + (far - 2.0) * k / 100.0;
            const IndexRange on = slicesTouched(transform, {depth, depth});
            EXPECT_EQ(on.first, std::min(k, 99));
            EXPECT_EQ(on.last, std::min(k, 99));
            const double before = depth - 1e-6 * (far - 2.0);
            const IndexRange ahead = slicesTouched(transform, {before, before});
            EXPECT_EQ(ahead.last, k - 1);
            EXPECT_EQ(ahead.first, k == 0 ? 0 : k - 1);
        }
    }
}

TEST(Slices, GrowMovesBoundariesByParts) {
    const GridTransform transform = grid(SliceDistribution::linear(), 16); // a slice per unit
    const auto first = [&](double a, double b, double g) {
        return slicesTouched(transform, {a, b}, g).first;
    };
    const auto last = [&](double a, double b, double g) {
        return slicesTouched(transform, {a, b}, g).last;
    };
    EXPECT_EQ(first(6.1, 8.9, 0.0), 4);
    EXPECT_EQ(last(6.1, 8.9, 0.0), 6);
    EXPECT_EQ(first(6.1, 8.9, 0.2), 3);
    EXPECT_EQ(last(6.1, 8.9, 0.2), 7);
    EXPECT_EQ(first(6.9, 8.1, -0.2), 5);
    EXPECT_EQ(last(6.9, 8.1, -0.2), 5);
    // A plane on a boundary surely touches no slice.
    EXPECT_GT(first(7.0, 7.0, -0.01), last(7.0, 7.0, -0.01));
    EXPECT_EQ(last(1.0, 1.9, 0.0), -1);
    EXPECT_EQ(last(1.0, 1.9, 0.2), 0);
    EXPECT_EQ(last(18.1, 19.0, 0.0), -1);
    EXPECT_EQ(first(18.1, 19.0, 0.2), 15);
}

TEST(Slices, AgreeWithTheGridTransform) {
    const GridTransform transforms[] = {
        grid(SliceDistribution::linear(), 77), grid(SliceDistribution::logarithmic(), 77),
        grid(SliceDistribution::custom({0.0f, 0.1f, 0.3f, 0.35f, 1.0f}), 4)};
    for (const GridTransform& transform : transforms)
        for (int i = -500; i <= 10500; ++i) {
            const double depth = 2.0 + 16.0 * i / 10000.0;
            const auto slice = transform.sliceAt(depth);
            const IndexRange found = slicesTouched(transform, {depth, depth});
            ASSERT_EQ(slice.has_value(), found.first <= found.last) << depth;
            if (slice) {
                EXPECT_EQ(*slice, found.first) << depth;
                EXPECT_EQ(*slice, found.last) << depth;
                EXPECT_NEAR(transform.sliceCoordinate(depth), openSliceCoordinate(transform, depth),
                            1e-6);
            }
        }
}

} // namespace
} // namespace lamina::reference
