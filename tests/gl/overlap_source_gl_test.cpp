// Every kind of source reaches the overlap backend; errors leave all unchanged.

#include "gl/support/gl_test.hpp"
#include "gl/support/grids.hpp"
#include "gl/support/sources.hpp"
#include "gl/support/voxelize.hpp"

#include <reference/overlap.hpp>
#include <reference/shapes.hpp>

#include <gmock/gmock.h>

namespace lamina {
namespace {

namespace ref = reference;
using test::testGrid;
using testing::AllOf;
using testing::HasSubstr;

const TriangleMesh kKnot = test::makeKnot();
constexpr VoxelizerDesc kConservative{Backend::Overlap, Coverage::Conservative};

class OverlapSourceGlTest : public test::GlTest {
protected:
    BitGrid voxelize(const GeometrySource& source) {
        return test::voxelize(device(), kConservative, {&source, 1}, testGrid());
    }
    /// Known to be right from overlap_gl_test.cpp.
    BitGrid expected(const TriangleMesh& mesh) {
        return test::voxelize(device(), kConservative, mesh, testGrid());
    }

    /// `count` separate triangles on a spiral, made by gl_VertexID alone.
    DrawSource spiral(std::uint32_t count, std::uint64_t maxTriangles);

    int mDraws = 0;
};

TEST_F(OverlapSourceGlTest, MeshViewsOfEveryLayoutGiveTheSameVoxels) {
    const BitGrid right = expected(kKnot);
    EXPECT_EQ(compare(ref::overlap(kKnot, testGrid(), {.grow = -1e-9}).value(), right)->onlyFirst,
              0u);
    test::forEachLayout(
        kKnot, [&](std::span<const std::byte> bytes) { return hostBuffer(bytes); },
        [&](const MeshView& view, const std::string& layout) {
            EXPECT_TRUE(compare(voxelize(view), right)->equal()) << layout;
        });
}

TEST_F(OverlapSourceGlTest, BuffersLargerThanAStorageBindingAreCaptured) {
    const BitGrid right = expected(kKnot);
    auto buffers = MeshBuffers::upload(device(), kKnot).value();
    const GeometrySource source = buffers.view();
    // The grid still fits.
    device().state()->limits.maxStorageBlockBytes = 4096;
    EXPECT_TRUE(compare(voxelize(source), right)->equal());
}

TEST_F(OverlapSourceGlTest, IndicesOutOfRangeDropTheirTriangles) {
    auto buffers = MeshBuffers::upload(device(), kKnot).value();
    MeshView view = buffers.view();
    view.vertexCount = 1;
    EXPECT_EQ(voxelize(view).count(), 0u);
}

TEST_F(OverlapSourceGlTest, SeveralMeshesWithModelMatricesGatherInOneGrid) {
    const auto meshes = test::placedMeshes();
    std::vector<MeshBuffers> buffers;
    std::vector<GeometrySource> sources;
    BitGrid must = BitGrid::create(testGrid()).value();
    BitGrid may = must;
    for (const test::PlacedMesh& placed : meshes) {
        buffers.push_back(MeshBuffers::upload(device(), placed.mesh).value());
        sources.emplace_back(buffers.back().view(placed.model));
        const auto add = [&](BitGrid& grid, double grow) {
            ref::overlap(placed.mesh, testGrid(), {glm::dmat4(placed.model), grow})
                ->forEachSet([&](const glm::uvec3& voxel) { grid.set(voxel); });
        };
        add(must, -1e-9);
        add(may, 1e-4);
    }
    auto voxelizer = Voxelizer::create(device(), kConservative).value();
    auto grid = VoxelGrid::create(device()).value();
    const auto stats = voxelizer->voxelize(sources, testGrid(), grid).value();
    const BitGrid found = grid.download().value();
    EXPECT_EQ(compare(must, found)->onlyFirst, 0u);
    EXPECT_EQ(compare(found, may)->onlyFirst, 0u);
    EXPECT_EQ(stats.sources, 3u);
    EXPECT_EQ(stats.passes, 1u);
    EXPECT_EQ(stats.meshTriangles,
              meshes[0].mesh.triangles.size() + meshes[1].mesh.triangles.size() + 12);
    EXPECT_EQ(stats.gridBytes, grid.gpuBytes());
    // Reused, what it held is replaced.
    const std::uint32_t buffer = grid.buffer();
    ASSERT_TRUE(voxelizer->voxelize({}, testGrid(), grid));
    EXPECT_EQ(grid.download()->count(), 0u);
    EXPECT_EQ(grid.buffer(), buffer);
}

DrawSource OverlapSourceGlTest::spiral(std::uint32_t count, std::uint64_t maxTriangles) {
    DrawSource source;
    source.maxTriangles = maxTriangles;
    source.vertexShader = R"(
        uniform float size;
        LaminaVertex laminaVertex() {
            int triangle = gl_VertexID / 3;
            int corner = gl_VertexID % 3;
            // Dyadic, so that the host computes the same positions.
            vec3 place = vec3(triangle & 31, (triangle >> 5) & 31, (triangle >> 10) & 1023) / vec3(16.0, 16.0, 512.0) - 1.0;
            place[corner] += size;
            return LaminaVertex(place, vec3(0.0), 0u);
        })";
    source.draw = [this, count](const DrawContext& draw) {
        ++mDraws;
        gl().Uniform1f(gl().GetUniformLocation(draw.program, "size"), 0.03125f);
        GLuint vertexArray = 0;
        gl().CreateVertexArrays(1, &vertexArray);
        gl().BindVertexArray(vertexArray);
        gl().DrawArrays(GL_TRIANGLES, 0, static_cast<GLsizei>(count * 3));
        gl().DeleteVertexArrays(1, &vertexArray);
    };
    return source;
}

TriangleMesh spiralMesh(std::uint32_t count) {
    TriangleMesh mesh;
    for (std::uint32_t i = 0; i < count; ++i) {
        const glm::vec3 place =
            glm::vec3(i & 31u, (i >> 5u) & 31u, (i >> 10u) & 1023u) / glm::vec3(16, 16, 512) - 1.0f;
        for (int corner = 0; corner < 3; ++corner) {
            mesh.positions.push_back(place);
            mesh.positions.back()[corner] += 0.03125f;
        }
        mesh.triangles.emplace_back(i * 3, i * 3 + 1, i * 3 + 2);
    }
    return mesh;
}

TEST_F(OverlapSourceGlTest, DrawSourcesOfUnknownSizeAreDrawnAgainUntilTheyFit) {
    // At and around the first capacity of 65,536, and beyond the next.
    for (const std::uint32_t count : {1u, 65535u, 65536u, 65537u, 300000u}) {
        mDraws = 0;
        EXPECT_TRUE(compare(voxelize(spiral(count, 0)), expected(spiralMesh(count)))->equal())
            << count;
        EXPECT_EQ(mDraws, count < 65536u ? 1 : (count < 262144u ? 2 : 3)) << count;
    }
    // A voxelizer remembers.
    auto voxelizer = Voxelizer::create(device(), kConservative).value();
    auto grid = VoxelGrid::create(device()).value();
    const GeometrySource source = spiral(100000, 0);
    ASSERT_TRUE(voxelizer->voxelize({&source, 1}, testGrid(), grid));
    mDraws = 0;
    ASSERT_TRUE(voxelizer->voxelize({&source, 1}, testGrid(), grid));
    EXPECT_EQ(mDraws, 1);
}

TEST_F(OverlapSourceGlTest, DrawSourcesOfKnownSizeAreDrawnOnce) {
    for (const std::uint64_t bound : {100000u, 100001u, 400000u}) {
        mDraws = 0;
        EXPECT_TRUE(
            compare(voxelize(spiral(100000, bound)), expected(spiralMesh(100000)))->equal());
        EXPECT_EQ(mDraws, 1);
    }
    // What exceeds the number given is left out.
    EXPECT_TRUE(compare(voxelize(spiral(2000, 1500)), expected(spiralMesh(1500)))->equal());
}

TEST_F(OverlapSourceGlTest, FewerTrianglesInTheNextFrameLeaveNoneBehind) {
    auto voxelizer = Voxelizer::create(device(), kConservative).value();
    auto grid = VoxelGrid::create(device()).value();
    for (const std::uint32_t count : {5000u, 20u, 900u}) {
        const GeometrySource source = spiral(count, 0);
        ASSERT_TRUE(voxelizer->voxelize({&source, 1}, testGrid(), grid));
        EXPECT_TRUE(compare(grid.download().value(), expected(spiralMesh(count)))->equal());
    }
}

TEST_F(OverlapSourceGlTest, StripsRestartAndMeshesBesideDrawSources) {
    const std::uint16_t indices[] = {0, 1, 2, 3, 0xffff, 4, 5, 6, 7};
    const GLuint indexBuffer = hostBuffer(std::as_bytes(std::span(indices)));
    GLuint vertexArray = 0;
    gl().CreateVertexArrays(1, &vertexArray);
    gl().VertexArrayElementBuffer(vertexArray, indexBuffer);
    gl().Enable(GL_PRIMITIVE_RESTART_FIXED_INDEX);
    DrawSource source;
    source.vertexShader = R"(
        LaminaVertex laminaVertex() {
            vec2 corner = vec2(gl_VertexID & 1, (gl_VertexID >> 1) & 1) * 2.0 - 1.0;
            return LaminaVertex(vec3(corner, gl_VertexID < 4 ? -0.51 : 0.52), vec3(0.0), 0u);
        })";
    source.draw = [&](const DrawContext&) {
        gl().BindVertexArray(vertexArray);
        gl().DrawElements(GL_TRIANGLE_STRIP, 9, GL_UNSIGNED_SHORT, nullptr);
    };
    auto buffers = MeshBuffers::upload(device(), ref::makeCube({0, 0, 0}, 0.11f)).value();
    const GeometrySource sources[] = {source, buffers.view(), source};
    const BitGrid found = test::voxelize(device(), kConservative, sources, testGrid(128));
    const BitGrid cube = test::voxelize(device(), kConservative, {&sources[1], 1}, testGrid(128));
    EXPECT_EQ(found.count(), 2u * 48u * 40u + cube.count());
    EXPECT_TRUE(found.test({7, 9, 31}));
    EXPECT_TRUE(found.test({47, 39, 97}));
    EXPECT_TRUE(gl().IsEnabled(GL_PRIMITIVE_RESTART_FIXED_INDEX));
    gl().Disable(GL_PRIMITIVE_RESTART_FIXED_INDEX);
    gl().DeleteVertexArrays(1, &vertexArray);
}

