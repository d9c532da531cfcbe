// What the Voxelizer interface promises: every kind of source, reuse, errors that leave all
// unchanged.

#include "gl/support/gl_test.hpp"
#include "gl/support/grids.hpp"
#include "gl/support/sources.hpp"

#include <lamina/voxelize/voxelizer.hpp>

#include <reference/sampled.hpp>
#include <reference/shapes.hpp>

#include <gmock/gmock.h>

#include <limits>

namespace lamina {
namespace {

namespace ref = reference;
using test::testGrid;
using testing::AllOf;
using testing::HasSubstr;

const TriangleMesh kKnot = test::makeKnot();

class VoxelizerGlTest : public test::GlTest {
protected:
    void SetUp() override {
        GlTest::SetUp();
        mVoxelizer = Voxelizer::create(device()).value();
        mGrid.emplace(VoxelGrid::create(device()).value());
    }
    void TearDown() override {
        mGrid.reset();
        mVoxelizer.reset();
        GlTest::TearDown();
    }

    BitGrid voxelize(std::span<const GeometrySource> sources, const GridTransform& transform) {
        const auto stats = mVoxelizer->voxelize(sources, transform, *mGrid);
        EXPECT_TRUE(stats) << stats.error().text;
        return mGrid->download().value();
    }
    BitGrid voxelize(const GeometrySource& source) { return voxelize({&source, 1}, testGrid()); }

    /// The error of a call that must fail and change nothing.
    Error failure(const GeometrySource& source, const GridTransform& transform = testGrid()) {
        auto buffers = MeshBuffers::upload(device(), kKnot).value();
        const BitGrid before = voxelize(buffers.view());
        const std::uint32_t texture = mGrid->texture();
        const auto stats = mVoxelizer->voxelize({&source, 1}, transform, *mGrid);
        EXPECT_FALSE(stats);
        EXPECT_EQ(mGrid->texture(), texture);
        EXPECT_TRUE(compare(mGrid->download().value(), before)->equal());
        return stats ? Error{} : stats.error();
    }

