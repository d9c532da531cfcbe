// Depth sprites: against the reference's crossings, peeling against the single
// pass, voxels against Coverage::Solid, and what is not a closed shape.

#include "gl/support/gl_test.hpp"
#include "gl/support/parity.hpp"
#include "gl/support/test_meshes.hpp"
#include "gl/support/voxelize.hpp"

#include <reference/crossings.hpp>
#include <reference/mesh_measures.hpp>
#include <reference/point_parity.hpp>
#include <reference/shapes.hpp>

#include <gmock/gmock.h>

#include <glm/geometric.hpp>

#include <cmath>
#include <cstdio>
#include <numbers>

namespace lamina {
namespace {

namespace ref = reference;
using test::BuiltSprite;
using test::NamedMesh;
using testing::HasSubstr;

const Box3 kUnitBox{{-1, -1, -1}, {1, 1, 1}};
const std::vector<glm::dvec3> kAxes = {{0, 0, 1}, {1, 0, 0}, {0, 1, 0}};

class ParitySpriteGlTest : public test::GlTest {
protected:
    std::vector<std::uint8_t> classify(const DepthSprite& sprite,
                                       std::span<const glm::vec3> points) {
        const DepthSprite* sprites[] = {&sprite};
        return test::classify(device(), sprites, points);
    }
    void expectSameLayers(const TriangleMesh& mesh, const GridTransform& transform,
                          const std::string& name);
    void expectSolid(const TriangleMesh& mesh, const GridTransform& transform,
                     const std::string& name);
};

TEST_F(ParitySpriteGlTest, LayersAreTheReferencesCrossings) {
    for (const NamedMesh& shape : test::makeShapes()) {
        for (const glm::dvec3& direction : {glm::dvec3(0, -1, 0), glm::dvec3(0.3, -0.5, 0.7)}) {
            const auto transform = fitSprite(shape.mesh.bounds(), direction, 97).value();
            const BuiltSprite built(device(), shape.mesh, transform);
            const SpriteLayers layers = built.sprite.download().value();
            const ref::ColumnCrossings expected(shape.mesh, transform);
            const double near = transform.nearDepth();
            const double range = transform.farDepth() - near;
            std::size_t differing = 0;
            for (std::uint32_t y = 0; y < transform.size().y; ++y)
                for (std::uint32_t x = 0; x < transform.size().x; ++x) {
                    std::vector<double> depths;
                    for (const ref::Crossing& crossing : expected.at({x, y}))
                        depths.push_back((crossing.depth - near) / range);
                    if (depths.size() % 2 != 0)
                        depths.insert(depths.begin(), 0.0);
                    depths.resize(built.sprite.layers(), 2.0);
                    for (std::uint32_t layer = 0; layer < built.sprite.layers(); ++layer)
                        differing +=
                            std::abs(layers.depth({x, y}, layer) - depths[layer]) > 1e-7 ? 1 : 0;
                }
            // Edges that pass through a centre within rounding may be owned otherwise.
            EXPECT_LE(differing, 2u) << shape.name;
        }
    }
}

void ParitySpriteGlTest::expectSameLayers(const TriangleMesh& mesh, const GridTransform& transform,
                                          const std::string& name) {
    const BuiltSprite gathered(device(), mesh, transform);
    const BuiltSprite peeled(device(), mesh, transform, SpriteMethod::Peeling);
    ASSERT_EQ(gathered.sprite.layers(), peeled.sprite.layers()) << name;
    const auto a = gathered.sprite.download().value();
    const auto b = peeled.sprite.download().value();
    EXPECT_TRUE(std::ranges::equal(a.depths(), b.depths())) << name;
    EXPECT_EQ(gathered.report.layers, peeled.report.layers) << name;
    EXPECT_EQ(gathered.report.oddColumns, peeled.report.oddColumns) << name;
    EXPECT_EQ(gathered.report.crossings, peeled.report.crossings) << name;
    EXPECT_EQ(peeled.report.overflowColumns, 0u) << name;
}

TEST_F(ParitySpriteGlTest, PeelingGivesTheSameLayers) {
    for (const NamedMesh& shape : test::makeShapes())
        for (const glm::dvec3& direction : {glm::dvec3(0, 0, 1), glm::dvec3(0.3, -0.5, 0.7)})
            expectSameLayers(shape.mesh, fitSprite(shape.mesh.bounds(), direction, 150).value(),
                             shape.name);
    for (const NamedMesh& mesh : test::readRealMeshes({"armadillo.ply"}))
        expectSameLayers(mesh.mesh, fitSprite(mesh.mesh.bounds(), {0, 0, 1}, 256).value(),
                         mesh.name);
    // Coincident layers, more layers than insertion sorts, and a shape that reaches out all around.
    const TriangleMesh ball = ref::makeIcosphere({0, 0, 0}, 0.9f, 3);
    const auto around = fitSprite(ball.bounds(), {0, 0, 1}, 64).value();
    expectSameLayers(ref::merged(ref::merged(ball, ball), ball), around, "three at one place");
    expectSameLayers(ref::makeParallelQuads({0, 0, -0.5f}, 1.0f, 41, 0.025f), around, "41 quads");
    const auto within = fitSprite({{-0.4, -0.3, -0.2}, {0.5, 0.4, 0.3}}, {1, 2, 3}, 64).value();
    expectSameLayers(ref::makeMengerSponge({0, 0, 0}, 1.8f, 2), within, "cut off");
}

TEST_F(ParitySpriteGlTest, ManyLayersAreSorted) {
    // 1000 layers in each column, in a scrambled order of drawing.
    TriangleMesh quads = ref::makeParallelQuads({0, 0, -0.5f}, 1.0f, 1000, 0.001f);
    std::shuffle(quads.triangles.begin(), quads.triangles.end(), std::mt19937(1));
    const auto transform = fitSprite({{-0.6, -0.6, -0.6}, {0.6, 0.6, 0.6}}, {0, 0, 1}, 16).value();
    const BuiltSprite built(device(), quads, transform);
    ASSERT_EQ(built.sprite.layers(), 1000u);
    const SpriteLayers layers = built.sprite.download().value();
    const double range = transform.farDepth() - transform.nearDepth();
    for (std::uint32_t layer = 0; layer < 1000; ++layer) {
        const double expected = (-0.5 + 0.001 * layer - transform.nearDepth()) / range;
        ASSERT_NEAR(layers.depth({8, 8}, layer), expected, 1e-6) << layer;
    }
    EXPECT_EQ(layers.crossings({0.01, 0.01, 0.0005}), 501u);
}

void ParitySpriteGlTest::expectSolid(const TriangleMesh& mesh, const GridTransform& transform,
                                     const std::string& name) {
    const BuiltSprite built(device(), mesh, transform);
    const BitGrid found = built.sprite.download()->voxels().value();
    const BitGrid expected =
        test::voxelize(device(), {.coverage = Coverage::Solid}, mesh, transform);
    const auto comparison = compare(found, expected).value();
    // Both decide in double precision, in different units: a crossing within rounding of a voxel's
    // centre may fall on its other side, at most one in a million.
    EXPECT_LE((comparison.onlyFirst + comparison.onlySecond) * 1000000, expected.count())
        << name << ": " << comparison.onlyFirst << " and " << comparison.onlySecond;
    EXPECT_GT(expected.count(), 0u) << name;
}

TEST_F(ParitySpriteGlTest, VoxelsEqualCoverageSolid) {
    for (const NamedMesh& shape : test::makeShapes())
        for (const Axis axis : {Axis::X, Axis::Z})
            if (shape.name.find("plane") == std::string::npos)
                expectSolid(shape.mesh,
                            GridTransform::box({{-1.01, -1.03, -1.02}, {1.04, 1.02, 1.03}},
                                               {101, 83, 129}, axis)
                                .value(),
                            shape.name);
    const TriangleMesh knot = ref::makeTorusKnot({0, 0, 0}, 0.55f, 0.3f, 2, 3, 256, 24);
    expectSolid(knot,
                GridTransform::box({{-0.5, -0.4, -0.1}, {0.45, 0.6, 0.15}}, {77, 66, 55}).value(),
                "cut off");
    // Faces through voxel centres.
    expectSolid(ref::makeBox({1.5f, 2.5f, 3.5f}, {6.5f, 5.5f, 7.5f}),
                GridTransform::box({glm::dvec3(0), glm::dvec3(8)}, glm::uvec3(8)).value(), "ties");
    for (const NamedMesh& mesh : test::readRealMeshes({"armadillo.ply"}))
        expectSolid(mesh.mesh, GridTransform::box(mesh.mesh.bounds(), glm::uvec3(256)).value(),
                    mesh.name);
}

TEST_F(ParitySpriteGlTest, CoincidentFacesKeepTheParity) {
    const auto transform = fitSprite(kUnitBox, {0, 0, 1}, 128).value();
    const auto points = test::randomPoints({{-0.9, -0.9, -0.9}, {0.9, 0.9, 0.9}}, 20000, 5);
    const TriangleMesh ball = ref::makeIcosphere({0, 0, 0}, 0.8f, 4);
    const auto once = classify(BuiltSprite(device(), ball, transform).sprite, points);
    const auto mesh3 = ref::merged(ref::merged(ball, ball), ref::flipped(ball));
    EXPECT_EQ(classify(BuiltSprite(device(), mesh3, transform).sprite, points), once);
    const auto twice =
        classify(BuiltSprite(device(), ref::merged(ball, ball), transform).sprite, points);
    EXPECT_EQ(std::ranges::count(twice, 1), 0);
    // Two boxes that share a face are one solid, seen along the face's normal and along the face.
    const TriangleMesh boxes =
        ref::merged(ref::makeBox({-0.5f, -0.5f, -0.5f}, {0.5f, 0.5f, 0.125f}),
                    ref::makeBox({-0.5f, -0.5f, 0.125f}, {0.5f, 0.5f, 0.5f}));
    const auto inner = test::randomPoints({{-0.48, -0.48, -0.48}, {0.48, 0.48, 0.48}}, 20000, 6);
    for (const glm::dvec3& axis : kAxes) {
        const auto along = fitSprite(kUnitBox, axis, 128).value();
        const auto found = classify(BuiltSprite(device(), boxes, along).sprite, inner);
        EXPECT_EQ(static_cast<std::size_t>(std::ranges::count(found, 1)), inner.size());
    }
}

TEST_F(ParitySpriteGlTest, AMorphingShapeStaysRight) {
    constexpr std::size_t kPoints = 20000;
    const auto points = test::randomPoints(kUnitBox, kPoints, 21);
    const auto transform = fitSprite(kUnitBox, {0, 0, 1}, 256).value();
    auto builder = SpriteBuilder::create(device()).value();
    auto sprite = DepthSprite::create(device()).value();
    const TriangleMesh rest = ref::makeTorusKnot({0, 0, 0}, 0.5f, 0.1f, 2, 3, 256, 24);
    GLuint texture = 0;
    for (int frame = 0; frame < 10; ++frame) {
        TriangleMesh mesh = rest;
        for (glm::vec3& p : mesh.positions) {
            const float angle = 0.25f * static_cast<float>(frame) * p.z;
            p = glm::vec3(std::cos(angle) * p.x - std::sin(angle) * p.y,
                          std::sin(angle) * p.x + std::cos(angle) * p.y,
                          p.z * (1.0f + 0.1f * std::sin(0.7f * static_cast<float>(frame))));
        }
        auto buffers = MeshBuffers::upload(device(), mesh).value();
        const GeometrySource source = buffers.view();
        const auto stats = builder.build({&source, 1}, transform, 12, sprite);
        ASSERT_TRUE(stats) << stats.error().text;
        EXPECT_EQ(stats->geometryPasses, 1u);
        EXPECT_EQ(sprite.downloadReport()->overflowColumns, 0u);
        const auto wrong =
            test::wrongOnes(classify(sprite, points), ref::pointParity(mesh, points, Axis::Y));
        EXPECT_LE(wrong.size(), kPoints / 100) << frame;
        for (const std::size_t i : wrong)
            EXPECT_TRUE(ref::surfaceWithin(mesh, points[i], test::diagonalOf(transform))) << i;
        EXPECT_TRUE(frame == 0 || texture == sprite.texture()) << "allocated again";
        texture = sprite.texture();
    }
}

TEST_F(ParitySpriteGlTest, AHostsVertexStageIsASource) {
    GLuint vertexArray = 0;
    gl().CreateVertexArrays(1, &vertexArray);
    DrawSource source;
    // Two triangles that face each other across the box, a slab from z = -0.5 to 0.5.
    source.vertexShader = R"(
        LaminaVertex laminaVertex() {
            int corner = gl_VertexID % 3;
            vec2 place = vec2(corner == 1 ? 3.0 : -1.0, corner == 2 ? 3.0 : -1.0);
            return LaminaVertex(vec3(place, gl_VertexID < 3 ? -0.5 : 0.5), vec3(0.0), 0u);
        })";
    std::uint32_t draws = 0;
    source.draw = [&](const DrawContext& context) {
        EXPECT_EQ(context.pass, draws);
        ++draws;
        gl().BindVertexArray(vertexArray);
        // Two draws: what numbers primitives starts again.
        gl().DrawArrays(GL_TRIANGLES, 0, 3);
        gl().DrawArrays(GL_TRIANGLES, 3, 3);
    };
    const GeometrySource sources[] = {source};
    const auto transform = GridTransform::box(kUnitBox, {20, 20, 16}).value();
    auto builder = SpriteBuilder::create(device()).value();
    auto sprite = DepthSprite::create(device()).value();
    ASSERT_TRUE(builder.build(sources, transform, 2, sprite));
    EXPECT_EQ(sprite.download()->voxels()->count(), 20u * 20u * 8u);
    draws = 0;
    const auto stats = builder.build(sources, transform, 2, sprite, SpriteMethod::Peeling);
    ASSERT_TRUE(stats);
    EXPECT_EQ(stats->geometryPasses, draws);
    EXPECT_EQ(sprite.download()->voxels()->count(), 20u * 20u * 8u);
    gl().DeleteVertexArrays(1, &vertexArray);
}

TEST_F(ParitySpriteGlTest, TheBestDirectionHasTheLeastDepthComplexity) {
    TriangleMesh plates;
    for (int i = 0; i < 5; ++i) {
        const float z = -0.9f + 0.4f * static_cast<float>(i);
        plates = ref::merged(plates, ref::makeBox({-0.9f, -0.9f, z}, {0.9f, 0.7f, z + 0.1f}));
    }
    auto buffers = MeshBuffers::upload(device(), plates).value();
    const GeometrySource source = buffers.view();
    auto builder = SpriteBuilder::create(device()).value();
    const auto along = fitSprite(plates.bounds(), {0, 0, 1}, 64).value();
    EXPECT_EQ(builder.downloadReport({&source, 1}, along)->layers, 10u);
    const auto best = builder.downloadBestDirection({&source, 1}, plates.bounds());
    ASSERT_TRUE(best) << best.error().text;
    EXPECT_EQ(best->report.layers, 2u);
    EXPECT_EQ(best->direction.z, 0.0);
    EXPECT_THAT(builder.downloadBestDirection({&source, 1}, plates.bounds(), {}).error().text,
                HasSubstr("expected directions, found none"));
}

TEST_F(ParitySpriteGlTest, OpenMeshesAreReported) {
    TriangleMesh open = ref::makeBox({2.25f, 2.25f, 2.25f}, {6.25f, 5.25f, 6.25f});
    std::erase_if(open.triangles, [&](const glm::uvec3& t) {
        return open.positions[t.x].z > 6.0f && open.positions[t.y].z > 6.0f &&
               open.positions[t.z].z > 6.0f;
    });
    const Box3 box{glm::dvec3(0), glm::dvec3(8)};
    const auto transform = GridTransform::box(box, glm::uvec3(8)).value();
    const BuiltSprite built(device(), open, transform);
    EXPECT_EQ(built.report.oddColumns, 12u);
    EXPECT_EQ(built.report.layers, 2u);
    expectSolid(open, transform, "open box");
    EXPECT_EQ(BuiltSprite(device(), open, GridTransform::box(box, glm::uvec3(8), Axis::X).value())
                  .report.oddColumns,
              0u);
    // The hole is at z = 6.25. By the closed side the solid lies before the shape.
    const auto insideAlong = [&](double z, const glm::dvec3& point) {
        const auto along = fitSprite(open.bounds(), {0, 0, z}, 32).value();
        return BuiltSprite(device(), open, along).sprite.download()->inside(point);
    };
    EXPECT_TRUE(insideAlong(-1, {4, 4, 4})) << "by the hole";
    EXPECT_FALSE(insideAlong(1, {4, 4, 4})) << "by the closed side";
}

TEST_F(ParitySpriteGlTest, TooManyLayersEmptyTheColumnAndAreReported) {
    const auto transform = GridTransform::box(kUnitBox, {16, 16, 8}).value();
    const TriangleMesh mesh = ref::merged(ref::makeBox({-0.9f, -0.9f, -0.9f}, {0.9f, 0.9f, -0.5f}),
                                          ref::makeBox({-0.9f, -0.9f, 0.5f}, {0.0f, 0.9f, 0.9f}));
    auto buffers = MeshBuffers::upload(device(), mesh).value();
    const GeometrySource source = buffers.view();
    auto builder = SpriteBuilder::create(device()).value();
    auto sprite = DepthSprite::create(device()).value();
    for (const SpriteMethod method : {SpriteMethod::SinglePass, SpriteMethod::Peeling}) {
        ASSERT_TRUE(builder.build({&source, 1}, transform, 1, sprite, method));
        EXPECT_EQ(sprite.layers(), 2u);
        const SpriteReport report = sprite.downloadReport().value();
        EXPECT_EQ(report.layers, 4u);
        EXPECT_EQ(report.overflowColumns, 7u * 14u);
        const SpriteLayers layers = sprite.download().value();
        EXPECT_FALSE(layers.inside({-0.5, 0.0, -0.7}));
        EXPECT_TRUE(layers.inside({0.5, 0.0, -0.7}));
    }
    // The number that is needed is found, and stays for the next frame.
    EXPECT_EQ(builder.buildAndWait({&source, 1}, transform, sprite)->overflowColumns, 0u);
    EXPECT_EQ(sprite.layers(), 4u);
    EXPECT_TRUE(sprite.download()->inside({-0.5, 0.0, -0.7}));
}

TEST_F(ParitySpriteGlTest, EmptySpritesContainNothing) {
    auto builder = SpriteBuilder::create(device()).value();
    auto sprite = DepthSprite::create(device()).value();
    EXPECT_THAT(sprite.download().error().text, HasSubstr("SpriteBuilder::build() first"));
    EXPECT_THAT(sprite.downloadReport().error().text, HasSubstr("SpriteBuilder::build() first"));
    const auto transform = fitSprite(kUnitBox, {0, 0, 1}, 33).value();
    const auto report = builder.buildAndWait({}, transform, sprite);
    ASSERT_TRUE(report);
    EXPECT_EQ(report->layers, 0u);
    EXPECT_EQ(sprite.layers(), 2u);
    const auto points = test::randomPoints({{-2, -2, -2}, {2, 2, 2}}, 1000, 1);
    EXPECT_EQ(std::ranges::count(classify(sprite, points), 1), 0);
    // Triangles that are not triangles set nothing.
    TriangleMesh none;
    const float nan = std::numeric_limits<float>::quiet_NaN();
    none.positions = {{0, 0, 0}, {0.5f, 0, 0}, {0.25f, 0, 0}, {0, nan, 0}};
    none.triangles = {{0, 1, 2}, {0, 0, 0}};
    auto buffers = MeshBuffers::upload(device(), {none.positions, {}, {}, {{0, 1, 2}}});
    ASSERT_FALSE(buffers) << "validate() refuses what is not finite";
    none.positions.pop_back();
    auto flat = MeshBuffers::upload(device(), none).value();
    const GeometrySource source = flat.view();
    EXPECT_EQ(builder.downloadReport({&source, 1}, transform)->crossings, 0u);
}

TEST_F(ParitySpriteGlTest, ErrorsSayWhatIsWrong) {
    auto builder = SpriteBuilder::create(device()).value();
    auto sprite = DepthSprite::create(device()).value();
    const auto transform = fitSprite(kUnitBox, {0, 0, 1}, 32).value();
    EXPECT_THAT(builder.build({}, transform, 0, sprite).error().text,
                HasSubstr("expected at least 1 layer, found 0; buildAndWait()"));
    const auto perspective =
        GridTransform::camera(GridCamera::perspective(glm::dmat4(1.0), 1.0, 1.0, 0.1, 5.0),
                              {8, 8, 8})
            .value();
    EXPECT_THAT(builder.build({}, perspective, 4, sprite).error().text,
                HasSubstr("expected an orthographic transform, found 8 x 8 x 8 perspective"));
    const GeometrySource broken = MeshView{};
    const auto failed = builder.build({&broken, 1}, transform, 4, sprite);
    ASSERT_FALSE(failed);
    EXPECT_THAT(failed.error().text,
                testing::StartsWith("depth sprite: source 0: expected vertexBuffer"));
    EXPECT_EQ(sprite.transform(), nullptr);
    const auto huge = builder.build({}, transform, 1u << 20u, sprite);
    ASSERT_FALSE(huge);
    EXPECT_EQ(huge.error().code, ErrorCode::DeviceLimit);
    EXPECT_THAT(huge.error().text,
                HasSubstr("found 1048576 layers; too many crossings, take another direction"));
    EXPECT_EQ(builder.build({}, transform, ~0u, sprite).error().code, ErrorCode::DeviceLimit);
    DrawSource stage;
    stage.vertexShader = "nonsense";
    stage.draw = [](const DrawContext&) {};
    const GeometrySource nonsense = stage;
    const auto uncompiled = builder.build({&nonsense, 1}, transform, 4, sprite);
    ASSERT_FALSE(uncompiled);
    EXPECT_EQ(uncompiled.error().code, ErrorCode::ShaderError);
    EXPECT_THAT(uncompiled.error().text,
                testing::StartsWith("depth sprite: expected the host vertex stage"));
    EXPECT_FALSE(takeHighSeverityMessages().empty()) << "the compiler's";
    const auto method = static_cast<SpriteMethod>(7);
    for (const Error& error : {builder.build({}, transform, 4, sprite, method).error(),
                               builder.buildAndWait({}, transform, sprite, method).error()}) {
        EXPECT_EQ(error.code, ErrorCode::InvalidArgument);
        EXPECT_EQ(error.text, "depth sprite: expected a value of SpriteMethod, found 7");
    }
    const auto wide = GridTransform::box(kUnitBox, {1u << 20u, 8, 1}).value();
    EXPECT_THAT(builder.build({}, wide, 2, sprite).error().text,
                HasSubstr("columns, found 1048576"));

    // Memory is known before, and a budget is kept.
    const auto stats = builder.build({}, transform, 2, sprite);
    ASSERT_TRUE(stats);
    EXPECT_EQ(stats->scratchBytes, 4u * transform.size().x * transform.size().y);
    EXPECT_EQ(sprite.gpuBytes(), DepthSprite::bytesFor(transform, 2));
    const std::uint64_t held = device().allocatedBytes();
    device().setMemoryBudget(held + DepthSprite::bytesFor(transform, 6));
    const auto dear = builder.build({}, transform, 8, sprite);
    ASSERT_FALSE(dear);
    EXPECT_EQ(dear.error().code, ErrorCode::OutOfMemory);
    EXPECT_THAT(dear.error().text, HasSubstr("8 layers: needs"));
    EXPECT_THAT(dear.error().text, HasSubstr("use fewer columns"));
    EXPECT_EQ(sprite.layers(), 2u);
    EXPECT_EQ(device().allocatedBytes(), held);
}

} // namespace
} // namespace lamina
