#include <lamina/parity/sprite_layers.hpp>
#include <lamina/parity/sprite_transform.hpp>

#include <glm/geometric.hpp>
#include <gmock/gmock.h>

#include <algorithm>
#include <limits>

namespace lamina {
namespace {

using testing::HasSubstr;

const Box3 kUnitBox{{-1, -1, -1}, {1, 1, 1}};
const Box3 kEight{glm::dvec3(0), glm::dvec3(8)};

/// Two columns by one; one of them crosses a solid at depths 1 to 3 and 5 to 6.5 of 8.
SpriteLayers someLayers() {
    const auto transform = GridTransform::box(kEight, {2, 1, 8}).value();
    return SpriteLayers::create(transform, 4,
                                {0.125f, 2.0f, 0.375f, 2.0f, 0.625f, 2.0f, 0.8125f, 2.0f})
        .value();
}

TEST(SpriteLayers, CountsCrossingsUpToThePoint) {
    const SpriteLayers layers = someLayers();
    const std::pair<double, std::uint32_t> expected[] = {{0.0, 0}, {0.99, 0}, {1.0, 1}, {2.9, 1},
                                                         {3.0, 2}, {5.5, 3},  {6.5, 4}, {8.0, 4}};
    for (const auto& [depth, crossings] : expected) {
        EXPECT_EQ(layers.crossings({1.0, 4.0, depth}), crossings) << depth;
        EXPECT_EQ(layers.inside({1.0, 4.0, depth}), crossings % 2 != 0) << depth;
        EXPECT_EQ(layers.crossings({5.0, 4.0, depth}), 0u) << "the empty column";
    }
    for (const glm::dvec3& outside :
         {glm::dvec3(-0.1, 4, 2), {8.1, 4, 2}, {1, -0.1, 2}, {1, 4, -0.1}, {1, 4, 8.1}})
        EXPECT_EQ(layers.crossings(outside), 0u);
}

TEST(SpriteLayers, VoxelsAreThoseWhoseCentresLieInside) {
    const BitGrid voxels = someLayers().voxels().value();
    for (std::uint32_t slice = 0; slice < 8; ++slice) {
        const bool expected = slice == 1 || slice == 2 || slice == 5;
        EXPECT_EQ(voxels.test({0, 0, slice}), expected) << slice;
        EXPECT_FALSE(voxels.test({1, 0, slice}));
    }
    // Many words, and slices that are not equally deep.
    const auto deep = GridTransform::box(kEight, {1, 1, 300}).value();
    const auto full = SpriteLayers::create(deep, 2, {0.0f, 1.5f}).value();
    EXPECT_EQ(full.voxels()->count(), 300u);
    const auto uneven =
        GridTransform::box(kEight, {1, 1, 2}, Axis::Z, SliceDistribution::custom({0, 0.25f, 1}))
            .value();
    const auto near = SpriteLayers::create(uneven, 2, {0.0f, 0.5f}).value().voxels().value();
    EXPECT_TRUE(near.test({0, 0, 0}));
    EXPECT_FALSE(near.test({0, 0, 1})) << "its centre is at 0.625";
}

TEST(SpriteLayers, RefusesWhatDoesNotFit) {
    const auto transform = GridTransform::box(kEight, {2, 1, 8}).value();
    EXPECT_THAT(SpriteLayers::create(transform, 4, {1.0f}).error().text,
                HasSubstr("8 depths, found 2 x 1 x 8 orthographic and 1"));
    const auto perspective =
        GridTransform::camera(GridCamera::perspective(glm::dmat4(1.0), 1, 1, 1, 2), {1, 1, 1})
            .value();
    EXPECT_THAT(SpriteLayers::create(perspective, 1, {1.0f}).error().text,
                HasSubstr("expected an orthographic transform"));
}

TEST(FitSprite, HoldsItsBox) {
    const Box3 box{{3, -2, 7}, {5, 3, 7.5}};
    for (const glm::dvec3& direction : spriteDirections()) {
        const auto transform = fitSprite(box, direction, 64).value();
        EXPECT_EQ(std::max(transform.size().x, transform.size().y), 64u);
        for (int corner = 0; corner < 8; ++corner) {
            const glm::dvec3 point((corner & 1) != 0 ? box.max.x : box.min.x,
                                   (corner & 2) != 0 ? box.max.y : box.min.y,
                                   (corner & 4) != 0 ? box.max.z : box.min.z);
            const glm::dvec3 place = transform.worldToGrid(point);
            for (int axis = 0; axis < 2; ++axis) {
                EXPECT_GE(place[axis], 1.0 - 1e-6);
                EXPECT_LE(place[axis], transform.size()[axis] - 1.0 + 1e-6);
            }
            EXPECT_GT(place.z, 0.0);
            EXPECT_LT(place.z, transform.size().z);
        }
        // Columns are square, and run along the direction.
        const glm::dvec3 origin = transform.gridToWorld({0, 0, 0});
        EXPECT_NEAR(glm::distance(origin, transform.gridToWorld({1, 0, 0})),
                    glm::distance(origin, transform.gridToWorld({0, 1, 0})), 1e-12);
        const glm::dvec3 along = transform.gridToWorld({0, 0, 1}) - origin;
        EXPECT_NEAR(glm::dot(glm::normalize(along), direction), 1.0, 1e-12);
    }
    // A flat box along its plane and across it.
    EXPECT_TRUE(fitSprite({{0, 0, 0}, {1, 1, 0}}, {0, 0, 1}, 16));
    EXPECT_TRUE(fitSprite({{0, 0, 0}, {0, 0, 1}}, {0, 0, 1}, 16));
}

TEST(FitSprite, ErrorsSayWhatIsWrong) {
    EXPECT_THAT(fitSprite({}, {0, 0, 1}, 32).error().text, HasSubstr("a finite box"));
    EXPECT_THAT(fitSprite(kUnitBox, {0, 0, 0}, 32).error().text, HasSubstr("not zero"));
    for (const double bad :
         {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
        EXPECT_THAT(fitSprite(kUnitBox, {0, bad, 1}, 32).error().text,
                    HasSubstr("a finite direction"));
        EXPECT_THAT(fitSprite({{-1, -1, -1}, {1, bad, 1}}, {0, 0, 1}, 32).error().text,
                    HasSubstr("a finite box"));
    }
    EXPECT_FALSE(fitSprite(kUnitBox, {0, 0, 1}, 32, 0)) << "no slices";
    EXPECT_THAT(fitSprite(kUnitBox, {0, 0, 1}, 3).error().text,
                HasSubstr("at least 4 columns, found 3"));
}

} // namespace
} // namespace lamina