    std::unique_ptr<Voxelizer> mVoxelizer;
    std::optional<VoxelGrid> mGrid;
};

TEST_F(VoxelizerGlTest, MeshViewsOfEveryLayoutGiveTheSameVoxels) {
    const BitGrid expected = ref::sampled(kKnot, testGrid()).value();
    test::forEachLayout(
        kKnot, [&](std::span<const std::byte> bytes) { return hostBuffer(bytes); },
        [&](const MeshView& view, const std::string& layout) {
            EXPECT_TRUE(compare(voxelize(view), expected)->equal()) << layout;
        });
}

TEST_F(VoxelizerGlTest, SeveralMeshesWithModelMatricesGatherInOneGrid) {
    const auto meshes = test::placedMeshes();
    std::vector<MeshBuffers> buffers;
    std::vector<GeometrySource> sources;
    BitGrid expected = BitGrid::create(testGrid()).value();
    for (const auto& [mesh, model] : meshes) {
        buffers.push_back(MeshBuffers::upload(device(), mesh).value());
        sources.emplace_back(buffers.back().view(model));
        ref::sampled(mesh, testGrid(), {.model = glm::dmat4(model)})
            ->forEachSet([&](const glm::uvec3& voxel) { expected.set(voxel); });
    }
    EXPECT_TRUE(compare(voxelize(sources, testGrid()), expected)->equal());

    // 1024 slices a pass.
    const auto stats = mVoxelizer->voxelize(sources, testGrid(2100), *mGrid).value();
    EXPECT_EQ(stats.sources, 3u);
    EXPECT_EQ(stats.passes, 3u);
    EXPECT_EQ(stats.meshTriangles,
              meshes[0].mesh.triangles.size() + meshes[1].mesh.triangles.size() + 12);
    EXPECT_EQ(stats.gridBytes, mGrid->gpuBytes());
}

TEST_F(VoxelizerGlTest, NoSourcesGiveAnEmptyGridAndAGridIsReused) {
    auto buffers = MeshBuffers::upload(device(), kKnot).value();
    EXPECT_GT(voxelize(buffers.view()).count(), 0u);
    const std::uint32_t texture = mGrid->texture();
    const std::uint64_t bytes = device().allocatedBytes();
    EXPECT_EQ(voxelize({}, testGrid()).count(), 0u);
    EXPECT_EQ(mGrid->texture(), texture);
    // Fewer slices of the same group, another place: no new memory.
    const auto moved = GridTransform::box({{0, 0, 0}, {1, 1, 2}}, {48, 40, 77}, Axis::Z).value();
    EXPECT_TRUE(compare(voxelize(std::array<GeometrySource, 1>{buffers.view()}, moved),
                        ref::sampled(kKnot, moved).value())
                    ->equal());
    EXPECT_EQ(mGrid->texture(), texture);
    EXPECT_EQ(device().allocatedBytes(), bytes);
    // Another shape and back.
    EXPECT_GT(voxelize(std::array<GeometrySource, 1>{buffers.view()}, testGrid(200)).count(), 0u);
    EXPECT_EQ(*mGrid->transform(), testGrid(200));
}

TEST_F(VoxelizerGlTest, ASkinnedMeshAnimatedInTheVertexShader) {
    // Two bones; the second bends about x by quarter turns and lifts, weights are exact halves, so
    // that the host can compute the same positions without rounding.
    const GridTransform transform =
        ref::makeDyadicGrid({{-2, -2, -2}, {2, 2, 2}}, {64, 64, 100}, Axis::Y);
    const TriangleMesh rest =
        ref::snapped(ref::makeIcosphere({0.25f, 0.5f, 0}, 1.0f, 3), transform);
    struct Vertex {
        glm::vec3 position;
        float weight;
    };
    std::vector<Vertex> vertices;
    for (const glm::vec3& p : rest.positions)
        vertices.push_back({p, p.y > 0.75f ? 1.0f : (p.y > 0.25f ? 0.5f : 0.0f)});
    const GLuint vertexBuffer = hostBuffer(std::as_bytes(std::span(vertices)));
    const GLuint indexBuffer = hostBuffer(std::as_bytes(std::span(rest.triangles)));
    GLuint vertexArray = 0;
    gl().CreateVertexArrays(1, &vertexArray);
    gl().VertexArrayVertexBuffer(vertexArray, 0, vertexBuffer, 0, sizeof(Vertex));
    gl().VertexArrayElementBuffer(vertexArray, indexBuffer);
    for (GLuint attribute : {4u, 5u}) {
        gl().EnableVertexArrayAttrib(vertexArray, attribute);
        gl().VertexArrayAttribFormat(vertexArray, attribute, attribute == 4 ? 3 : 1, GL_FLOAT,
                                     GL_FALSE, attribute == 4 ? 0 : 12);
        gl().VertexArrayAttribBinding(vertexArray, attribute, 0);
    }

    DrawSource source;
    source.vertexShader = R"(
        layout(location = 4) in vec3 position;
        layout(location = 5) in float weight;
        uniform mat4 bones[2];
        LaminaVertex laminaVertex() {
            vec4 skinned = (1.0 - weight) * (bones[0] * vec4(position, 1.0)) +
                           weight * (bones[1] * vec4(position, 1.0));
            return LaminaVertex(skinned.xyz, vec3(0.0), 0u);
        })";
    glm::mat4 bones[2];
    source.draw = [&](const DrawContext& draw) {
        gl().UniformMatrix4fv(gl().GetUniformLocation(draw.program, "bones"), 2, GL_FALSE,
                              &bones[0][0][0]);
        gl().BindVertexArray(vertexArray);
        gl().DrawElements(GL_TRIANGLES, static_cast<GLsizei>(rest.triangles.size() * 3),
                          GL_UNSIGNED_INT, nullptr);
    };
    const GeometrySource sources[] = {source};
    std::uint64_t previousCount = 0;
    for (int frame = 0; frame < 4; ++frame) {
        bones[0] = glm::mat4(1.0f);
        bones[1] = glm::mat4(1.0f);
        if (frame % 2 == 1) {
            bones[1][1] = {0, 0, 1, 0};  // y -> z
            bones[1][2] = {0, -1, 0, 0}; // z -> -y
        }
        bones[1][3] = {0.125f * static_cast<float>(frame), 0.25f, 0, 1};
        TriangleMesh posed = rest;
        for (std::size_t i = 0; i < vertices.size(); ++i) {
            const glm::vec4 p(vertices[i].position, 1.0f);
            const float w = vertices[i].weight;
            posed.positions[i] = glm::vec3((1.0f - w) * (bones[0] * p) + w * (bones[1] * p));
        }
        const BitGrid expected = ref::sampled(posed, transform).value();
        EXPECT_TRUE(compare(voxelize(sources, transform), expected)->equal()) << "frame " << frame;
        EXPECT_NE(expected.count(), previousCount);
        previousCount = expected.count();
    }
    gl().DeleteVertexArrays(1, &vertexArray);
}

TEST_F(VoxelizerGlTest, ADrawSourceIsDrawnOncePerPassWithStripsAndRestart) {
    // A quad as a strip, twice, parted by the restart index the host has switched on.
    const std::uint16_t indices[] = {0, 1, 2, 3, 0xffff, 4, 5, 6, 7};
    const GLuint indexBuffer = hostBuffer(std::as_bytes(std::span(indices)));
    GLuint vertexArray = 0;
    gl().CreateVertexArrays(1, &vertexArray);
    gl().VertexArrayElementBuffer(vertexArray, indexBuffer);
    gl().Enable(GL_PRIMITIVE_RESTART_FIXED_INDEX);
    std::vector<std::uint32_t> passes;
    DrawSource source;
    source.vertexShader = R"(
        LaminaVertex laminaVertex() {
            vec2 corner = vec2(gl_VertexID & 1, (gl_VertexID >> 1) & 1) * 2.0 - 1.0;
            return LaminaVertex(vec3(corner, gl_VertexID < 4 ? -0.5 : 0.5), vec3(0.0), 0u);
        })";
    source.draw = [&](const DrawContext& draw) {
        passes.push_back(draw.pass);
        EXPECT_EQ(draw.passCount, 2u);
        gl().BindVertexArray(vertexArray);
        gl().DrawElements(GL_TRIANGLE_STRIP, 9, GL_UNSIGNED_SHORT, nullptr);
    };
    const GeometrySource sources[] = {source};
    const BitGrid found = voxelize(sources, testGrid(2048));
    EXPECT_THAT(passes, testing::ElementsAre(0u, 1u));
    EXPECT_EQ(found.count(), 2u * 48u * 40u);
    EXPECT_TRUE(found.test({7, 9, 512}));
    EXPECT_TRUE(found.test({7, 9, 1536}));
    gl().Disable(GL_PRIMITIVE_RESTART_FIXED_INDEX);
    gl().DeleteVertexArrays(1, &vertexArray);
}

