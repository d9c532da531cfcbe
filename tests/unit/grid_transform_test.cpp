#include <lamina/grid/grid_transform.hpp>

#include <glm/gtc/matrix_transform.hpp>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

namespace lamina {
namespace {

using testing::HasSubstr;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
const Box3 kBox{{-1, 2, 10}, {3, 4, 13}};

GridCamera orthographicCamera() {
    GridCamera camera;
    camera.worldToEye =
        glm::lookAt(glm::dvec3(3, 4, 5), glm::dvec3(0.2, -0.1, 0.3), glm::dvec3(0, 0, 1));
    camera.left = -2;
    camera.right = 3;
    camera.bottom = -1;
    camera.top = 4;
    camera.near = 0.5;
    camera.far = 11;
    return camera;
}

GridCamera perspectiveCamera() {
    return GridCamera::perspective(orthographicCamera().worldToEye, 1.1, 1.5, 0.25, 20.0);
}

void expectNear(const glm::dvec3& found, const glm::dvec3& expected, double tolerance = 1e-9) {
    for (int i = 0; i < 3; ++i)
        EXPECT_NEAR(found[i], expected[i], tolerance) << "component " << i;
}

TEST(GridTransform, BoxAlongEveryAxis) {
    const glm::uvec3 counts{8, 4, 6};
    const GridTransform z = GridTransform::box(kBox, counts, Axis::Z).value();
    EXPECT_EQ(z.size(), glm::uvec3(8, 4, 6));
    expectNear(z.worldToGrid({-1, 2, 10}), {0, 0, 0});
    expectNear(z.worldToGrid({3, 4, 13}), {8, 4, 6});
    expectNear(z.worldToGrid({0, 3, 12.5}), {2, 2, 5});
    const GridTransform x = GridTransform::box(kBox, counts, Axis::X).value();
    EXPECT_EQ(x.size(), glm::uvec3(4, 6, 8)); // y, z, x
    expectNear(x.worldToGrid({0, 3, 12.5}), {2, 5, 2});
    const GridTransform y = GridTransform::box(kBox, counts, Axis::Y).value();
    EXPECT_EQ(y.size(), glm::uvec3(6, 8, 4)); // z, x, y
    expectNear(y.worldToGrid({0, 3, 12.5}), {5, 2, 2});
    EXPECT_EQ(y.boxAxis(), Axis::Y);
    EXPECT_EQ(y.describe(), "6 x 8 x 4 orthographic");
    expectNear(y.voxelCenter({0, 0, 0}), {-1 + 0.25, 2 + 0.25, 10 + 0.25});
}

TEST(GridTransform, CamerasMapKnownPoints) {
    // Eye space equals world space: the camera at the origin looks along -z.
    GridCamera camera;
    camera.left = -2;
    camera.right = 2;
    camera.bottom = -1;
    camera.top = 1;
    camera.near = 1;
    camera.far = 5;
    const GridTransform orthographic = GridTransform::camera(camera, {40, 20, 8}).value();
    expectNear(orthographic.worldToGrid({0, 0, -1}), {20, 10, 0});
    expectNear(orthographic.worldToGrid({-2, 1, -5}), {0, 20, 8});
    EXPECT_FALSE(orthographic.boxAxis());
    camera.projection = Projection::Perspective;
    const GridTransform perspective = GridTransform::camera(camera, {40, 20, 8}).value();
    // The window is at depth 1; at depth 4 it is four times as large.
    expectNear(perspective.worldToGrid({-2, 1, -1}), {0, 20, 0});
    expectNear(perspective.worldToGrid({-8, 4, -4}), {0, 20, 6});
    expectNear(perspective.worldToGrid({2, 0, -4}), {25, 10, 6});
    EXPECT_TRUE(std::isnan(perspective.worldToGrid({0, 0, 1}).x)) << "behind the eye";
    EXPECT_FALSE(perspective.voxelAt({0, 0, 1}));
}

TEST(GridTransform, WorldToGridAndBack) {
    const SliceDistribution custom =
        SliceDistribution::custom({0.0f, 0.1f, 0.15f, 0.4f, 0.75f, 0.9f, 1.0f});
    std::mt19937 random(3);
    std::uniform_real_distribution<double> unit(0.001, 0.999);
    for (const GridCamera& camera : {orthographicCamera(), perspectiveCamera()})
        for (const SliceDistribution& distribution :
             {SliceDistribution::linear(), SliceDistribution::logarithmic(), custom}) {
            const GridTransform transform =
                GridTransform::camera(camera, {31, 17, 6}, distribution).value();
            for (int i = 0; i < 200; ++i) {
                const glm::dvec3 grid = glm::dvec3(unit(random), unit(random), unit(random)) *
                                        glm::dvec3(transform.size());
                const glm::dvec3 world = transform.gridToWorld(grid);
                expectNear(transform.worldToGrid(world), grid, 1e-6);
                EXPECT_EQ(transform.voxelAt(world), glm::uvec3(grid));
            }
            for (std::uint32_t k = 0; k < 6; ++k)
                EXPECT_EQ(transform.voxelAt(transform.voxelCenter({7, 9, k})), glm::uvec3(7, 9, k));
        }
}

TEST(GridTransform, SliceDistributions) {
    GridCamera camera = orthographicCamera();
    camera.near = 1;
    camera.far = 16;
    const GridTransform logarithmic =
        GridTransform::camera(camera, {1, 1, 4}, SliceDistribution::logarithmic()).value();
    for (int k = 0; k <= 4; ++k)
        EXPECT_NEAR(logarithmic.depthAtSlice(k), std::pow(2.0, k), 1e-5) << k;
    EXPECT_EQ(logarithmic.sliceAt(1.5), 0u);
    EXPECT_EQ(logarithmic.sliceAt(5.0), 2u);
    EXPECT_EQ(logarithmic.sliceAt(16.0), 3u) << "far belongs to the last slice";
    EXPECT_EQ(logarithmic.sliceAt(0.99), std::nullopt);
    EXPECT_EQ(logarithmic.sliceAt(16.01), std::nullopt);

    const GridTransform custom =
        GridTransform::camera(camera, {1, 1, 2}, SliceDistribution::custom({0.0f, 0.25f, 1.0f}))
            .value();
    EXPECT_EQ(custom.sliceAt(4.74), 0u);
    EXPECT_EQ(custom.sliceAt(4.75), 1u) << "a boundary belongs to the slice behind it";
    EXPECT_DOUBLE_EQ(custom.sliceCoordinate(1.0 + 15.0 * 0.625), 1.5);

    const GridTransform linear = GridTransform::camera(camera, {1, 1, 5}).value();
    EXPECT_EQ(linear.sliceAt(4.0), 1u);
    EXPECT_EQ(linear.sliceAt(std::nextafter(4.0, 0.0)), 1u) << "rounding counts as on the boundary";
    EXPECT_EQ(linear.sliceAt(4.0 - 1e-9), 0u);
    EXPECT_DOUBLE_EQ(linear.sliceCoordinate(2.5), 0.5);
}

TEST(GridTransform, SlicesOfAColumnsOwnRange) {
    const auto custom = SliceDistribution::custom({0.0f, 0.25f, 0.75f, 1.0f});
    const GridTransform transform =
        GridTransform::box({{0, 0, 0}, {1, 1, 8}}, {2, 2, 3}, Axis::Z, custom).value();
    const ColumnRange range{2.0f, 6.0f};
    EXPECT_EQ(transform.sliceAt(1.999, range), std::nullopt);
    EXPECT_EQ(transform.sliceAt(2.0, range), 0u);
    EXPECT_EQ(transform.sliceAt(2.999, range), 0u);
    EXPECT_EQ(transform.sliceAt(3.0, range), 1u);
    EXPECT_EQ(transform.sliceAt(6.0, range), 2u);
    EXPECT_EQ(transform.sliceAt(6.001, range), std::nullopt);
    EXPECT_DOUBLE_EQ(transform.sliceCoordinate(4.0, range), 1.5);
    EXPECT_DOUBLE_EQ(transform.sliceCoordinate(7.0, range), 3.0);
    EXPECT_DOUBLE_EQ(transform.depthAtSlice(1.5, range), 4.0);
    EXPECT_EQ(transform.sliceAt(3.0, ColumnRange{}), std::nullopt);
    EXPECT_EQ(transform.sliceAt(3.0, ColumnRange{3.0f, 3.0f}), 0u);
    EXPECT_DOUBLE_EQ(transform.sliceCoordinate(3.0, ColumnRange{3.0f, 3.0f}), 0.0);

    const GridTransform finer = transform.withSlices(16).value();
    EXPECT_EQ(finer.size(), glm::uvec3(2, 2, 16));
    EXPECT_EQ(finer, GridTransform::box({{0, 0, 0}, {1, 1, 8}}, {2, 2, 16}).value());
    EXPECT_EQ(finer.boxAxis(), Axis::Z);
    EXPECT_FALSE(transform.withSlices(0));
}

TEST(GridTransform, UpperBoundsBelongToTheLastVoxel) {
    const GridTransform transform = GridTransform::box(kBox, {8, 4, 6}).value();
    EXPECT_EQ(transform.voxelAt({3, 4, 13}), glm::uvec3(7, 3, 5));
    EXPECT_EQ(transform.voxelAt({-1, 2, 10}), glm::uvec3(0, 0, 0));
    EXPECT_EQ(transform.voxelAt({3.001, 3, 12}), std::nullopt);
    EXPECT_EQ(transform.voxelAt({0, 3, kNan}), std::nullopt);
}

TEST(GridTransform, FromTheMatricesOfAnEngine) {
    const glm::dmat4 view = orthographicCamera().worldToEye;
    const auto expectSame = [](const GridCamera& found, const GridCamera& expected) {
        EXPECT_EQ(found.projection, expected.projection);
        EXPECT_NEAR(found.left, expected.left, 1e-6);
        EXPECT_NEAR(found.right, expected.right, 1e-6);
        EXPECT_NEAR(found.bottom, expected.bottom, 1e-6);
        EXPECT_NEAR(found.top, expected.top, 1e-6);
        EXPECT_NEAR(found.near, expected.near, 1e-6);
        EXPECT_NEAR(found.far, expected.far, 1e-4);
    };
    expectSame(GridCamera::fromMatrices(
                   view, glm::dmat4(glm::ortho(-2.0f, 3.0f, -1.0f, 4.0f, 0.5f, 11.0f)))
                   .value(),
               orthographicCamera());
    expectSame(GridCamera::fromMatrices(view, glm::perspective(1.1, 1.5, 0.25, 20.0)).value(),
               perspectiveCamera());
    GridCamera offCenter = perspectiveCamera();
    offCenter.left = -0.125;
    offCenter.top = 0.5;
    expectSame(
        GridCamera::fromMatrices(view, glm::frustum(offCenter.left, offCenter.right,
                                                    offCenter.bottom, offCenter.top, 0.25, 20.0))
            .value(),
        offCenter);
    // The grid maps a point to the pixel where the engine draws it.
    const glm::dmat4 projection = glm::perspective(1.1, 1.5, 0.25, 20.0);
    const GridTransform grid =
        GridTransform::camera(GridCamera::fromMatrices(view, projection).value(), {300, 200, 64})
            .value();
    const glm::dvec3 world(0.3, 0.1, 0.7);
    const glm::dvec4 clip = projection * view * glm::dvec4(world, 1.0);
    const glm::dvec3 mapped = grid.worldToGrid(world);
    EXPECT_NEAR(mapped.x, (clip.x / clip.w * 0.5 + 0.5) * 300, 1e-9);
    EXPECT_NEAR(mapped.y, (clip.y / clip.w * 0.5 + 0.5) * 200, 1e-9);

    EXPECT_THAT(
        GridCamera::fromMatrices(view, glm::infinitePerspective(1.0, 1.0, 0.1)).error().text,
        HasSubstr("finite far plane"));
    glm::dmat4 skewed(1.0);
    skewed[1][0] = 0.5;
    EXPECT_THAT(GridCamera::fromMatrices(view, skewed).error().text, HasSubstr("without skew"));
    glm::dmat4 odd(1.0);
    odd[2][3] = 0.5;
    EXPECT_THAT(GridCamera::fromMatrices(view, odd).error().text, HasSubstr("last row"));
}

TEST(GridTransform, BadInputIsNamed) {
    const auto boxError = [](const Box3& box, const glm::uvec3& counts) {
        const auto made = GridTransform::box(box, counts);
        EXPECT_FALSE(made);
        return made ? std::string() : made.error().text;
    };
    EXPECT_THAT(boxError({{0, 0, 0}, {1, 0, 1}}, {2, 2, 2}), HasSubstr("min < max on each axis"));
    EXPECT_THAT(boxError({}, {2, 2, 2}), HasSubstr("min < max on each axis"));
    EXPECT_THAT(boxError({{0, 0, kNan}, {1, 1, 1}}, {2, 2, 2}), HasSubstr("finite box"));
    EXPECT_THAT(boxError(kBox, {2, 0, 2}), HasSubstr("found 2 x 0 x 2"));
    EXPECT_THAT(boxError(kBox, {3, 3, 4294967295u}),
                HasSubstr("at most 2147483647 voxels along each axis, found 3 x 3 x 4294967295"));
    EXPECT_TRUE(GridTransform::box(kBox, {3, 3, 2147483647u}));
    EXPECT_THAT(GridTransform::box(kBox, {2, 2, 2})->withSlices(2147483648u).error().text,
                HasSubstr("found 2 x 2 x 2147483648"));
    EXPECT_THAT(GridTransform::box(kBox, {2, 2, 2}, static_cast<Axis>(9)).error().text,
                HasSubstr("expected axis X, Y or Z, found value 9"));

    const auto cameraError = [](auto change, const SliceDistribution& distribution =
                                                 SliceDistribution::linear()) {
        GridCamera camera = perspectiveCamera();
        change(camera);
        const auto made = GridTransform::camera(camera, {4, 4, 3}, distribution);
        EXPECT_FALSE(made);
        return made ? std::string() : made.error().text;
    };
    EXPECT_THAT(cameraError([](GridCamera& c) { c.near = c.far; }), HasSubstr("near < far"));
    EXPECT_THAT(cameraError([](GridCamera& c) { c.near = 30; }),
                HasSubstr("near 30.000000, far 20.000000"));
    EXPECT_THAT(cameraError([](GridCamera& c) { c.near = 0; }), HasSubstr("near > 0"));
    EXPECT_THAT(cameraError([](GridCamera& c) { c.far = kNan; }), HasSubstr("near < far"));
    EXPECT_THAT(cameraError([](GridCamera& c) { c.left = c.right; }), HasSubstr("left != right"));
    EXPECT_THAT(cameraError([](GridCamera& c) { c.worldToEye = glm::dmat4(0.0); }),
                HasSubstr("affine worldToEye"));
    EXPECT_THAT(cameraError([](GridCamera&) {}, SliceDistribution::custom({0.0f, 1.0f})),
                HasSubstr("slices + 1 (4)"));
    EXPECT_THAT(
        cameraError([](GridCamera&) {}, SliceDistribution::custom({0.0f, 0.5f, 0.5f, 1.0f})),
        HasSubstr("strictly increasing"));
    EXPECT_THAT(
        cameraError([](GridCamera&) {}, SliceDistribution::custom({0.0f, 0.5f, 0.6f, 0.9f})),
        HasSubstr("from 0 to 1"));
    EXPECT_THAT(cameraError(
                    [](GridCamera& c) {
                        c.projection = Projection::Orthographic;
                        c.near = 0;
                    },
                    SliceDistribution::logarithmic()),
                HasSubstr("logarithmic"));
}

} // namespace
} // namespace lamina