TEST_F(OverlapSourceGlTest, ACallbacksStorageBindingsStayAsItLeavesThem) {
    const GLuint mine = hostBuffer(std::as_bytes(std::span(kKnot.positions)));
    DrawSource source = spiral(10, 0);
    source.draw = [&, draw = source.draw](const DrawContext& context) {
        gl().BindBufferBase(GL_SHADER_STORAGE_BUFFER, 1, mine);
        draw(context);
    };
    EXPECT_GT(voxelize(source).count(), 0u);
    GLint bound = 0;
    gl().GetIntegeri_v(GL_SHADER_STORAGE_BUFFER_BINDING, 1, &bound);
    EXPECT_EQ(static_cast<GLuint>(bound), mine);
}

TEST_F(OverlapSourceGlTest, ErrorsChangeNothing) {
    auto buffers = MeshBuffers::upload(device(), kKnot).value();
    auto voxelizer = Voxelizer::create(device(), kConservative).value();
    auto grid = VoxelGrid::create(device()).value();
    const GeometrySource knot = buffers.view();
    ASSERT_TRUE(voxelizer->voxelize({&knot, 1}, testGrid(), grid));
    const BitGrid before = grid.download().value();
    const auto failure = [&](const GeometrySource& source, const GridTransform& transform) {
        const auto stats = voxelizer->voxelize({&source, 1}, transform, grid);
        EXPECT_FALSE(stats);
        EXPECT_TRUE(compare(grid.download().value(), before)->equal());
        return stats ? Error{} : stats.error();
    };
    const Error perspective = failure(
        knot, GridTransform::camera(GridCamera::perspective(glm::dmat4(1), 1, 1, 1, 2), {8, 8, 8})
                  .value());
    EXPECT_EQ(perspective.code, ErrorCode::Unsupported);
    EXPECT_THAT(perspective.text,
                AllOf(HasSubstr("expected an orthographic grid with linear slices, found 8 x 8 x 8 "
                                "perspective"),
                      HasSubstr("Backend::Slicemap")));
    const Error custom =
        failure(knot, GridTransform::box({{0, 0, 0}, {1, 1, 1}}, {8, 8, 2}, Axis::Z,
                                         SliceDistribution::custom({0, 0.25f, 1}))
                          .value());
    EXPECT_THAT(custom.text, HasSubstr("custom slices; use Backend::Slicemap"));

    const VoxelizerCapabilities able = voxelizer->capabilities();
    EXPECT_FALSE(able.perspective || able.anyDistribution);
    EXPECT_TRUE(able.drawSources);
    EXPECT_GE(able.maxColumns, 16384u);
    EXPECT_GE(able.maxSlices, 65536u);
    const Error wide = failure(
        knot, GridTransform::box({{0, 0, 0}, {1, 1, 1}}, {able.maxColumns + 1, 1, 1}).value());
    EXPECT_EQ(wide.code, ErrorCode::DeviceLimit);
    EXPECT_THAT(wide.text, HasSubstr("the device's limit is"));
    const DeviceLimits limits = device().limits();
    device().state()->limits.maxTextureBufferTexels = 48 * 40 * 2 - 1;
    EXPECT_THAT(failure(knot, testGrid(256)).text,
                HasSubstr("needs a texel buffer of 3840 texels, the device's limit is 3839"));
    device().state()->limits = limits;

    device().setMemoryBudget(device().allocatedBytes() + (20u << 20));
    EXPECT_THAT(
        failure(knot, GridTransform::box({{0, 0, 0}, {1, 1, 1}}, {1024, 1024, 256}).value()).text,
        AllOf(HasSubstr("needs 32 MiB"), HasSubstr("memory budget")));
    EXPECT_THAT(failure(spiral(10, 1000000), testGrid()).text,
                AllOf(HasSubstr("source 0"), HasSubstr("capture of 1000000 triangles")));
    device().setMemoryBudget(0);

    MeshView view = buffers.view();
    view.vertexBuffer = 987654;
    EXPECT_THAT(failure(view, testGrid()).text,
                HasSubstr("voxelize: source 0: expected vertexBuffer to name a GL buffer"));
    DrawSource broken = spiral(1, 0);
    broken.vertexShader = "// first line\nLaminaVertex laminaVertex() { return missing; }\n";
    const Error shader = failure(broken, testGrid());
    EXPECT_EQ(shader.code, ErrorCode::ShaderError);
    EXPECT_THAT(shader.text, HasSubstr("host vertex stage:2"));
    EXPECT_THAT(takeHighSeverityMessages(), testing::Not(testing::IsEmpty())); // the compiler's
    broken.draw = nullptr;
    EXPECT_THAT(failure(broken, testGrid()).text,
                HasSubstr("expected a DrawSource with a vertex stage"));
}

} // namespace
} // namespace lamina
