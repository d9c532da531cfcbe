// Slicemaps with a near/far range per column, against the double-precision reference.

#include "gl/support/gl_test.hpp"
#include "gl/support/grids.hpp"
#include "gl/support/test_meshes.hpp"
#include "gl/support/voxelize.hpp"

#include <lamina/voxelize/voxelizer.hpp>

#include <reference/local.hpp>
#include <reference/shapes.hpp>

#include <support/tree.hpp>

#include <glm/gtc/matrix_transform.hpp>

#include <gmock/gmock.h>

#include <bit>
#include <cmath>
#include <numeric>
#include <random>

namespace lamina {
namespace {

namespace ref = reference;
using test::cameraGrid;
using test::NamedMesh;
using test::shapesGrid;

ref::ColumnRule ruleOf(Coverage coverage) {
    if (coverage == Coverage::Conservative)
        return ref::ColumnRule::Touch;
    return coverage == Coverage::Sampled ? ref::ColumnRule::Centre : ref::ColumnRule::Footprint;
}

constexpr Coverage kCoverages[] = {Coverage::Sampled, Coverage::Filled, Coverage::Conservative};

/// What rounding in double precision moves centres (columns) and depths (of the depth range) by.
constexpr double kRounding = 1e-9;
constexpr double kDepthRounding = 1e-13;
/// How much larger than the column's square the shader's is at most, in columns: it computes
/// offsets in floats.
constexpr double kFootprint = 1e-4;

float above(float value) {
    return std::nextafter(value, std::numeric_limits<float>::max());
}
float below(float value) {
    return std::nextafter(value, -std::numeric_limits<float>::max());
}

/// The range holds every depth that the column surely gets, and no more than a float's rounding
/// beyond those that it may get.
void expectRanges(const BitGrid& device, const TriangleMesh& mesh, Coverage coverage,
                  const std::string& name) {
    const GridTransform& transform = device.transform();
    const ref::ColumnRule rule = ruleOf(coverage);
    const auto must = ref::columnSpans(mesh, transform, rule, {.grow = -kRounding});
    const auto may = ref::columnSpans(
        mesh, transform, rule, {.grow = coverage == Coverage::Sampled ? kRounding : kFootprint});
    const double slack = kDepthRounding * (transform.farDepth() - transform.nearDepth());
    ASSERT_TRUE(device.hasLocalRanges()) << name;
    std::size_t failures = 0;
    std::size_t filled = 0;
    for (std::size_t i = 0; i < must.size(); ++i) {
        const ColumnRange range = device.ranges()[i];
        bool fits = true;
        if (must[i])
            fits = !range.isEmpty() && range.near <= must[i]->min + slack &&
                   range.far >= must[i]->max - slack;
        if (!range.isEmpty())
            fits = fits && may[i] && above(above(range.near)) >= may[i]->min - slack &&
                   below(below(range.far)) <= may[i]->max + slack;
        failures += fits ? 0 : 1;
        filled += range.isEmpty() ? 0 : 1;
    }
    EXPECT_EQ(failures, 0u) << name;
    EXPECT_GT(filled, 0u) << name;
}

/// The bits are those that the reference finds in the device's own ranges, and the first and last
/// slice of a column are set.
void expectLocal(const BitGrid& device, const TriangleMesh& mesh, Coverage coverage,
                 const std::string& name) {
    expectRanges(device, mesh, coverage, name);
    const GridTransform& transform = device.transform();
    const std::vector<ColumnRange> ranges(device.ranges().begin(), device.ranges().end());
    const ref::ColumnRule rule = ruleOf(coverage);
    const BitGrid must =
        ref::local(mesh, transform, ranges, rule, {.grow = -kRounding}, kDepthRounding).value();
    const BitGrid may =
        ref::local(mesh, transform, ranges, rule,
                   {.grow = coverage == Coverage::Sampled ? kRounding : kFootprint}, kDepthRounding)
            .value();
    EXPECT_EQ(compare(must, device)->onlyFirst, 0u) << name << ": missing voxels";
    EXPECT_EQ(compare(device, may)->onlyFirst, 0u) << name << ": superfluous voxels";
    EXPECT_GT(must.count(), 0u) << name;
    if (coverage == Coverage::Sampled) {
        // Depths on a boundary between slices, in columns whose range is a float's rounding long.
        EXPECT_LE((may.count() - must.count()) * 500, may.count()) << name << ": too tolerant";
    }
    const glm::uvec3 size = device.size();
    for (std::uint32_t y = 0; y < size.y; ++y)
        for (std::uint32_t x = 0; x < size.x; ++x) {
            const ColumnRange range = device.columnRange({x, y});
            ASSERT_EQ(range.isEmpty(), device.countNearer({x, y}, size.z) == 0) << name;
            // Rounded outwards, short ranges hold their depths somewhere inside.
            if (range.isEmpty() || range.far - range.near < 1e-3f * std::abs(range.near))
                continue;
            ASSERT_TRUE(device.test({x, y, 0})) << name;
            ASSERT_TRUE(device.test({x, y, size.z - 1})) << name;
        }
}

class LocalSlicemapGlTest : public test::GlTest {
protected:
    BitGrid voxelize(Coverage coverage, const TriangleMesh& mesh, const GridTransform& transform) {
        return test::voxelize(device(), {Backend::LocalSlicemap, coverage}, mesh, transform);
    }
};

TEST_F(LocalSlicemapGlTest, AllShapesAgreeWithTheReference) {
    const GridTransform transform = shapesGrid({101, 83, 128});
    for (const NamedMesh& shape : test::makeShapes())
        for (const Coverage coverage : kCoverages)
            expectLocal(voxelize(coverage, shape.mesh, transform), shape.mesh, coverage,
                        shape.name + ", " + std::string(name(coverage)));
}

TEST_F(LocalSlicemapGlTest, CameraGridsAndDistributionsAgreeWithTheReference) {
    const TriangleMesh mesh =
        ref::merged(ref::makeTorusKnot({0, 0, 0}, 0.5f, 0.2f, 2, 3, 64, 12),
                    ref::makeTriangleSoup({{-1, -1, -1}, {1, 1, 1}}, 200, 0.6f, 5));
    for (const GridTransform& transform : test::makeCameraGrids({90, 71, 100}))
        for (const Coverage coverage : kCoverages)
            expectLocal(voxelize(coverage, mesh, transform), mesh, coverage, transform.describe());
}

TEST_F(LocalSlicemapGlTest, TrianglesAroundTheEyeAgreeWithTheReference) {
    const GridTransform transform = test::eyeGrid({80, 80, 300});
    const TriangleMesh mesh = ref::makeTorusKnot({0, 0, 0}, 0.5f, 0.2f, 2, 3, 64, 12);
    for (const Coverage coverage : kCoverages)
        expectLocal(voxelize(coverage, mesh, transform), mesh, coverage,
                    std::string(name(coverage)));
}

TEST_F(LocalSlicemapGlTest, SliceCountsAroundWordAndGroupEdgesInEveryStore) {
    const TriangleMesh mesh = ref::makeTorus({0.1f, 0.03f, 0}, 0.6f, 0.25f, 40, 20);
    for (const std::uint32_t slices : {1u, 33u, 128u, 129u, 300u, 1100u}) {
        const GridTransform transform = shapesGrid({40, 24, slices});
        for (const Coverage coverage : kCoverages) {
            const BitGrid single = voxelize(coverage, mesh, transform);
            expectLocal(single, mesh, coverage, transform.describe());
            for (const VoxelStore store : {VoxelStore::Texture, VoxelStore::Buffer}) {
                const BitGrid many = test::voxelize(
                    device(), {Backend::MrtSlicemap, coverage, true, store}, mesh, transform);
                EXPECT_TRUE(compare(many, single)->equal())
                    << transform.describe() << ", " << name(store);
                EXPECT_TRUE(std::ranges::equal(many.ranges(), single.ranges()));
            }
        }
    }
}

TEST_F(LocalSlicemapGlTest, FlatColumnsHaveAllInTheirFirstSlice) {
    // Depth 0.5 is a float: near and far are one number.
    const TriangleMesh plane = ref::makePlane({0.5f, 0.5f, 0.5f}, {0, 0, 1}, 4.0f);
    const GridTransform transform = GridTransform::box({{0, 0, 0}, {1, 1, 1}}, {8, 6, 128}).value();
    for (const Coverage coverage : {Coverage::Sampled, Coverage::Filled}) {
        const BitGrid found = voxelize(coverage, plane, transform);
        for (std::uint32_t y = 0; y < 6; ++y)
            for (std::uint32_t x = 0; x < 8; ++x) {
                EXPECT_EQ(found.columnRange({x, y}), (ColumnRange{0.5f, 0.5f}));
                EXPECT_TRUE(found.test({x, y, 0}));
            }
        EXPECT_EQ(found.count(), 48u);
        EXPECT_TRUE(found.at({0.3, 0.3, 0.5}));
        EXPECT_FALSE(found.at({0.3, 0.3, 0.5001}));
        EXPECT_EQ(found.countNearer(glm::dvec3(0.3, 0.3, 0.6)), 1u);
        EXPECT_EQ(found.countNearer(glm::dvec3(0.3, 0.3, 0.4)), 0u);
    }
}

TEST_F(LocalSlicemapGlTest, GeometryOutsideTheGridsDepthsDoesNotStretchRanges) {
    // Planes at 0.25 and 0.75 within, at -2 and 3 without.
    TriangleMesh mesh = ref::makeParallelQuads({0.5f, 0.5f, 0.25f}, 4.0f, 2, 0.5f);
    mesh = ref::merged(mesh, ref::makeParallelQuads({0.5f, 0.5f, -2.0f}, 4.0f, 2, 5.0f));
    const GridTransform transform = GridTransform::box({{0, 0, 0}, {1, 1, 1}}, {8, 8, 64}).value();
    const BitGrid found = voxelize(Coverage::Sampled, mesh, transform);
    EXPECT_EQ(found.columnRange({3, 3}), (ColumnRange{0.25f, 0.75f}));
    EXPECT_EQ(found.count(), 2u * 64u);
}

TEST_F(LocalSlicemapGlTest, NoSourcesGiveEmptyColumns) {
    auto voxelizer = Voxelizer::create(device(), {Backend::LocalSlicemap}).value();
    auto grid = VoxelGrid::create(device()).value();
    const auto stats = voxelizer->voxelize({}, shapesGrid({16, 16, 200}), grid).value();
    EXPECT_EQ(stats.passes, 3u);
    const BitGrid found = grid.download().value();
    EXPECT_EQ(found.count(), 0u);
    for (const ColumnRange& range : found.ranges())
        EXPECT_EQ(range, ColumnRange{});
}

TEST_F(LocalSlicemapGlTest, BoundingGeometryGivesTheRanges) {
    const TriangleMesh mesh = ref::makeIcosphere({0.1f, 0, 0}, 0.6f, 3);
    const TriangleMesh hull = ref::makeBox({-0.6f, -0.7f, -0.7f}, {0.8f, 0.7f, 0.7f});
    auto meshBuffers = MeshBuffers::upload(device(), mesh).value();
    auto hullBuffers = MeshBuffers::upload(device(), hull).value();
    const GeometrySource sources[] = {meshBuffers.view()};
    const GeometrySource bounds[] = {hullBuffers.view()};
    VoxelizeOptions options;
    options.bounds = bounds;
    for (const Projection projection : {Projection::Orthographic, Projection::Perspective})
        for (const Coverage coverage : kCoverages) {
            const GridTransform transform = cameraGrid(projection, {90, 71, 256});
            auto voxelizer =
                Voxelizer::create(device(), {Backend::LocalSlicemap, coverage}).value();
            auto grid = VoxelGrid::create(device()).value();
            ASSERT_TRUE(voxelizer->voxelizeWith(sources, transform, options, {&grid, 1}));
            const BitGrid found = grid.download().value();
            const std::string name = transform.describe();
            expectRanges(found, hull, coverage, name);
            const std::vector<ColumnRange> ranges(found.ranges().begin(), found.ranges().end());
            const ref::ColumnRule rule = ruleOf(coverage);
            const BitGrid must =
                ref::local(mesh, transform, ranges, rule, {.grow = -kRounding}, kDepthRounding)
                    .value();
            const BitGrid may =
                ref::local(mesh, transform, ranges, rule,
                           {.grow = coverage == Coverage::Sampled ? kRounding : kFootprint},
                           kDepthRounding)
                    .value();
            EXPECT_EQ(compare(must, found)->onlyFirst, 0u) << name;
            EXPECT_EQ(compare(found, may)->onlyFirst, 0u) << name;
            EXPECT_GT(must.count(), 1000u);
        }
}

TEST_F(LocalSlicemapGlTest, WhatSticksOutOfTheBoundsIsDropped) {
    // Planes at 0.25, 0.5 and 0.75; the hull covers half the columns and depths 0.4 to 0.6.
    const TriangleMesh mesh = ref::makeParallelQuads({0.5f, 0.5f, 0.25f}, 4.0f, 3, 0.25f);
    const TriangleMesh hull = ref::makeBox({0.0f, 0.0f, 0.4f}, {0.5f, 1.0f, 0.6f});
    auto meshBuffers = MeshBuffers::upload(device(), mesh).value();
    auto hullBuffers = MeshBuffers::upload(device(), hull).value();
    const GeometrySource sources[] = {meshBuffers.view()};
    const GeometrySource bounds[] = {hullBuffers.view()};
    VoxelizeOptions options;
    options.bounds = bounds;
    const GridTransform transform = GridTransform::box({{0, 0, 0}, {1, 1, 1}}, {8, 8, 64}).value();
    for (const VoxelStore store : {VoxelStore::Texture, VoxelStore::Buffer}) {
        auto voxelizer =
            Voxelizer::create(device(), {Backend::MrtSlicemap, Coverage::Filled, true, store})
                .value();
        auto grid = VoxelGrid::create(device()).value();
        ASSERT_TRUE(voxelizer->voxelizeWith(sources, transform, options, {&grid, 1}));
        const BitGrid found = grid.download().value();
        EXPECT_EQ(found.count(), 4u * 8u);
        EXPECT_TRUE(found.at({0.1, 0.1, 0.5}));
        EXPECT_TRUE(found.columnRange({7, 3}).isEmpty());
        EXPECT_EQ(found.countNearer(glm::dvec3(0.9, 0.9, 0.9)), 0u);
    }
}

/// Triangles crossed by the centre line of each column, in order of depth.
std::vector<std::vector<double>> crossings(const TriangleMesh& mesh,
                                           const GridTransform& transform) {
    std::vector<std::vector<double>> depths(std::size_t{transform.size().x} * transform.size().y);
    for (const ref::ColumnTriangle& triangle :
         ref::columnTriangles(mesh, transform, glm::dmat4(1.0))) {
        if (ref::doubleArea(triangle) == 0.0)
            continue;
        const auto low = glm::max(glm::ivec2(glm::floor(triangle.min())), glm::ivec2(0));
        const auto high =
            glm::min(glm::ivec2(glm::ceil(triangle.max())), glm::ivec2(transform.size()) - 1);
        for (int y = low.y; y <= high.y; ++y)
            for (int x = low.x; x <= high.x; ++x)
                if (const glm::dvec2 center(x + 0.5, y + 0.5); ref::owns(triangle, center))
                    depths[static_cast<std::size_t>(y) * transform.size().x +
                           static_cast<std::size_t>(x)]
                        .push_back(ref::depthAt(triangle, center));
    }
    for (auto& column : depths)
        std::ranges::sort(column);
    return depths;
}

/// How well the counts of nearer occluders along the columns' centre lines come out: the mean error
/// in leaves, over depths between the crossings of every column.
double countError(const BitGrid& grid, const std::vector<std::vector<double>>& crossings) {
    double error = 0.0;
    std::size_t places = 0;
    const std::uint32_t width = grid.size().x;
    for (std::size_t i = 0; i < crossings.size(); ++i)
        for (std::size_t k = 1; k < crossings[i].size(); ++k) {
            const double depth = 0.5 * (crossings[i][k - 1] + crossings[i][k]);
            const glm::uvec2 column(i % width, i / width);
            const auto slice = grid.hasLocalRanges()
                                   ? grid.transform().sliceAt(depth, grid.columnRange(column))
                                   : grid.transform().sliceAt(depth);
            const double found = slice ? grid.countNearer(column, *slice) : 0.0;
            error += std::abs(found - static_cast<double>(k));
            ++places;
        }
    return error / static_cast<double>(places);
}

TEST_F(LocalSlicemapGlTest, ATreeIsResolvedBetterThanByAsManyUniformSlices) {
    // As a light from above sees it.
    const example::Tree tree = example::makeTree(3);
    const TriangleMesh mesh = ref::merged(tree.wood, tree.leaves);
    const auto grid = [&](std::uint32_t slices) {
        const glm::dvec3 center = mesh.bounds().center();
        GridCamera camera;
        camera.worldToEye = glm::lookAt(center + glm::dvec3(3, 8, 4), center, glm::dvec3(0, 0, 1));
        camera.left = camera.bottom = -4.5;
        camera.right = camera.top = 4.5;
        camera.near = 5.0;
        camera.far = 14.0;
        return GridTransform::camera(camera, {256, 256, slices}).value();
    };
    const auto exact = crossings(mesh, grid(128));
    const double occluders = std::transform_reduce(
        exact.begin(), exact.end(), 0.0, std::plus<>(),
        [](const auto& column) { return static_cast<double>(column.size()); });
    const BitGrid local = voxelize(Coverage::Sampled, mesh, grid(128));
    const BitGrid uniform =
        test::voxelize(device(), {Backend::Slicemap, Coverage::Sampled}, mesh, grid(128));
    const BitGrid uniform1024 =
        test::voxelize(device(), {Backend::MrtSlicemap, Coverage::Sampled}, mesh, grid(1024));
    const auto resolved = [&](const BitGrid& bits) {
        return static_cast<double>(bits.count()) / occluders;
    };
    std::printf("tree, %.0f occluders; resolved: local 128 %.4f, uniform 128 %.4f, uniform 1024 "
                "%.4f; mean error of a count: %.4f, %.4f, %.4f\n",
                occluders, resolved(local), resolved(uniform), resolved(uniform1024),
                countError(local, exact), countError(uniform, exact),
                countError(uniform1024, exact));
    // Unresolved occluders and errors are at most three quarters of the uniform ones.
    EXPECT_LT(1.0 - resolved(local), 0.75 * (1.0 - resolved(uniform)));
    EXPECT_LT(countError(local, exact), 0.75 * countError(uniform, exact));
    EXPECT_GE(resolved(uniform1024), resolved(local) - 0.02);
}

TEST_F(LocalSlicemapGlTest, RealMeshesAgreeWithTheReference) {
    for (const NamedMesh& real : test::readRealMeshes({"bunny.ply", "armadillo.ply"})) {
        const GridTransform transform =
            GridTransform::box(real.mesh.bounds(), {200, 200, 128}).value();
        expectLocal(voxelize(Coverage::Sampled, real.mesh, transform), real.mesh, Coverage::Sampled,
                    real.name);
    }
}

TEST_F(LocalSlicemapGlTest, ADrawSourceGivesTheVoxelsOfItsMesh) {
    const TriangleMesh mesh = ref::makeTorusKnot({0, 0, 0}, 0.5f, 0.2f, 2, 3, 64, 12);
    const GridTransform transform = shapesGrid({60, 50, 300});
    std::vector<glm::vec4> corners;
    for (const auto& triangle : mesh.triangles)
        for (int corner = 0; corner < 3; ++corner)
            corners.emplace_back(mesh.positions[triangle[corner]], 1.0f);
    GLuint buffer = 0;
    gl().CreateBuffers(1, &buffer);
    gl().NamedBufferData(buffer, static_cast<GLsizeiptr>(corners.size() * sizeof corners[0]),
                         corners.data(), GL_STATIC_DRAW);
    GLuint vertexArray = 0;
    gl().CreateVertexArrays(1, &vertexArray);
    DrawSource source;
    source.vertexShader = R"(
        layout(std430, binding = 3) readonly buffer Corners { vec4 corners[]; };
        LaminaVertex laminaVertex() {
            return LaminaVertex(corners[gl_VertexID].xyz, vec3(0.0), 0u);
        })";
    std::vector<std::uint32_t> passes;
    source.draw = [&](const DrawContext& draw) {
        passes.push_back(draw.pass);
        EXPECT_EQ(draw.passCount, 4u);
        gl().BindVertexArray(vertexArray);
        gl().BindBufferBase(GL_SHADER_STORAGE_BUFFER, 3, buffer);
        gl().DrawArrays(GL_TRIANGLES, 0, static_cast<GLsizei>(corners.size()));
        // What the next source needs is bound again.
        gl().BindImageTexture(1, 0, 0, GL_FALSE, 0, GL_READ_ONLY, GL_RG32F);
    };
    // Vertex stages need not have storage buffers.
    GLint blocks = 0;
    gl().GetIntegerv(GL_MAX_VERTEX_SHADER_STORAGE_BLOCKS, &blocks);
    if (blocks > 0) {
        const GeometrySource sources[] = {DrawSource{source.vertexShader, [](const auto&) {}},
                                          source, source};
        const BitGrid found =
            test::voxelize(device(), {Backend::LocalSlicemap}, sources, transform);
        EXPECT_THAT(passes, testing::ElementsAre(0u, 0u, 1u, 1u, 2u, 2u, 3u, 3u));
        const BitGrid expected = voxelize(Coverage::Sampled, mesh, transform);
        EXPECT_TRUE(compare(found, expected)->equal());
        EXPECT_TRUE(std::ranges::equal(found.ranges(), expected.ranges()));
    }
    gl().BindBufferBase(GL_SHADER_STORAGE_BUFFER, 3, 0);
    gl().DeleteBuffers(1, &buffer);
    gl().DeleteVertexArrays(1, &vertexArray);
}

} // namespace
} // namespace lamina