TEST_F(VoxelizerGlTest, NonFiniteAndDegenerateTrianglesSetNothing) {
    const auto corners = test::degenerateTriangles();
    MeshView view;
    view.vertexBuffer = hostBuffer(std::as_bytes(std::span(corners)));
    view.vertexCount = 15;
    EXPECT_EQ(voxelize(view).count(), 0u);
}

TEST_F(VoxelizerGlTest, MeshViewsThatDoNotFitTheirBuffersAreRefused) {
    const float bytes[90] = {};
    MeshView good;
    good.vertexBuffer = hostBuffer(std::as_bytes(std::span(bytes)));
    good.vertexCount = 30;
    const std::uint32_t indices[6] = {};
    good.indexBuffer = hostBuffer(std::as_bytes(std::span(indices)));
    good.indexType = IndexType::UInt32;
    good.indexCount = 6;
    ASSERT_EQ(voxelize(good).count(), 0u);

    const auto expectRefused = [&](auto change, const std::string& text,
                                   ErrorCode code = ErrorCode::InvalidArgument) {
        MeshView view = good;
        change(view);
        const Error error = failure(view);
        EXPECT_EQ(error.code, code) << error.text;
        EXPECT_THAT(error.text, AllOf(HasSubstr("voxelize: source 0"), HasSubstr(text)));
    };
    expectRefused([](MeshView& v) { v.vertexBuffer = 987654; },
                  "expected vertexBuffer to name a GL buffer, found 987654");
    expectRefused([](MeshView& v) { v.vertexCount = 31; },
                  "expected a vertex buffer of 372 bytes for 31 vertices, found 360");
    expectRefused([](MeshView& v) { v.positionOffsetBytes = 4; }, "364 bytes for 30 vertices");
    expectRefused([](MeshView& v) { v.positionOffsetBytes = ~std::uint64_t{3}; },
                  "expected a vertex buffer of 18446744073709551615 bytes");
    expectRefused([](MeshView& v) { v.indexOffsetBytes = ~std::uint64_t{3}; },
                  "expected an index buffer of 18446744073709551615 bytes");
    expectRefused([](MeshView& v) { v.vertexStrideBytes = 0; }, "vertex stride above 0");
    expectRefused([](MeshView& v) { v.vertexStrideBytes = 13; }, "multiples of 4 bytes");
    expectRefused([](MeshView& v) { v.vertexStrideBytes = 1u << 20; }, "the device's limit is",
                  ErrorCode::DeviceLimit);
    expectRefused([](MeshView& v) { v.indexBuffer = 0; }, "expected indexBuffer");
    expectRefused([](MeshView& v) { v.indexCount = 7; }, "three indices a triangle, found 7");
    expectRefused([](MeshView& v) { v.indexCount = 9; },
                  "expected an index buffer of 36 bytes for 9 indices, found 24");
    expectRefused([](MeshView& v) { v.indexOffsetBytes = 2; }, "multiples of 4 bytes, found 2");
    expectRefused([](MeshView& v) { v.indexType = IndexType::None, v.vertexCount = 29; },
                  "three vertices a triangle, found 29");
    expectRefused([](MeshView& v) { v.model[2][3] = 0.5f; }, "affine model matrix");
    expectRefused([](MeshView& v) { v.model[3][0] = std::numeric_limits<float>::quiet_NaN(); },
                  "affine model matrix");
}

