// Every public call that touches the device leaves the GL state as it found it, starting from a
// state far from the defaults, and works all the same.

#include "gl/support/gl_state.hpp"
#include "gl/support/gl_test.hpp"
#include "gl/support/voxelize.hpp"

#include <reference/shapes.hpp>

#include <gmock/gmock.h>

#include <algorithm>

namespace lamina {
namespace {

using test::differences;
using test::OddGlState;
using test::readGlState;

class StateGlTest : public test::GlTest {};

const TriangleMesh kBox = reference::makeBox({0.25f, 0.25f, 0.25f}, {0.75f, 0.75f, 0.75f});

GridTransform unitGrid(std::uint32_t slices) {
    return GridTransform::box({{0, 0, 0}, {1, 1, 1}}, {16, 8, slices}).value();
}

TEST_F(StateGlTest, TheOddStateDiffersFromTheDefaultsAndGoesAway) {
    const auto defaults = readGlState(gl());
    {
        const OddGlState odd(gl());
        EXPECT_GT(differences(defaults, readGlState(gl())).size(), 150u);
    }
    gl().Enable(GL_RASTERIZER_DISCARD);
    EXPECT_THAT(differences(defaults, readGlState(gl())),
                testing::Contains("GL_RASTERIZER_DISCARD: 0 -> 1"));
    gl().Disable(GL_RASTERIZER_DISCARD);
}

TEST_F(StateGlTest, DeviceCreationChangesNothing) {
    const OddGlState odd(gl());
    expectUnchanged("fromCurrentContext", [] {
        auto device = Device::fromCurrentContext(
            [](const char* name) { return test::context().getProcAddress(name); });
        ASSERT_TRUE(device) << device.error().text;
    });
}

TEST_F(StateGlTest, EveryCallOfAVoxelizationRestoresTheState) {
    const VoxelizerDesc descs[] = {{.coverage = Coverage::Sampled},
                                   {.coverage = Coverage::Filled},
                                   {.coverage = Coverage::Conservative},
                                   {.coverage = Coverage::Separating6},
                                   {.coverage = Coverage::Solid},
                                   {.coverage = Coverage::Solid, .solidRule = SolidRule::Voted},
                                   {.coverage = Coverage::Solid, .solidRule = SolidRule::FloodFill},
                                   {Backend::Slicemap, Coverage::Conservative},
                                   {Backend::Slicemap, Coverage::Solid}};
    for (const VoxelizerDesc& desc : descs) {
        // The expected voxels, made in the default state.
        const BitGrid expected = test::voxelize(device(), desc, kBox, unitGrid(200));
        ASSERT_GT(expected.count(), 0u);
        const OddGlState odd(gl());
        std::optional<MeshBuffers> buffers;
        expectUnchanged("MeshBuffers::upload",
                        [&] { buffers.emplace(MeshBuffers::upload(device(), kBox).value()); });
        std::unique_ptr<Voxelizer> voxelizer;
        expectUnchanged("Voxelizer::create",
                        [&] { voxelizer = Voxelizer::create(device(), desc).value(); });
        std::optional<VoxelGrid> grid;
        expectUnchanged("VoxelGrid::create",
                        [&] { grid.emplace(VoxelGrid::create(device()).value()); });
        const GeometrySource source = buffers->view();
        expectUnchanged("voxelize", [&] {
            ASSERT_TRUE(voxelizer->voxelize({&source, 1}, unitGrid(200), *grid));
        });
        std::optional<BitGrid> bits;
        expectUnchanged("download", [&] { bits.emplace(grid->download().value()); });
        EXPECT_TRUE(compare(*bits, expected)->equal())
            << name(desc.coverage) << " " << name(desc.solidRule);
        expectUnchanged("upload", [&] { ASSERT_TRUE(grid->upload(*bits)); });
        EXPECT_TRUE(compare(grid->download().value(), *bits)->equal());
        if (desc.coverage == Coverage::Solid)
            expectUnchanged("downloadSolidReport",
                            [&] { EXPECT_EQ(voxelizer->downloadSolidReport()->oddColumns, 0u); });
        if (desc.coverage == Coverage::Solid && desc.solidRule == SolidRule::Voted)
            expectUnchanged("downloadDoubtfulVoxels",
                            [&] { EXPECT_EQ(voxelizer->downloadDoubtfulVoxels()->count(), 0u); });
        expectUnchanged("resize", [&] { ASSERT_TRUE(grid->resize(unitGrid(300))); });
        for (const VoxelStore store : {VoxelStore::Buffer, VoxelStore::Texture})
            expectUnchanged("resize", [&] { ASSERT_TRUE(grid->resize(unitGrid(200), store)); });
        expectUnchanged("failed voxelize", [&] {
            MeshView broken;
            const GeometrySource bad = broken;
            EXPECT_FALSE(voxelizer->voxelize({&bad, 1}, unitGrid(200), *grid));
        });
        expectUnchanged("destruction", [&] {
            grid.reset();
            voxelizer.reset();
            buffers.reset();
        });
    }
}

TEST_F(StateGlTest, EverySlicemapRestoresTheState) {
    const VoxelizerDesc descs[] = {
        {Backend::Slicemap, Coverage::Filled},
        {Backend::LocalSlicemap, Coverage::Filled},
        {Backend::MrtSlicemap, Coverage::Filled, false, VoxelStore::Texture},
        {Backend::MrtSlicemap, Coverage::Filled, false, VoxelStore::Buffer},
        {Backend::MrtSlicemap, Coverage::Solid, false, VoxelStore::Buffer},
        {Backend::MrtSlicemap, Coverage::Conservative, true, VoxelStore::Texture},
        {Backend::MrtSlicemap, Coverage::Filled, true, VoxelStore::Buffer},
    };
    for (const VoxelizerDesc& desc : descs) {
        const std::string text = std::string(name(desc.backend)) + " " +
                                 std::string(name(desc.store.value_or(VoxelStore::Texture)));
        const BitGrid expected = test::voxelize(device(), desc, kBox, unitGrid(1200));
        ASSERT_GT(expected.count(), 0u);
        auto buffers = MeshBuffers::upload(device(), kBox).value();
        const GeometrySource source = buffers.view();
        const OddGlState odd(gl());
        std::unique_ptr<Voxelizer> voxelizer;
        expectUnchanged("Voxelizer::create",
                        [&] { voxelizer = Voxelizer::create(device(), desc).value(); });
        auto grid = VoxelGrid::create(device()).value();
        expectUnchanged(text.c_str(), [&] {
            ASSERT_TRUE(voxelizer->voxelize({&source, 1}, unitGrid(1200), grid));
        });
        std::optional<BitGrid> bits;
        expectUnchanged("download", [&] { bits.emplace(grid.download().value()); });
        EXPECT_TRUE(compare(*bits, expected)->equal()) << text;
        EXPECT_TRUE(std::ranges::equal(bits->ranges(), expected.ranges())) << text;
        expectUnchanged("upload", [&] { ASSERT_TRUE(grid.upload(*bits)); });
        EXPECT_TRUE(std::ranges::equal(grid.download()->ranges(), expected.ranges())) << text;

        std::vector<VoxelGrid> grids;
        for (int i = 0; i < 2; ++i)
            grids.push_back(VoxelGrid::create(device()).value());
        const std::vector<Material> materials(1);
        for (const Split split : {Split::Facing, Split::ColorClass})
            if (voxelizer->capabilities().splits)
                expectUnchanged("voxelizeWith", [&] {
                    VoxelizeOptions options;
                    options.split = split;
                    options.materials = materials;
                    if (voxelizer->capabilities().localRanges)
                        options.bounds = {&source, 1};
                    ASSERT_TRUE(
                        voxelizer->voxelizeWith({&source, 1}, unitGrid(300), options, grids));
                });
        expectUnchanged("failed voxelizeWith", [&] {
            EXPECT_FALSE(voxelizer->voxelizeWith({&source, 1}, unitGrid(300), {}, grids));
        });
    }
}

TEST_F(StateGlTest, MeasuringTheStoreRestoresTheState) {
    const OddGlState odd(gl());
    expectUnchanged("Voxelizer::create",
                    [&] { EXPECT_TRUE(Voxelizer::create(device(), {Backend::MrtSlicemap})); });
}

class DrawSourceStateGlTest : public StateGlTest, public testing::WithParamInterface<Coverage> {};
INSTANTIATE_TEST_SUITE_P(Backends, DrawSourceStateGlTest,
                         testing::Values(Coverage::Sampled, Coverage::Conservative));

TEST_P(DrawSourceStateGlTest, ADrawCallbackMayDisturbWhatTheGuardCovers) {
    auto voxelizer = Voxelizer::create(device(), {.coverage = GetParam()}).value();
    auto grid = VoxelGrid::create(device()).value();
    const OddGlState odd(gl());
    GLuint vertexArray = 0;
    gl().CreateVertexArrays(1, &vertexArray);
    DrawSource source;
    source.vertexShader = R"(
        LaminaVertex laminaVertex() {
            vec2 corner = vec2(gl_VertexID == 1 ? 3.0 : 0.0, gl_VertexID == 2 ? 3.0 : 0.0);
            return LaminaVertex(vec3(corner, 0.5), vec3(0.0, 0.0, 1.0), 0u);
        })";
    source.draw = [&](const DrawContext& draw) {
        EXPECT_NE(draw.program, 0u);
        gl().BindVertexArray(vertexArray);
        gl().DrawArrays(GL_TRIANGLES, 0, 3);
        gl().Enable(GL_CULL_FACE);
        gl().BindBufferBase(GL_UNIFORM_BUFFER, 0, 0);
        // The generic binding is the host's own to restore.
        gl().BindBuffer(GL_UNIFORM_BUFFER, 0);
    };
    const GeometrySource sources[] = {source};
    auto before = readGlState(gl());
    ASSERT_TRUE(voxelizer->voxelize(sources, unitGrid(64), grid));
    auto after = readGlState(gl());
    before.erase("GL_UNIFORM_BUFFER_BINDING");
    after.erase("GL_UNIFORM_BUFFER_BINDING");
    EXPECT_THAT(differences(before, after), testing::IsEmpty());
    // Depth 0.5 is a slice boundary, of which conservative coverage sets both sides.
    EXPECT_EQ(grid.download()->count(), GetParam() == Coverage::Sampled ? 16u * 8u : 2u * 16u * 8u);
    gl().DeleteVertexArrays(1, &vertexArray);
}

TEST_P(DrawSourceStateGlTest, ActiveTransformFeedbackIsPausedAndResumed) {
    auto buffers = MeshBuffers::upload(device(), kBox).value();
    auto voxelizer = Voxelizer::create(device(), {.coverage = GetParam()}).value();
    auto grid = VoxelGrid::create(device()).value();

    const GLuint program = gl().CreateProgram();
    const char* text =
        "#version 450\nout float captured;\nvoid main() { captured = float(gl_VertexID) + 1.0;"
        " gl_Position = vec4(0.0); }";
    const GLuint shader = gl().CreateShader(GL_VERTEX_SHADER);
    gl().ShaderSource(shader, 1, &text, nullptr);
    gl().CompileShader(shader);
    gl().AttachShader(program, shader);
    const char* varying = "captured";
    gl().TransformFeedbackVaryings(program, 1, &varying, GL_INTERLEAVED_ATTRIBS);
    gl().LinkProgram(program);
    gl().DeleteShader(shader);
    GLuint buffer = 0;
    gl().CreateBuffers(1, &buffer);
    gl().NamedBufferData(buffer, 64, nullptr, GL_DYNAMIC_READ);
    GLuint vertexArray = 0;
    gl().CreateVertexArrays(1, &vertexArray);
    gl().BindVertexArray(vertexArray);
    // A context without a surface has no default framebuffer to draw to.
    GLuint framebuffer = 0;
    gl().CreateFramebuffers(1, &framebuffer);
    gl().NamedFramebufferParameteri(framebuffer, GL_FRAMEBUFFER_DEFAULT_WIDTH, 4);
    gl().NamedFramebufferParameteri(framebuffer, GL_FRAMEBUFFER_DEFAULT_HEIGHT, 4);
    gl().BindFramebuffer(GL_DRAW_FRAMEBUFFER, framebuffer);
    gl().BindBufferBase(GL_TRANSFORM_FEEDBACK_BUFFER, 0, buffer);
    gl().UseProgram(program);
    gl().Enable(GL_RASTERIZER_DISCARD);
    gl().BeginTransformFeedback(GL_POINTS);
    gl().DrawArrays(GL_POINTS, 0, 2);
    const GeometrySource source = buffers.view();
    expectUnchanged("voxelize", [&] {
        ASSERT_TRUE(voxelizer->voxelize({&source, 1}, unitGrid(64), grid));
    });
    if (voxelizer->backend() == Backend::Overlap)
        expectUnchanged("refused voxelize", [&] {
            const GeometrySource captured = DrawSource{"LaminaVertex laminaVertex() { return "
                                                       "LaminaVertex(vec3(0), vec3(0), 0u); }",
                                                       [](const DrawContext&) {}};
            EXPECT_THAT(voxelizer->voxelize({&captured, 1}, unitGrid(64), grid).error().text,
                        testing::HasSubstr("expected no active transform feedback"));
        });
    gl().DrawArrays(GL_POINTS, 0, 2);
    gl().EndTransformFeedback();
    gl().Disable(GL_RASTERIZER_DISCARD);
    float captured[4] = {};
    gl().GetNamedBufferSubData(buffer, 0, sizeof captured, captured);
    EXPECT_THAT(captured, testing::ElementsAre(1.0f, 2.0f, 1.0f, 2.0f));
    EXPECT_GT(grid.download()->count(), 0u);

    gl().UseProgram(0);
    gl().BindVertexArray(0);
    gl().BindFramebuffer(GL_DRAW_FRAMEBUFFER, 0);
    gl().DeleteFramebuffers(1, &framebuffer);
    gl().BindBufferBase(GL_TRANSFORM_FEEDBACK_BUFFER, 0, 0);
    gl().DeleteProgram(program);
    gl().DeleteBuffers(1, &buffer);
    gl().DeleteVertexArrays(1, &vertexArray);
}

TEST_F(StateGlTest, BindingLocalRangesChangesOneMoreUnit) {
    auto grid = VoxelGrid::create(device()).value();
    ASSERT_TRUE(
        grid.upload(BitGrid::create(unitGrid(64), std::vector<ColumnRange>(16 * 8)).value()));
    const OddGlState odd(gl());
    const auto before = readGlState(gl());
    grid.bind(5, 2, 1, 3);
    EXPECT_THAT(
        differences(before, readGlState(gl())),
        testing::UnorderedElementsAre(testing::StartsWith("GL_UNIFORM_BUFFER_BINDING[6]:"),
                                      testing::StartsWith("GL_TEXTURE_BINDING_2D_ARRAY[3]:"),
                                      testing::StartsWith("GL_SAMPLER_BINDING[3]:"),
                                      testing::StartsWith("GL_TEXTURE_BINDING_2D[4]:"),
                                      testing::StartsWith("GL_SAMPLER_BINDING[4]:")));
}

TEST_F(StateGlTest, AFullDebugGroupStackIsLeftAlone) {
    auto grid = VoxelGrid::create(device()).value();
    GLint maxDepth = 0;
    gl().GetIntegerv(GL_MAX_DEBUG_GROUP_STACK_DEPTH, &maxDepth);
    for (GLint i = 1; i < maxDepth; ++i)
        gl().PushDebugGroup(GL_DEBUG_SOURCE_APPLICATION, 0, -1, "host");
    expectUnchanged("upload",
                    [&] { ASSERT_TRUE(grid.upload(BitGrid::create(unitGrid(64)).value())); });
    for (GLint i = 1; i < maxDepth; ++i)
        gl().PopDebugGroup();
}

TEST_F(StateGlTest, BindChangesOnlyWhatItPromises) {
    const std::pair<VoxelStore, const char*> stores[] = {
        {VoxelStore::Texture, "GL_TEXTURE_BINDING_2D_ARRAY[7]:"},
        {VoxelStore::Buffer, "GL_TEXTURE_BINDING_BUFFER[7]:"}};
    for (const auto& [store, binding] : stores) {
        auto grid = VoxelGrid::create(device(), store).value();
        ASSERT_TRUE(grid.upload(BitGrid::create(unitGrid(64)).value()));
        const OddGlState odd(gl());
        const auto before = readGlState(gl());
        grid.bind(5, 6, 1);
        EXPECT_THAT(
            differences(before, readGlState(gl())),
            testing::UnorderedElementsAre(testing::StartsWith("GL_UNIFORM_BUFFER_BINDING[6]:"),
                                          testing::StartsWith(binding),
                                          testing::StartsWith("GL_SAMPLER_BINDING[7]:")));
    }
}

} // namespace
} // namespace lamina
