// Every call of the epipolar backend leaves the GL state as it found it, from a state far from the
// defaults, works all the same, and refuses bad input and full budgets.

#include "gl/support/gl_state.hpp"
#include "gl/support/gl_test.hpp"

#include <lamina/voxelize/epipolar_voxelizer.hpp>

#include <reference/shapes.hpp>

#include <glm/gtc/matrix_transform.hpp>

#include <gmock/gmock.h>

#include <algorithm>

namespace lamina {
namespace {

using test::differences;
using test::OddGlState;
using test::readGlState;
using testing::HasSubstr;

const TriangleMesh kBox = reference::makeBox({-0.5f, -0.5f, -0.5f}, {0.5f, 0.5f, 0.5f});
const GridCamera kEye = GridCamera::perspective(
    glm::lookAt(glm::dvec3(0, 1, 4), glm::dvec3(0), glm::dvec3(0, 1, 0)), 1.0, 1.0, 0.1, 10.0);

EpipolarTransform boxVolume(const glm::uvec3& size, bool isSun = false) {
    const EpipolarLight lamp{.position = {2, 2, 0}};
    const EpipolarLight sun{.kind = LightKind::Directional, .direction = {-1, -1, 0.1}};
    return EpipolarTransform::fit(kEye, isSun ? sun : lamp, size).value();
}

class EpipolarStateGlTest : public test::GlTest {
protected:
    EpipolarBits boxBits(std::span<const EpipolarTransform> transforms) {
        auto buffers = MeshBuffers::upload(device(), kBox).value();
        auto voxelizer = EpipolarVoxelizer::create(device(), {.depthMapTexels = 64}).value();
        auto grid = EpipolarGrid::create(device()).value();
        const GeometrySource source = buffers.view();
        EXPECT_TRUE(voxelizer.voxelize({&source, 1}, transforms, grid));
        return grid.download().value();
    }
};

TEST_F(EpipolarStateGlTest, EveryCallRestoresTheState) {
    const EpipolarTransform transforms[] = {boxVolume({32, 16, 140}),
                                            boxVolume({32, 16, 140}, true)};
    const EpipolarBits expected = boxBits(transforms);
    ASSERT_TRUE(
        std::ranges::any_of(expected.words(), [](std::uint32_t word) { return word != 0; }));

    const OddGlState odd(gl());
    auto buffers = MeshBuffers::upload(device(), kBox).value();
    std::optional<EpipolarVoxelizer> voxelizer;
    expectUnchanged("EpipolarVoxelizer::create", [&] {
        voxelizer.emplace(EpipolarVoxelizer::create(device(), {.depthMapTexels = 64}).value());
    });
    std::optional<EpipolarGrid> grid;
    expectUnchanged("EpipolarGrid::create",
                    [&] { grid.emplace(EpipolarGrid::create(device()).value()); });
    const GeometrySource source = buffers.view();
    expectUnchanged("voxelize", [&] {
        ASSERT_TRUE(voxelizer->voxelize({&source, 1}, transforms, *grid));
    });
    std::optional<EpipolarBits> bits;
    expectUnchanged("download", [&] { bits.emplace(grid->download().value()); });
    EXPECT_TRUE(std::ranges::equal(bits->words(), expected.words()));
    expectUnchanged("rectify", [&] {
        ASSERT_TRUE(voxelizer->rectify({&source, 1}, transforms, *grid));
    });
    expectUnchanged("scan", [&] { ASSERT_TRUE(voxelizer->scan(*grid)); });
    EXPECT_TRUE(std::ranges::equal(grid->download()->words(), expected.words()));
    expectUnchanged("upload", [&] { ASSERT_TRUE(grid->upload(*bits)); });
    EXPECT_TRUE(std::ranges::equal(grid->download()->words(), expected.words()));
    expectUnchanged("failed voxelize", [&] {
        const GeometrySource bad = MeshView{};
        EXPECT_FALSE(voxelizer->voxelize({&bad, 1}, transforms, *grid));
    });
    EXPECT_TRUE(std::ranges::equal(grid->download()->words(), expected.words()));
    GLuint depths = 0;
    gl().CreateTextures(GL_TEXTURE_2D, 1, &depths);
    gl().TextureStorage2D(depths, 1, GL_DEPTH_COMPONENT32F, 8, 8);
    expectUnchanged("voxelize from the host's map", [&] {
        LightDepthMap map;
        map.texture = depths;
        map.worldToClip = glm::perspective(1.0, 1.0, 0.1, 9.0) *
                          glm::lookAt(glm::dvec3(2, 2, 0), glm::dvec3(0), glm::dvec3(0, 1, 0));
        const auto made = voxelizer->voxelize({&map, 1}, {transforms, 1}, *grid);
        ASSERT_TRUE(made) << made.error().text;
    });
    gl().DeleteTextures(1, &depths);
    expectUnchanged("destruction", [&] {
        grid.reset();
        voxelizer.reset();
    });
}

TEST_F(EpipolarStateGlTest, ActiveTransformFeedbackIsPausedAndResumed) {
    auto buffers = MeshBuffers::upload(device(), kBox).value();
    const GeometrySource source = buffers.view();
    auto voxelizer = EpipolarVoxelizer::create(device(), {.depthMapTexels = 64}).value();
    auto grid = EpipolarGrid::create(device()).value();
    const EpipolarTransform transform = boxVolume({32, 16, 140});
    const EpipolarBits expected = boxBits({&transform, 1});

    const GLuint program = gl().CreateProgram();
    const GLuint shader = gl().CreateShader(GL_VERTEX_SHADER);
    const char* text = "#version 450\nout float captured;\n"
                       "void main() { captured = 1.0; gl_Position = vec4(0.0); }";
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
    gl().BindBufferBase(GL_TRANSFORM_FEEDBACK_BUFFER, 0, buffer);
    gl().UseProgram(program);
    gl().BeginTransformFeedback(GL_POINTS);
    expectUnchanged("voxelize", [&] {
        ASSERT_TRUE(voxelizer.voxelize({&source, 1}, {&transform, 1}, grid));
    });
    gl().EndTransformFeedback();
    EXPECT_TRUE(std::ranges::equal(grid.download()->words(), expected.words()));
    gl().UseProgram(0);
    gl().BindBufferBase(GL_TRANSFORM_FEEDBACK_BUFFER, 0, 0);
    gl().DeleteProgram(program);
    gl().DeleteBuffers(1, &buffer);
}

TEST_F(EpipolarStateGlTest, BindChangesOnlyWhatItPromises) {
    const EpipolarTransform transform = boxVolume({8, 8, 8});
    auto grid = EpipolarGrid::create(device()).value();
    const auto empty = readGlState(gl());
    grid.bind(1, 2);
    EXPECT_THAT(differences(empty, readGlState(gl())), testing::IsEmpty());
    ASSERT_TRUE(grid.upload(EpipolarBits::create({&transform, 1}).value()));
    const OddGlState odd(gl());
    const auto before = readGlState(gl());
    grid.bind(5, 6);
    EXPECT_THAT(
        differences(before, readGlState(gl())),
        testing::UnorderedElementsAre(testing::StartsWith("GL_SHADER_STORAGE_BUFFER_BINDING[5]:"),
                                      testing::StartsWith("GL_TEXTURE_BINDING_2D_ARRAY[6]:"),
                                      testing::StartsWith("GL_SAMPLER_BINDING[6]:")));
}

TEST_F(EpipolarStateGlTest, RefusesBadInput) {
    auto buffers = MeshBuffers::upload(device(), kBox).value();
    const GeometrySource source = buffers.view();
    auto voxelizer = EpipolarVoxelizer::create(device(), {.depthMapTexels = 64}).value();
    auto grid = EpipolarGrid::create(device()).value();
    EXPECT_THAT(voxelizer.voxelize({&source, 1}, {}, grid).error().text,
                HasSubstr("expected at least one shadow volume, found none"));
    const EpipolarTransform wide = boxVolume({2049, 4, 4});
    const auto tooWide = voxelizer.voxelize({&source, 1}, {&wide, 1}, grid);
    EXPECT_EQ(tooWide.error().code, ErrorCode::DeviceLimit);
    EXPECT_THAT(tooWide.error().text, HasSubstr("at most 2048 voxels along alpha, found 2049"));
    const EpipolarTransform tall = boxVolume({4, 1u << 20, 4});
    EXPECT_EQ(voxelizer.voxelize({&source, 1}, {&tall, 1}, grid).error().code,
              ErrorCode::DeviceLimit);
    const EpipolarTransform fine = boxVolume({4, 4, 4});
    const GeometrySource broken = DrawSource{};
    EXPECT_THAT(voxelizer.voxelize({&broken, 1}, {&fine, 1}, grid).error().text,
                HasSubstr("source 0: expected a DrawSource with a vertex stage"));
    DrawSource wrong;
    wrong.vertexShader = "LaminaVertex laminaVertex() { return nonsense; }";
    wrong.draw = [](const DrawContext&) {};
    const GeometrySource shader = wrong;
    EXPECT_EQ(voxelizer.voxelize({&shader, 1}, {&fine, 1}, grid).error().code,
              ErrorCode::ShaderError);
    EXPECT_THAT(voxelizer.scan(grid).error().text, HasSubstr("grid with shadow volumes"));
    EXPECT_THAT(grid.download().error().text, HasSubstr("voxelize into it first"));
    EXPECT_EQ(grid.texture(), 0u);
    EXPECT_THAT(EpipolarVoxelizer::create(device(), {.depthMapTexels = 0}).error().text,
                HasSubstr("depth maps of 1 to"));
    EXPECT_THAT(EpipolarVoxelizer::create(device(), {.nearShare = 0.0}).error().text,
                HasSubstr("near share in (0, 1)"));
    EXPECT_THAT(EpipolarGrid::create(device(), {.bitsPerTexel = 64}).error().text,
                HasSubstr("127 or 128 bits per texel, found 64"));
    // A DrawSource that does not compile is the only error that reaches the driver.
    static_cast<void>(takeHighSeverityMessages());
}

TEST_F(EpipolarStateGlTest, BudgetsAreKeptBeforeWorkStarts) {
    auto buffers = MeshBuffers::upload(device(), kBox).value();
    const GeometrySource source = buffers.view();
    auto voxelizer = EpipolarVoxelizer::create(device(), {.depthMapTexels = 64}).value();
    auto grid = EpipolarGrid::create(device()).value();
    const EpipolarTransform small = boxVolume({32, 32, 128});
    ASSERT_TRUE(voxelizer.voxelize({&source, 1}, {&small, 1}, grid));
    const EpipolarBits before = grid.download().value();
    const std::uint64_t used = device().allocatedBytes();
    device().setMemoryBudget(used + (1u << 20));
    const std::vector<EpipolarTransform> many(100, boxVolume({128, 128, 128}));
    const auto refused = voxelizer.voxelize({&source, 1}, many, grid);
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().code, ErrorCode::OutOfMemory);
    EXPECT_THAT(refused.error().text, HasSubstr("memory budget"));
    EXPECT_TRUE(std::ranges::equal(grid.download()->words(), before.words()));
    ASSERT_TRUE(voxelizer.voxelize({&source, 1}, {&small, 1}, grid));
    EXPECT_EQ(grid.gpuBytes(), 32u * 32u * 16u + 144u);
    device().setMemoryBudget(0);
}

} // namespace
} // namespace lamina