TEST_F(VoxelizerGlTest, ADrawSourcesBrokenVertexStageIsReportedWithItsLine) {
    DrawSource source;
    source.draw = [](const DrawContext&) {};
    EXPECT_THAT(failure(source).text, HasSubstr("expected a DrawSource with a vertex stage"));
    source.vertexShader =
        "LaminaVertex laminaVertex() { return LaminaVertex(vec3(0), vec3(0), 0u); }";
    source.maxTriangles = (std::uint64_t{1} << 62) + 1;
    EXPECT_THAT(failure(source).text, HasSubstr("found 4611686018427387905"));
    source.maxTriangles = 0;
    source.vertexShader = "// first line\nLaminaVertex laminaVertex() { return missing; }\n";
    const Error error = failure(source);
    EXPECT_EQ(error.code, ErrorCode::ShaderError);
    EXPECT_THAT(error.text, AllOf(HasSubstr("host vertex stage:2"), HasSubstr("missing")));
    EXPECT_THAT(takeHighSeverityMessages(), testing::Not(testing::IsEmpty())); // the compiler's
}

TEST_F(VoxelizerGlTest, GridsOverLimitsAndBudgetAreRefused) {
    auto buffers = MeshBuffers::upload(device(), kKnot).value();
    const std::uint32_t limit = device().limits().maxTextureSize;
    const Box3 box{{-1, -1, -1}, {1, 1, 1}};
    const Error wide = failure(buffers.view(), GridTransform::box(box, {limit + 1, 1, 1}).value());
    EXPECT_EQ(wide.code, ErrorCode::DeviceLimit);
    EXPECT_THAT(wide.text, AllOf(HasSubstr(std::to_string(limit + 1)), HasSubstr("limit")));
    const std::uint32_t layers = device().limits().maxArrayTextureLayers;
    EXPECT_EQ(
        failure(buffers.view(), GridTransform::box(box, {1, 1, layers * 128 + 1}).value()).code,
        ErrorCode::DeviceLimit);
    EXPECT_EQ(
        failure(buffers.view(), GridTransform::camera(GridCamera{.near = 1, .far = 2}, {4, 4, 4032},
                                                      SliceDistribution::logarithmic())
                                    .value())
            .code,
        ErrorCode::DeviceLimit);

    device().setMemoryBudget(device().allocatedBytes() + (20u << 20));
    const Error budget =
        failure(buffers.view(), GridTransform::box(box, {1024, 1024, 256}).value());
    EXPECT_EQ(budget.code, ErrorCode::OutOfMemory);
    EXPECT_THAT(budget.text,
                AllOf(HasSubstr("needs 32 MiB"), HasSubstr("memory budget"), HasSubstr("left")));
    device().setMemoryBudget(0);
    EXPECT_GT(voxelize(std::array<GeometrySource, 1>{buffers.view()},
                       GridTransform::box(box, {1024, 1024, 256}).value())
                  .count(),
              0u);
}

