// Transmittance of point and spot lights among and before shells of leaves.

#include "gl/support/transmittance_probe.hpp"

#include <lamina/voxelize/geometry_source.hpp>

#include <glm/geometric.hpp>
#include <gmock/gmock.h>
#include <reference/shapes.hpp>

#include <cmath>
#include <optional>
#include <random>

namespace lamina {
namespace {

using test::kRounding;
using test::kSigma;

/// Leaves, or opaque shells, around a light in the midst of them.
class TransmittanceShellsGlTest : public test::TransmittanceGlTest {
protected:
    const glm::dvec3 mCenter{3.0, -2.0, 5.0};

    std::vector<test::ProbePoint> pointsAround(double radius, std::size_t count) {
        std::normal_distribution<double> normal;
        std::vector<test::ProbePoint> points;
        while (points.size() < count) {
            const glm::dvec3 direction =
                glm::normalize(glm::dvec3(normal(mRandom), normal(mRandom), normal(mRandom)));
            points.push_back({mCenter + radius * direction, direction});
        }
        // The seams between faces, where two or three coordinates are equal.
        for (int i = 0; i < 26; ++i) {
            const glm::dvec3 corner((i + 1) % 3 - 1, (i + 1) / 3 % 3 - 1, (i + 1) / 9 - 1);
            if (glm::length(corner) > 0.0)
                points.push_back({mCenter + radius * glm::normalize(corner), corner});
        }
        return points;
    }

    /// A ball of leaves of radius 1.
    TransmittanceCasters shell() {
        mShell.emplace(
            MeshBuffers::upload(device(), reference::makeIcosphere(glm::vec3(mCenter), 1.0f, 3))
                .value());
        mLeaves = mShell->view();
        TransmittanceCasters casters;
        casters.leaves = {&mLeaves, 1};
        casters.bounds = {mCenter - 1.0, mCenter + 1.0};
        return casters;
    }

    void TearDown() override {
        mShell.reset();
        TransmittanceGlTest::TearDown();
    }

