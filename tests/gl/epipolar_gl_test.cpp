// Voxelized shadow volumes agree with ray casting: point, spot and directional lights, on and off
// screen, from our own depth maps and from the host's.

#include "gl/support/gl_test.hpp"

#include <lamina/voxelize/epipolar_voxelizer.hpp>

#include <reference/epipolar_agreement.hpp>
#include <reference/shapes.hpp>

#include <glm/geometric.hpp>
#include <glm/gtc/matrix_transform.hpp>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <random>

namespace lamina {
namespace {

using reference::Agreement;
using reference::compareWithRays;
using reference::LightCase;
using reference::makeLightCases;

const GridCamera kFront = reference::frontEye();

EpipolarLight pointLight(const glm::dvec3& place) {
    return {.position = place};
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
    for (const LightCase& test : makeLightCases()) {
        SCOPED_TRACE(test.name);
        const auto transform = EpipolarTransform::fit(kFront, test.light, {512, 512, 512});
        ASSERT_TRUE(transform) << transform.error().text;
        auto stats = voxelizer.voxelize({&source, 1}, {&*transform, 1}, grid);
        ASSERT_TRUE(stats) << stats.error().text;
        const EpipolarBits bits = grid.download().value();
        const Agreement found = compareWithRays(bits, 0, mRays, kFront, 100000);
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

TEST_F(EpipolarGlTest, LightsAnywhereGetTheDepthMapsTheyNeed) {
    auto buffers = MeshBuffers::upload(device(), mScene).value();
    const GeometrySource source = buffers.view();
    auto voxelizer = EpipolarVoxelizer::create(device(), {.depthMapTexels = 512}).value();
    std::mt19937 random(17);
    std::uniform_real_distribution<double> across(-7.0, 7.0);
    std::uniform_real_distribution<double> up(0.5, 4.0);
    std::vector<EpipolarTransform> transforms;
    for (int i = 0; i < 60; ++i) {
        EpipolarLight light = pointLight({across(random), up(random), across(random)});
        if (i % 4 == 0)
            light = {.kind = LightKind::Directional,
                     .direction = {across(random), -up(random), across(random)}};
        transforms.push_back(EpipolarTransform::fit(kFront, light, {128, 128, 128}).value());
    }
    auto grid = EpipolarGrid::create(device()).value();
    const auto stats = voxelizer.voxelize({&source, 1}, transforms, grid);
    ASSERT_TRUE(stats) << stats.error().text;
    EXPECT_LT(stats->depthMaps, 5 * transforms.size());
    const EpipolarBits bits = grid.download().value();
    std::size_t disagreements = 0;
    std::size_t ideal = 0;
    for (std::size_t vsv = 0; vsv < transforms.size(); ++vsv) {
        const Agreement found = compareWithRays(bits, vsv, mRays, kFront, 2000, -1.5);
        EXPECT_EQ(found.unproved, 0u) << vsv;
        disagreements += found.disagreements;
        ideal += found.ideal;
    }
    std::printf("60 lights: %zu of 120000 points disagree, ideal %zu, %u maps\n", disagreements,
                ideal, stats->depthMaps);
    EXPECT_LE(disagreements, ideal + ideal / 10);
}

TEST_F(EpipolarGlTest, ManyVolumesTiledEqualSingleOnes) {
    auto buffers = MeshBuffers::upload(device(), mScene).value();
    const GeometrySource source = buffers.view();
    auto voxelizer = EpipolarVoxelizer::create(device(), {.depthMapTexels = 128}).value();
    std::vector<EpipolarTransform> transforms;
    for (int i = 0; i < 64; ++i)
        transforms.push_back(EpipolarTransform::fit(kFront,
                                                    pointLight({i % 8 - 3.5, 3.0, i / 8 - 3.5}),
                                                    {128, 128, 128})
                                 .value());
    auto many = EpipolarGrid::create(device()).value();
    auto stats = voxelizer.voxelize({&source, 1}, transforms, many);
    ASSERT_TRUE(stats) << stats.error().text;
    EXPECT_EQ(stats->shadowVolumes, 64u);
    const EpipolarBits all = many.download().value();
    auto one = EpipolarGrid::create(device()).value();
    for (std::size_t i = 0; i < transforms.size(); ++i) {
        ASSERT_TRUE(voxelizer.voxelize({&source, 1}, {&transforms[i], 1}, one));
        const EpipolarBits single = one.download().value();
        ASSERT_TRUE(std::ranges::equal(
            single.words(), all.words().subspan(all.texelIndex(i, 0, 0, 0), single.words().size())))
            << i;
    }
    // Fewer volumes than before keep the memory, and their bits.
    const std::uint64_t bytes = many.gpuBytes();
    const GLuint texture = many.texture();
    ASSERT_TRUE(voxelizer.voxelize({&source, 1}, {transforms.data(), 5}, many));
    EXPECT_EQ(many.gpuBytes(), bytes);
    EXPECT_EQ(many.texture(), texture);
    const EpipolarBits few = many.download().value();
    EXPECT_TRUE(std::ranges::equal(few.words(), all.words().first(few.words().size())));
}

TEST_F(EpipolarGlTest, BatchesOfDepthMapsEqualSingleOnes) {
    auto buffers = MeshBuffers::upload(device(), mScene).value();
    const GeometrySource source = buffers.view();
    auto voxelizer = EpipolarVoxelizer::create(device(), {.depthMapTexels = 2048}).value();
    std::vector<EpipolarTransform> transforms;
    for (const double x : {-2.0, -0.5, 0.5, 1.0, 2.0})
        transforms.push_back(
            EpipolarTransform::fit(kFront, pointLight({x, 2.0, -2.5}), {64, 64, 64}).value());
    auto grid = EpipolarGrid::create(device()).value();
    auto stats = voxelizer.voxelize({&source, 1}, transforms, grid);
    ASSERT_TRUE(stats) << stats.error().text;
    EXPECT_GT(stats->batches, 1u);
    EXPECT_LE(stats->depthBytes, 256u << 20);
    const EpipolarBits all = grid.download().value();
    for (std::size_t i = 0; i < transforms.size(); ++i) {
        ASSERT_TRUE(voxelizer.voxelize({&source, 1}, {&transforms[i], 1}, grid));
        const EpipolarBits single = grid.download().value();
        ASSERT_TRUE(
            std::ranges::equal(single.words(), all.words().subspan(all.texelIndex(i, 0, 0, 0),
                                                                   single.words().size())));
    }
}

TEST_F(EpipolarGlTest, TwoStepsEqualOne) {
    auto buffers = MeshBuffers::upload(device(), mScene).value();
    const GeometrySource source = buffers.view();
    auto voxelizer = EpipolarVoxelizer::create(device(), {.depthMapTexels = 512}).value();
    for (const glm::uvec3& size :
         {glm::uvec3(100, 37, 130), glm::uvec3(513, 20, 128), glm::uvec3(2048, 5, 60),
          glm::uvec3(512, 9, 64), glm::uvec3(33, 6, 129), glm::uvec3(1, 1, 1)})
        for (const std::uint32_t bitsPerTexel : {127u, 128u}) {
            const auto transform =
                EpipolarTransform::fit(kFront, pointLight({0.6, 2.2, -2.6}), size).value();
            auto grid = EpipolarGrid::create(device(), {.bitsPerTexel = bitsPerTexel}).value();
            ASSERT_TRUE(voxelizer.voxelize({&source, 1}, {&transform, 1}, grid));
            const EpipolarBits whole = grid.download().value();
            ASSERT_TRUE(voxelizer.rectify({&source, 1}, {&transform, 1}, grid));
            const EpipolarBits surfaces = grid.download().value();
            ASSERT_TRUE(voxelizer.scan(grid));
            EXPECT_TRUE(std::ranges::equal(grid.download()->words(), whole.words()));
            EXPECT_EQ(std::ranges::equal(surfaces.words(), whole.words()), size.x == 1);
            // 127 and 128 bits a texel hold the same voxels.
            if (bitsPerTexel == 127)
                continue;
            auto other = EpipolarGrid::create(device(), {.bitsPerTexel = 127}).value();
            ASSERT_TRUE(voxelizer.voxelize({&source, 1}, {&transform, 1}, other));
            const EpipolarBits packed = other.download().value();
            for (std::uint32_t phi = 0; phi < size.z; ++phi)
                ASSERT_EQ(packed.test(0, {size.x / 2, size.y / 2, phi}),
                          whole.test(0, {size.x / 2, size.y / 2, phi}));
        }
}

TEST_F(EpipolarGlTest, DrawSourceEqualsMeshView) {
    auto buffers = MeshBuffers::upload(device(), mScene).value();
    const MeshView view = buffers.view();
    GLuint vertexArray = 0;
    gl().CreateVertexArrays(1, &vertexArray);
    gl().EnableVertexArrayAttrib(vertexArray, 3);
    gl().VertexArrayAttribFormat(vertexArray, 3, 3, GL_FLOAT, GL_FALSE, 0);
    gl().VertexArrayAttribBinding(vertexArray, 3, 0);
    gl().VertexArrayVertexBuffer(vertexArray, 0, view.vertexBuffer, 0, 12);
    gl().VertexArrayElementBuffer(vertexArray, view.indexBuffer);
    DrawSource drawn;
    drawn.vertexShader = R"(
        layout(location = 3) in vec3 place;
        LaminaVertex laminaVertex() { return LaminaVertex(place, vec3(0.0), 0u); })";
    drawn.draw = [&](const DrawContext&) {
        gl().BindVertexArray(vertexArray);
        gl().DrawElements(GL_TRIANGLES, static_cast<GLsizei>(view.indexCount), GL_UNSIGNED_INT,
                          nullptr);
    };
    auto voxelizer = EpipolarVoxelizer::create(device(), {.depthMapTexels = 256}).value();
    auto grid = EpipolarGrid::create(device()).value();
    const auto transform =
        EpipolarTransform::fit(kFront, pointLight({0.6, 2.2, -2.6}), {64, 64, 128}).value();
    const GeometrySource sources[] = {view, drawn};
    ASSERT_TRUE(voxelizer.voxelize({&sources[0], 1}, {&transform, 1}, grid));
    const EpipolarBits expected = grid.download().value();
    ASSERT_TRUE(voxelizer.voxelize({&sources[1], 1}, {&transform, 1}, grid));
    EXPECT_TRUE(std::ranges::equal(grid.download()->words(), expected.words()));
    // No sources: nothing casts a shadow.
    ASSERT_TRUE(voxelizer.voxelize(std::span<const GeometrySource>(), {&transform, 1}, grid));
    const EpipolarBits empty = grid.download().value();
    EXPECT_TRUE(std::ranges::all_of(empty.words(), [](std::uint32_t word) { return word == 0; }));
    gl().DeleteVertexArrays(1, &vertexArray);
}

/// Random eye rays and the first surface each meets.
struct VisiblePoint {
    glm::dvec3 place;
    glm::dvec3 direction; ///< Unit.
};
std::vector<VisiblePoint> visiblePoints(const reference::ShadowRays& rays, const GridCamera& eye,
                                        std::size_t count) {
    const GridTransform view = GridTransform::camera(eye, {1, 1, 1}).value();
    const glm::dvec3 from(glm::inverse(eye.worldToEye)[3]);
    std::mt19937 random(23);
    std::uniform_real_distribution<double> unit(0.0, 1.0);
    std::vector<VisiblePoint> points;
    for (std::size_t tries = 0; points.size() < count && tries < 50 * count; ++tries) {
        const glm::dvec3 target = view.gridToWorld({unit(random), unit(random), 1.0});
        const glm::dvec3 direction = glm::normalize(target - from);
        const double distance = rays.firstHit(from, direction);
        if (distance < glm::length(target - from))
            points.push_back({from + distance * direction, direction});
    }
    return points;
}

TEST_F(EpipolarGlTest, ShadowedFractionsAgreeWithRayCasting) {
    auto buffers = MeshBuffers::upload(device(), mScene).value();
    const GeometrySource source = buffers.view();
    auto voxelizer = EpipolarVoxelizer::create(device(), {.depthMapTexels = 1024}).value();
    auto grid = EpipolarGrid::create(device()).value();
    double shadow = 0.0;
    for (const LightCase& test : makeLightCases()) {
        SCOPED_TRACE(test.name);
        const auto transform = EpipolarTransform::fit(kFront, test.light, {512, 512, 512}).value();
        ASSERT_TRUE(voxelizer.voxelize({&source, 1}, {&transform, 1}, grid));
        const EpipolarBits bits = grid.download().value();
        double squares = 0.0;
        double interpolatedSquares = 0.0;
        double mean = 0.0;
        const auto points = visiblePoints(mRays, kFront, 400);
        for (const VisiblePoint& point : points) {
            // Equal steps of phi along the ray, as the voxels take them.
            const glm::dvec3 end = transform.worldToVoxel(point.place);
            constexpr int kSteps = 800;
            int shadowed = 0;
            for (int step = 0; step < kSteps; ++step) {
                const double phi = end.z * (step + 0.5) / kSteps;
                shadowed +=
                    mRays.lit(test.light, transform.voxelToWorld({end.x, end.y, phi})) ? 0 : 1;
            }
            const double expected = static_cast<double>(shadowed) / kSteps;
            mean += expected;
            squares += std::pow(bits.shadowedFraction(0, point.place) - expected, 2.0);
            interpolatedSquares +=
                std::pow(bits.shadowedFractionInterpolated(0, point.place) - expected, 2.0);
        }
        const auto count = static_cast<double>(points.size());
        const double rms = std::sqrt(squares / count);
        const double interpolatedRms = std::sqrt(interpolatedSquares / count);
        std::printf("%-24s mean shadow %.3f, rms error %.4f, interpolated %.4f\n", test.name,
                    mean / count, rms, interpolatedRms);
        shadow += mean / count;
        EXPECT_LT(rms, 0.03);
        EXPECT_LT(interpolatedRms, 0.03);
    }
    EXPECT_GT(shadow, 0.5);
}

TEST_F(EpipolarGlTest, TheEpipoleRuleDecidesWhatTheEyeSeesAroundTheLight) {
    auto buffers = MeshBuffers::upload(device(), mScene).value();
    const GeometrySource source = buffers.view();
    auto voxelizer = EpipolarVoxelizer::create(device(), {.depthMapTexels = 512}).value();
    // A lamp behind the edge of a bar: left of it the eye sees the bar, right of it the floor
    // beyond.
    const EpipolarLight light = pointLight({0.05, 0.3, -1.6});
    const glm::dvec3 from(0.05, 1.0, 2.5);
    const auto transform =
        EpipolarTransform::fit(reference::makeEye(from, light.position), light, {64, 64, 128})
            .value();
    auto grid = EpipolarGrid::create(device(), {.epipoleVoxels = 1.0}).value();
    ASSERT_TRUE(voxelizer.voxelize({&source, 1}, {&transform, 1}, grid));
    const EpipolarBits bits = grid.download().value();
    std::mt19937 random(3);
    std::uniform_real_distribution<double> unit(0.0, 1.0);
    constexpr std::size_t kPoints = 2000;
    std::size_t lit = 0;
    std::size_t wrong = 0;
    for (std::size_t i = 0; i < kPoints; ++i) {
        const glm::dvec3 direction =
            glm::normalize(transform.voxelToWorld({unit(random), 64.0 * unit(random), 2.0}) - from);
        const glm::dvec3 place = from + mRays.firstHit(from, direction) * direction;
        const bool isLit = mRays.lit(light, place - 1e-4 * direction);
        lit += isLit ? 1 : 0;
        wrong += bits.lit(0, place) != isLit ? 1 : 0;
    }
    std::printf("epipole: %zu of %zu visible points lit, %zu wrong\n", lit, kPoints, wrong);
    EXPECT_GT(lit, kPoints / 10);
    EXPECT_LT(lit, kPoints * 3 / 4);
    EXPECT_LE(wrong, kPoints / 50);
}

TEST_F(EpipolarGlTest, AnEyeInShadowSeesShadowFirst) {
    auto buffers = MeshBuffers::upload(device(), mScene).value();
    const GeometrySource source = buffers.view();
    auto voxelizer = EpipolarVoxelizer::create(device(), {.depthMapTexels = 1024}).value();
    auto grid = EpipolarGrid::create(device()).value();
    // In the sphere's long shadow, looking along it.
    const EpipolarLight light = pointLight({-3.2, 1.2, 0.6});
    const GridCamera eye = reference::makeEye({-0.2, 0.4, 0.6}, {2.0, 0.6, 3.0});
    ASSERT_FALSE(mRays.lit(light, {-0.2, 0.4, 0.6}));
    const auto transform = EpipolarTransform::fit(eye, light, {256, 256, 256}).value();
    ASSERT_TRUE(voxelizer.voxelize({&source, 1}, {&transform, 1}, grid));
    const Agreement found = compareWithRays(grid.download().value(), 0, mRays, eye, 20000);
    EXPECT_GT(found.lit, found.points / 10);
    EXPECT_LT(found.lit, found.points * 98 / 100);
    EXPECT_LE(found.disagreements, found.points / 50);
    EXPECT_EQ(found.unproved, 0u);
}

} // namespace
} // namespace lamina
