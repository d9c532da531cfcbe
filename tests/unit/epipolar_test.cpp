// EpipolarTransform and EpipolarBits on the host.

#include <lamina/voxelize/epipolar_bits.hpp>

#include <glm/geometric.hpp>
#include <glm/gtc/matrix_transform.hpp>
#include <gmock/gmock.h>

#include <cmath>
#include <random>

namespace lamina {
namespace {

using testing::HasSubstr;

GridCamera eyeAt(const glm::dvec3& place, const glm::dvec3& target) {
    return GridCamera::perspective(glm::lookAt(place, target, glm::dvec3(0, 1, 0)), 0.9, 1.5, 0.25,
                                   20.0);
}

EpipolarLight randomLight(std::mt19937& random) {
    std::uniform_real_distribution<double> place(-12.0, 12.0);
    const glm::dvec3 vector(place(random), place(random), place(random));
    if (random() % 3 == 0)
        return {.kind = LightKind::Directional, .direction = vector};
    return {.position = vector};
}

TEST(EpipolarTransform, KnownAngles) {
    EpipolarRanges ranges;
    ranges.thetaZero = {0, 1, 0};
    const EpipolarTransform transform =
        EpipolarTransform::create({0, 0, 0}, {.position = {0, 0, -2}}, ranges, {180, 360, 180})
            .value();
    // A right angle at the eye, 45 degrees at the light; theta 0 is up, +90 is axis x up.
    const glm::dvec3 up = transform.worldToVoxel({0, 2, 0});
    EXPECT_NEAR(up.x, 90.0, 1e-9);
    EXPECT_NEAR(up.y, 180.0, 1e-9);
    EXPECT_NEAR(up.z, 45.0, 1e-9);
    const glm::dvec3 side = transform.worldToVoxel({2, 0, -2});
    EXPECT_NEAR(side.x, 45.0, 1e-9);
    EXPECT_NEAR(side.y, 270.0, 1e-9);
    EXPECT_NEAR(side.z, 90.0, 1e-9);
    EXPECT_TRUE(transform.isFullCircle());
}

TEST(EpipolarTransform, DirectionalMeasuresDistanceFromTheAxis) {
    EpipolarRanges ranges;
    ranges.phi = {0.0, 8.0};
    ranges.thetaZero = {1, 0, 0};
    const EpipolarTransform transform =
        EpipolarTransform::create({0, 0, 0},
                                  {.kind = LightKind::Directional, .direction = {0, -3, 0}}, ranges,
                                  {180, 4, 16})
            .value();
    const glm::dvec3 place = transform.worldToVoxel({3, 3, 0});
    EXPECT_NEAR(place.x, 45.0, 1e-9);
    EXPECT_NEAR(place.z, 6.0, 1e-9);
}

TEST(EpipolarTransform, WorldAndVoxelAreInverse) {
    std::mt19937 random(3);
    std::uniform_real_distribution<double> place(-10.0, 10.0);
    for (int i = 0; i < 2000; ++i) {
        const EpipolarTransform transform =
            EpipolarTransform::fit(eyeAt({1, 2, 9}, {0, 0, 0}), randomLight(random), {64, 32, 100})
                .value();
        const glm::dvec3 world(place(random), place(random), place(random));
        const glm::dvec3 back = transform.voxelToWorld(transform.worldToVoxel(world));
        ASSERT_LT(glm::length(back - world), 1e-8) << i;
    }
}

TEST(EpipolarTransform, FitCoversWhatTheEyeSeesAndHardlyMore) {
    std::mt19937 random(4);
    std::uniform_real_distribution<double> unit(0.0, 1.0);
    double alphaShare = 0.0;
    double thetaShare = 0.0;
    double phiShare = 0.0;
    constexpr int kLights = 60;
    for (int i = 0; i < kLights; ++i) {
        const GridCamera eye = eyeAt({1, 2, 9}, {unit(random) * 4, 0, 0});
        const GridTransform view = GridTransform::camera(eye, {1, 1, 1}).value();
        const glm::uvec3 size(256, 256, 256);
        const EpipolarTransform transform =
            EpipolarTransform::fit(eye, randomLight(random), size).value();
        glm::dvec3 low(1e30);
        glm::dvec3 high(-1e30);
        const auto visit = [&](const glm::dvec3& grid) {
            const glm::dvec3 voxel = transform.worldToVoxel(view.gridToWorld(grid));
            low = glm::min(low, voxel);
            high = glm::max(high, voxel);
        };
        for (int sample = 0; sample < 20000; ++sample) {
            // Ranges are reached on the sides and at the far plane.
            glm::dvec3 grid(unit(random), unit(random), unit(random) < 0.5 ? 1.0 : unit(random));
            if (sample % 2 == 0)
                grid[sample / 2 % 2] = sample % 8 < 4 ? 0.0 : 1.0;
            visit(grid);
        }
        for (const double x : {0.0, 1.0})
            for (const double y : {0.0, 1.0})
                for (const double z : {0.0, 1.0})
                    visit({x, y, z});
        for (int axis = 0; axis < 3; ++axis) {
            ASSERT_GT(low[axis], -1e-6) << "light " << i << " axis " << axis;
            ASSERT_LT(high[axis], size[axis] + 1e-6) << "light " << i << " axis " << axis;
        }
        alphaShare += (high.x - low.x) / size.x / kLights;
        thetaShare += (high.y - low.y) / size.y / kLights;
        phiShare += (high.z - low.z) / size.z / kLights;
    }
    EXPECT_GT(alphaShare, 0.97);
    EXPECT_GT(thetaShare, 0.97);
    EXPECT_GT(phiShare, 0.9); // the far plane is nearer than the far corners
}

TEST(EpipolarTransform, OffScreenLightsGetNarrowRanges) {
    const EpipolarTransform transform =
        EpipolarTransform::fit(eyeAt({0, 0, 0}, {0, 0, -1}), {.position = {30, 0, -1}},
                               {64, 64, 64})
            .value();
    const EpipolarRanges& ranges = transform.ranges();
    EXPECT_LT(ranges.alpha.y - ranges.alpha.x, 1.5);
    EXPECT_LT(ranges.theta.y - ranges.theta.x, 2.0);
    EXPECT_LT(ranges.phi.y, 1.1);
    EXPECT_FALSE(transform.isFullCircle());
}

TEST(EpipolarTransform, RefusesWhatHasNoEpipolarSpace) {
    const glm::uvec3 size(8, 8, 8);
    const GridCamera eye = eyeAt({0, 0, 0}, {0, 0, -1});
    const auto text = [](const Result<EpipolarTransform>& result) {
        return result ? std::string("no error") : result.error().text;
    };
    EXPECT_THAT(text(EpipolarTransform::fit(eye, {.position = {0, 0, 0}}, size)),
                HasSubstr("expected the light away from the eye"));
    EXPECT_THAT(text(EpipolarTransform::fit({}, {.position = {0, 1, 0}}, size)),
                HasSubstr("found an orthographic one"));
    EXPECT_THAT(text(EpipolarTransform::fit(
                    eye, {.kind = LightKind::Directional, .direction = {0, 0, 0}}, size)),
                HasSubstr("light direction of some length"));
    EXPECT_THAT(text(EpipolarTransform::fit(
                    eye, {.kind = LightKind::Spot, .position = {1, 0, 0}, .coneAngle = 4.0}, size)),
                HasSubstr("cone angle in (0, pi), found 4"));
    EXPECT_THAT(text(EpipolarTransform::fit(
                    eye, {.kind = static_cast<LightKind>(9), .position = {1, 0, 0}}, size)),
                HasSubstr("found LightKind value 9"));
    EXPECT_THAT(text(EpipolarTransform::fit(eye, {.position = {1, NAN, 0}}, size)),
                HasSubstr("finite light position"));
    EXPECT_THAT(text(EpipolarTransform::fit(eye, {.position = {1, 0, 0}}, {8, 0, 8})),
                HasSubstr("found 8 x 0 x 8"));
    EpipolarRanges ranges;
    ranges.alpha = {1.0, 1.0};
    EXPECT_THAT(text(EpipolarTransform::create({0, 0, 0}, {.position = {1, 0, 0}}, ranges, size)),
                HasSubstr("expected increasing ranges"));
    ranges = {};
    ranges.farDistance = 0.0;
    EXPECT_THAT(text(EpipolarTransform::create({0, 0, 0}, {.position = {1, 0, 0}}, ranges, size)),
                HasSubstr("far distance above 0"));
}

/// One eye ray of 300 samples, shadowed in [100, 150).
class EpipolarBitsRay : public testing::Test {
protected:
    EpipolarBitsRay() {
        for (std::uint32_t phi = 100; phi < 150; ++phi)
            mBits.set(0, {1, 0, phi});
    }
    [[nodiscard]] glm::dvec3 at(double alpha, double theta, double phi) const {
        return mBits.transforms()[0].voxelToWorld({alpha, theta, phi});
    }
    EpipolarBits mBits = [] {
        EpipolarRanges ranges;
        ranges.alpha = {0.5, 1.3};
        ranges.theta = {-1.0, 1.0};
        ranges.phi = {0.0, 1.5};
        const EpipolarTransform transform =
            EpipolarTransform::create({0, 0, 0}, {.position = {0, 5, 0}}, ranges, {4, 2, 300})
                .value();
        return EpipolarBits::create({&transform, 1}, {.bitsPerTexel = 127}).value();
    }();
};

TEST_F(EpipolarBitsRay, QueriesHaveKnownAnswers) {
    EXPECT_TRUE(mBits.lit(0, at(1.5, 0.25, 99.9)));
    EXPECT_FALSE(mBits.lit(0, at(1.5, 0.25, 100.1)));
    EXPECT_TRUE(mBits.lit(0, at(2.5, 0.25, 120.0)));
    EXPECT_TRUE(mBits.lit(0, at(1.5, 1.25, 120.0)));
    EXPECT_NEAR(mBits.shadowedFraction(0, at(1.5, 0.25, 100.0)), 0.0, 1e-9);
    EXPECT_NEAR(mBits.shadowedFraction(0, at(1.5, 0.25, 120.25)), 20.25 / 120.25, 1e-9);
    EXPECT_NEAR(mBits.shadowedFraction(0, at(1.5, 0.25, 200.0)), 0.25, 1e-9);
    // Half a sample before the edge's two centres, and halfway between the two theta samples.
    EXPECT_NEAR(mBits.litInterpolated(0, at(1.5, 0.5, 100.0)), 0.5, 1e-9);
    EXPECT_NEAR(mBits.litInterpolated(0, at(1.5, 1.0, 120.0)), 0.5, 1e-9);
    EXPECT_NEAR(mBits.litInterpolated(0, at(1.5, 1.0, 100.25)), 1.0 - 0.5 * 0.75, 1e-9);
    EXPECT_NEAR(mBits.shadowedFractionInterpolated(0, at(1.5, 1.0, 200.0)), 0.125, 1e-9);
    // The ramp from 99.5 to 100.5 has the area 1/8 up to its middle.
    EXPECT_NEAR(mBits.shadowedFractionInterpolated(0, at(1.5, 0.5, 100.0)), 0.125 / 100.0, 1e-9);
}

TEST_F(EpipolarBitsRay, PointsOutsideAnswerForTheNearestVoxel) {
    EXPECT_FALSE(mBits.lit(0, at(1.5, -0.6, 120.0)));
    mBits.set(0, {0, 0, 299});
    EXPECT_FALSE(mBits.lit(0, at(-0.4, 0.5, 320.0)));
}

TEST(EpipolarBits, RefusesMixedSizesAndOddTexels) {
    const auto volume = [](std::uint32_t alpha) {
        return EpipolarTransform::create({0, 0, 0}, {.position = {0, 5, 0}}, {}, {alpha, 4, 4})
            .value();
    };
    const EpipolarTransform mixed[] = {volume(4), volume(5)};
    EXPECT_THAT(EpipolarBits::create(mixed).error().text,
                HasSubstr("found 4 x 4 x 4 epipolar and 5 x 4 x 4 epipolar"));
    EXPECT_THAT(EpipolarBits::create({}).error().text, HasSubstr("at least one shadow volume"));
    EXPECT_THAT(EpipolarBits::create({mixed, 1}, {.bitsPerTexel = 126}).error().text,
                HasSubstr("127 or 128 bits per texel, found 126"));
    EXPECT_THAT(EpipolarBits::create({mixed, 1}, {.epipoleVoxels = -1.0}).error().text,
                HasSubstr("epipole rule of 0 or more voxels"));
}

TEST(EpipolarBits, TheEpipoleRuleComparesWithTheLight) {
    EpipolarRanges ranges;
    ranges.alpha = {0.0, 1.0};
    const EpipolarTransform transform =
        EpipolarTransform::create({0, 0, 0}, {.position = {0, 5, 0}}, ranges, {10, 8, 64}).value();
    EpipolarBits bits = EpipolarBits::create({&transform, 1}, {.epipoleVoxels = 1.0}).value();
    std::ranges::fill(bits.words(), 0xffffffffu);
    EXPECT_TRUE(bits.lit(0, {0.0, 6.0, 0.1}));
    EXPECT_FALSE(bits.lit(0, {0.0, 4.0, 0.1}));
    EXPECT_EQ(bits.shadowedFraction(0, {0.0, 6.0, 0.1}), 0.0);
    EXPECT_EQ(bits.shadowedFraction(0, {0.0, 4.0, 0.1}), 1.0);
    EXPECT_FALSE(bits.lit(0, {0.0, 6.0, 1.0})) << "outside the rule's angle the voxel decides";
}

} // namespace
} // namespace lamina