TEST_F(VoxelizerGlTest, InvalidMeshesAreNotUploaded) {
    const auto text = [&](const TriangleMesh& mesh) {
        auto buffers = MeshBuffers::upload(device(), mesh);
        EXPECT_FALSE(buffers);
        return buffers ? std::string() : buffers.error().text;
    };
    EXPECT_THAT(text({}), HasSubstr("at least one triangle, found none"));
    TriangleMesh mesh = ref::makeCube({0, 0, 0}, 1.0f);
    mesh.triangles[3].y = 99;
    EXPECT_THAT(text(mesh), HasSubstr("below 8, found 99 in triangle 3"));
    mesh = ref::makeCube({0, 0, 0}, 1.0f);
    mesh.positions[5].z = std::numeric_limits<float>::quiet_NaN();
    EXPECT_THAT(text(mesh), HasSubstr("vertex 5"));
}

TEST_F(VoxelizerGlTest, ObjectsGiveTheirMemoryBack) {
    const std::uint64_t before = device().allocatedBytes();
    {
        auto buffers = MeshBuffers::upload(device(), kKnot).value();
        auto grid = VoxelGrid::create(device()).value();
        ASSERT_TRUE(grid.resize(testGrid()));
        EXPECT_EQ(device().allocatedBytes(), before + buffers.gpuBytes() + grid.gpuBytes());
        EXPECT_EQ(buffers.gpuBytes(), kKnot.positions.size() * 12 + kKnot.triangles.size() * 12);
        const VoxelGrid moved = std::move(grid);
        EXPECT_GE(moved.gpuBytes(), 48u * 40u * 16u);
    }
    EXPECT_EQ(device().allocatedBytes(), before);
    EXPECT_THAT(VoxelGrid::create(device())->download().error().text, HasSubstr("no size"));
}

TEST_F(VoxelizerGlTest, TheStoreFollowsTheBackendAndMemoryIsGivenBack) {
    auto buffers = MeshBuffers::upload(device(), kKnot).value();
    auto overlap = Voxelizer::create(device(), {.coverage = Coverage::Conservative}).value();
    const GeometrySource source = buffers.view();
    const BitGrid sampled = voxelize(source);
    EXPECT_EQ(mGrid->store(), VoxelStore::Texture);
    EXPECT_EQ(mGrid->buffer(), 0u);
    const std::uint64_t bytes = mGrid->gpuBytes();
    ASSERT_TRUE(overlap->voxelize({&source, 1}, testGrid(), *mGrid));
    EXPECT_EQ(mGrid->store(), overlap->capabilities().store);
    EXPECT_EQ(mGrid->store(), VoxelStore::Buffer);
    EXPECT_NE(mGrid->buffer(), 0u);
    EXPECT_EQ(mGrid->gpuBytes(), bytes);
    EXPECT_EQ(compare(sampled, mGrid->download().value())->onlyFirst, 0u);
    EXPECT_TRUE(compare(voxelize(source), sampled)->equal());
    EXPECT_EQ(mGrid->store(), VoxelStore::Texture);
    EXPECT_EQ(mGrid->gpuBytes(), bytes);
}

} // namespace
} // namespace lamina
