// Voxelized shadow volumes agree with ray casting: point, spot and directional lights, on and off
// screen, from our own depth maps and from the host's.

#include "gl/support/gl_test.hpp"

#include <lamina/voxelize/epipolar_voxelizer.hpp>

#include <reference/epipolar_rays.hpp>
#include <reference/shapes.hpp>

#include <glm/geometric.hpp>
#include <glm/gtc/matrix_transform.hpp>

#include <cmath>
#include <cstdio>
#include <random>

namespace lamina {
namespace {

struct Agreement {
    std::size_t points = 0;
    std::size_t lit = 0;
    std::size_t disagreements = 0;
    std::size_t ideal =
        0; ///< Disagreements of exact visibility at the centre of the point's voxel.
    std::size_t unproved = 0; ///< Disagreements without a shadow boundary nearby.
};

/// Is there a shadow boundary within `radius` voxels of the point? Looks for a place there whose
/// visibility differs.
bool isNearBoundary(const reference::ShadowRays& rays, const EpipolarTransform& transform,
                    const glm::dvec3& world, bool isLit, double radius, std::mt19937& random) {
    const glm::dvec3 voxel = transform.worldToVoxel(world);
    std::uniform_real_distribution<double> offset(-radius, radius);
    constexpr int kTries = 4000;
    for (int i = 0; i < kTries; ++i) {
        const glm::dvec3 shift(offset(random), offset(random), offset(random));
        if (glm::length(shift) > radius)
            continue;
        const glm::dvec3 place = transform.voxelToWorld(voxel + shift);
        if (std::isfinite(place.x + place.y + place.z) &&
            rays.lit(transform.light(), place) != isLit)
            return true;
    }
    return false;
}

/// Compares random points of the scene that the camera sees.
Agreement compareWithRays(const EpipolarBits& bits, const reference::ShadowRays& rays,
                          const GridCamera& eye, std::size_t count) {
    const EpipolarTransform& transform = bits.transforms().front();
    const GridTransform view = GridTransform::camera(eye, {1, 1, 1}).value();
    std::mt19937 random(11);
    std::uniform_real_distribution<double> x(-3.0, 3.0);
    std::uniform_real_distribution<double> y(0.0, 1.6);
    Agreement result;
    while (result.points < count) {
        const glm::dvec3 point(x(random), y(random), x(random));
        if (!view.voxelAt(point))
            continue;
        ++result.points;
        const bool isLit = rays.lit(transform.light(), point);
        result.lit += isLit ? 1 : 0;
        const glm::dvec3 center = glm::floor(transform.worldToVoxel(point)) + 0.5;
        result.ideal +=
            rays.lit(transform.light(), transform.voxelToWorld(center)) != isLit ? 1 : 0;
        if (bits.lit(0, point) == isLit)
            continue;
        ++result.disagreements;
        if (!isNearBoundary(rays, transform, point, isLit, 1.5, random)) {
            if (++result.unproved <= 5) {
                const glm::dvec3 voxel = transform.worldToVoxel(point);
                std::printf("unproved: %g %g %g voxel %g %g %g lit %d\n", point.x, point.y, point.z,
                            voxel.x, voxel.y, voxel.z, isLit);
            }
        }
    }
    return result;
}

GridCamera camera(const glm::dvec3& from, const glm::dvec3& to) {
    return GridCamera::perspective(glm::lookAt(from, to, glm::dvec3(0, 1, 0)), 1.0, 1.25, 0.1,
                                   10.0);
}

EpipolarLight pointLight(const glm::dvec3& position) {
    return {LightKind::Point, position, {0, 0, -1}, 1.0};
}
EpipolarLight sun(const glm::dvec3& direction) {
    return {LightKind::Directional, {0, 0, 0}, direction, 1.0};
}
EpipolarLight spot(const glm::dvec3& position, const glm::dvec3& direction, double angle) {
    return {LightKind::Spot, position, direction, angle};
}

struct LightCase {
    const char* name;
    EpipolarLight light;
    GridCamera eye;
};

std::vector<LightCase> lightCases() {
    const GridCamera front = camera({0.5, 1.6, 5.0}, {0.0, 0.6, 0.0});
    return {
        {"point on screen", pointLight({0.6, 2.2, -2.6}), front},
        {"point off screen", pointLight({-3.5, 3.0, 1.0}), front},
        {"point behind the camera", pointLight({1.5, 2.6, 7.0}), front},
        {"sun off screen", sun({0.7, -0.6, 0.3}), front},
        {"sun on screen", sun({0.1, -0.2, 1.0}), front},
        {"sun behind the camera", sun({0.2, -0.5, -1.0}), front},
        {"spot", spot({2.0, 2.8, -3.0}, {-0.5, -0.6, 0.8}, 0.5), front},
    };
}

class EpipolarGlTest : public test::GlTest {
protected:
    const TriangleMesh mScene = reference::makeFenceScene();
    const reference::ShadowRays mRays{mScene};
};

TEST_F(EpipolarGlTest, VisibilityAgreesWithRayCasting) {
    auto buffers = MeshBuffers::upload(device(), mScene).value();
    const GeometrySource source = buffers.view();
    auto voxelizer = EpipolarVoxelizer::create(device(), {.depthMapTexels = 2048}).value();
    auto grid = EpipolarGrid::create(device()).value();
    for (const LightCase& test : lightCases()) {
        SCOPED_TRACE(test.name);
        const auto transform = EpipolarTransform::fit(test.eye, test.light, {512, 512, 512});
        ASSERT_TRUE(transform) << transform.error().text;
        auto stats = voxelizer.voxelize({&source, 1}, {&*transform, 1}, grid);
        ASSERT_TRUE(stats) << stats.error().text;
        const EpipolarBits bits = grid.download().value();
        const Agreement found = compareWithRays(bits, mRays, test.eye, 100000);
        std::printf("%-24s maps %u, lit %.1f %%, disagree %.3f %% (ideal %.3f %%), unproved %zu\n",
                    test.name, stats->depthMaps, 100.0 * found.lit / found.points,
                    100.0 * found.disagreements / found.points, 100.0 * found.ideal / found.points,
                    found.unproved);
        EXPECT_GT(found.lit, found.points / 10);
        EXPECT_LT(found.lit, found.points * 95 / 100);
        EXPECT_LE(found.disagreements, found.points / 50);
        EXPECT_EQ(found.unproved, 0u);
    }
}

} // namespace
} // namespace lamina