    std::mt19937 mRandom{11};
    std::optional<MeshBuffers> mShell;
    GeometrySource mLeaves;
};

TEST_F(TransmittanceShellsGlTest, PointLightSeesAllAround) {
    const float radii[] = {3.0f, 2.0f, 1.0f};
    const auto shells =
        MeshBuffers::upload(device(), reference::makeNestedShells(glm::vec3(mCenter), radii, 3))
            .value();
    const auto shell =
        MeshBuffers::upload(device(), reference::makeIcosphere(glm::vec3(mCenter), 2.5f, 3))
            .value();
    const GeometrySource leaves[] = {shells.view()};
    const GeometrySource opaque[] = {shell.view()};
    TransmittanceCasters casters;
    casters.leaves = leaves;
    casters.bounds = {mCenter - 3.01, mCenter + 3.01};
    TransmittanceLight light;
    light.kind = LightKind::Point;
    light.position = mCenter;
    light.near = 0.05;
    for (const bool local : {false, true}) {
        TransmittanceDesc desc;
        desc.size = {96, 96, 256};
        desc.localRanges = local;
        desc.maxFaces = 6;
        Transmittance transmittance = Transmittance::create(device(), desc).value();
        for (const bool withOpaque : {false, true}) {
            casters.opaque = withOpaque ? std::span(opaque) : std::span<const GeometrySource>();
            const auto stats = transmittance.prepare(light, casters);
            ASSERT_TRUE(stats) << stats.error().text;
            EXPECT_EQ(stats->faces, 6u);
            for (const TransmittanceSettings& settings : {plain(kSigma), attenuating(kSigma)}) {
                ASSERT_TRUE(transmittance.setSettings(settings));
                for (int n = 0; n <= 3; ++n) {
                    const auto points = pointsAround(0.7 + n, 2000);
                    const double expected = withOpaque && n >= 2 ? 0.0 : std::pow(1.0 - kSigma, n);
                    const auto found = probe(transmittance, points);
                    for (std::size_t i = 0; i < points.size(); ++i)
                        EXPECT_NEAR(found[i].x, expected, kRounding)
                            << n << (withOpaque ? " opaque " : " ")
                            << (local ? "local " : "uniform ") << points[i].normal.x << ' '
                            << points[i].normal.y << ' ' << points[i].normal.z << " "
                            << settings.filterWidth;
                }
            }
        }
    }
}

TEST_F(TransmittanceShellsGlTest, DistantPointLightNeedsOneFaceAndNearOneSeveral) {
    const TransmittanceCasters casters = shell();
    TransmittanceLight light;
    light.kind = LightKind::Point;
    light.position = mCenter + glm::dvec3(4.0, 3.0, -2.0);
    TransmittanceDesc desc;
    desc.size = {128, 128, 128};
    Transmittance one = Transmittance::create(device(), desc).value();
    auto stats = one.prepare(light, casters);
    ASSERT_TRUE(stats) << stats.error().text;
    EXPECT_EQ(stats->faces, 1u);
    ASSERT_TRUE(one.setSettings(attenuating(kSigma)));
    const glm::dvec3 away = glm::normalize(mCenter - light.position);
    const test::ProbePoint points[] = {{mCenter - 1.5 * away},
                                       {mCenter},
                                       {mCenter + 1.5 * away},
                                       {light.position + glm::dvec3(0, 9, 0)},
                                       {light.position - 9.0 * away}};
    const double counts[] = {0, 1, 2, 0, 0};
    auto found = probe(one, points);
    for (std::size_t i = 0; i < std::size(points); ++i)
        EXPECT_NEAR(found[i].x, std::pow(1.0 - kSigma, counts[i]), kRounding) << i;

    light.position = mCenter + glm::dvec3(1.2, 0.0, 0.0);
    const auto refused = one.prepare(light, casters);
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().code, ErrorCode::DeviceLimit);
    EXPECT_THAT(refused.error().text, testing::HasSubstr("maxFaces"));
    desc.maxFaces = 6;
    Transmittance six = Transmittance::create(device(), desc).value();
    stats = six.prepare(light, casters);
    ASSERT_TRUE(stats) << stats.error().text;
    EXPECT_LT(stats->faces, 6u); // Nothing is behind the light.
    ASSERT_TRUE(six.setSettings(attenuating(kSigma)));
    const test::ProbePoint near[] = {
        {mCenter}, {mCenter - glm::dvec3(2, 0, 0)}, {light.position + glm::dvec3(3, 0.1, 0)}};
    found = probe(six, near);
    for (std::size_t i = 0; i < 3; ++i)
        EXPECT_NEAR(found[i].x, std::pow(1.0 - kSigma, i == 2 ? 0 : i + 1), kRounding) << i;
}

TEST_F(TransmittanceShellsGlTest, SpotLightHasACone) {
    const TransmittanceCasters casters = shell();
    TransmittanceLight light;
    light.kind = LightKind::Spot;
    light.direction = {0.0, -3.0, 0.0};
    light.coneAngle = 0.3;
    for (const double height : {0.0, 5.0}) {
        light.position = mCenter + glm::dvec3(0.0, height, 0.0);
        Transmittance transmittance =
            Transmittance::create(device(), {.size = {64, 64, 128}}).value();
        const auto stats = transmittance.prepare(light, casters);
        ASSERT_TRUE(stats) << stats.error().text;
        ASSERT_TRUE(transmittance.setSettings(attenuating(kSigma)));
        const double below = height + 4.0;
        const double rim = below * std::tan(0.3);
        const test::ProbePoint points[] = {
            {light.position + glm::dvec3(0.1, -below, 0.0)},
            {light.position + glm::dvec3(0.98 * rim, -below, 0.0)},
            {light.position + glm::dvec3(1.02 * rim, -below, 0.0)},
            {light.position + glm::dvec3(0.0, 1.0, 0.0)},
        };
        const bool rimIsCovered = height == 0.0 || 0.98 * std::tan(0.3) * 5.0 < 0.9;
        const auto found = probe(transmittance, points);
        EXPECT_NEAR(found[0].x, std::pow(1.0 - kSigma, height == 0.0 ? 1 : 2), kRounding);
        EXPECT_NEAR(found[1].x, rimIsCovered ? 1.0 - kSigma : 1.0, kRounding) << height;
        EXPECT_EQ(found[2].x, 0.0f);
        EXPECT_EQ(found[3].x, 0.0f);
    }
}

} // namespace
} // namespace lamina
