// What VolumeGrid and VolumeVoxelizer promise apart from the values of voxels: the GL state, reuse,
// errors that leave all unchanged, memory; and lamina/volume.glsl in a host's own shader.

#include "gl/support/gl_state.hpp"
#include "gl/support/gl_test.hpp"
#include "gl/support/grids.hpp"
#include "gl/support/sources.hpp"

#include <lamina/gl/shaders.hpp>
#include <lamina/voxelize/volume_voxelizer.hpp>

#include "voxelize/volume_constants.hpp"

#include <reference/shapes.hpp>

#include <glm/geometric.hpp>
#include <glm/gtc/matrix_transform.hpp>

#include <gmock/gmock.h>

#include <cmath>
#include <random>

namespace lamina {
namespace {

namespace ref = reference;
using test::testGrid;
using testing::AllOf;
using testing::HasSubstr;

constexpr VolumeLayout kFloats{VolumeFormat::R32UI, VolumeFormat::R32F, VolumeFormat::RGBA32F,
                               VolumeFormat::RGBA32F, VolumeFormat::RGBA32F};
constexpr VolumeLayout kHalves{VolumeFormat::R32UI, VolumeFormat::R16F, VolumeFormat::RGBA16F,
                               VolumeFormat::RGBA16F, VolumeFormat::RGBA16F};
constexpr VolumeLayout kBytes{VolumeFormat::R8, VolumeFormat::R8, VolumeFormat::RGBA8,
                              VolumeFormat::RGBA8, VolumeFormat::RGBA8};

TriangleMesh coloredKnot() {
    TriangleMesh mesh = test::makeKnot();
    for (const glm::vec3& position : mesh.positions)
        mesh.colors.emplace_back(position * 0.4f + 0.5f, 1.0f);
    return mesh;
}
const TriangleMesh kKnot = coloredKnot();

class VolumeContractGlTest : public test::GlTest {
protected:
    VolumeData voxelize(std::span<const GeometrySource> sources, const GridTransform& transform,
                        const VolumeLayout& layout) {
        auto voxelizer = VolumeVoxelizer::create(device()).value();
        auto volume = VolumeGrid::create(device(), layout).value();
        EXPECT_TRUE(voxelizer.voxelize(sources, {}, transform, volume));
        return volume.download().value();
    }
};

TEST_F(VolumeContractGlTest, EveryCallRestoresTheState) {
    const auto run = [&](const VolumeLayout& layout) {
        auto buffers = MeshBuffers::upload(device(), kKnot).value();
        const GeometrySource source = buffers.view();
        return voxelize({&source, 1}, testGrid(300), layout);
    };
    for (const VolumeLayout& layout : {kFloats, kBytes, VolumeLayout{}}) {
        // First from the defaults: the odd state switches off what they switch on.
        std::optional<VolumeData> expected;
        expectUnchanged("all in the default state", [&] { expected.emplace(run(layout)); });
        const test::OddGlState odd(gl());
        std::optional<MeshBuffers> buffers;
        expectUnchanged("MeshBuffers::upload",
                        [&] { buffers.emplace(MeshBuffers::upload(device(), kKnot).value()); });
        std::optional<VolumeVoxelizer> voxelizer;
        expectUnchanged("VolumeVoxelizer::create",
                        [&] { voxelizer.emplace(VolumeVoxelizer::create(device()).value()); });
        std::optional<VolumeGrid> volume;
        expectUnchanged("VolumeGrid::create",
                        [&] { volume.emplace(VolumeGrid::create(device(), layout).value()); });
        const GeometrySource source = buffers->view();
        for (int frame = 0; frame < 2; ++frame)
            expectUnchanged("voxelize", [&] {
                ASSERT_TRUE(voxelizer->voxelize({&source, 1}, {}, testGrid(300), *volume));
            });
        std::optional<VolumeData> data;
        expectUnchanged("download", [&] { data.emplace(volume->download().value()); });
        EXPECT_EQ(data->counts, expected->counts);
        EXPECT_EQ(data->normals, expected->normals);
        EXPECT_EQ(data->colors, expected->colors);
        expectUnchanged("failed voxelize", [&] {
            const GeometrySource bad = MeshView();
            EXPECT_FALSE(voxelizer->voxelize({&bad, 1}, {}, testGrid(), *volume));
        });
        expectUnchanged("resize", [&] { ASSERT_TRUE(volume->resize(testGrid(20))); });
        expectUnchanged("destruction", [&] {
            volume.reset();
            voxelizer.reset();
            buffers.reset();
        });
    }
}

TEST_F(VolumeContractGlTest, BindChangesOnlyWhatItPromises) {
    auto volume = VolumeGrid::create(device(), kBytes).value();
    ASSERT_TRUE(volume.resize(testGrid()));
    const test::OddGlState odd(gl());
    const auto before = test::readGlState(gl());
    volume.bind(5, 1);
    for (const std::string& line : test::differences(before, test::readGlState(gl())))
        EXPECT_THAT(line, testing::AnyOf(testing::StartsWith("GL_UNIFORM_BUFFER_BINDING[5]:"),
                                         testing::StartsWith("GL_TEXTURE_BINDING_3D["),
                                         testing::StartsWith("GL_SAMPLER_BINDING[")));
}

TEST_F(VolumeContractGlTest, AVolumeIsReusedAndReplaced) {
    auto buffers = MeshBuffers::upload(device(), kKnot).value();
    auto voxelizer = VolumeVoxelizer::create(device()).value();
    auto volume = VolumeGrid::create(device(), kBytes).value();
    const GeometrySource source = buffers.view();
    const VolumeStats stats = voxelizer.voxelize({&source, 1}, {}, testGrid(), volume).value();
    EXPECT_EQ(stats.sources, 1u);
    EXPECT_EQ(stats.passes, 2u);
    EXPECT_EQ(stats.meshTriangles, kKnot.triangles.size());
    EXPECT_EQ(stats.volumeBytes, volume.gpuBytes());
    EXPECT_GE(stats.volumeBytes, 48u * 40u * 64u * 14u);
    EXPECT_GE(stats.scratchBytes, 48u * 40u * 64u * 26u);
    const std::uint32_t texture = volume.texture(VolumePayload::Normal);
    const std::uint64_t bytes = device().allocatedBytes();
    const auto moved = GridTransform::box({{0, 0, 0}, {1, 1, 2}}, {48, 40, 64}).value();
    ASSERT_TRUE(voxelizer.voxelize({&source, 1}, {}, moved, volume));
    EXPECT_EQ(volume.texture(VolumePayload::Normal), texture);
    EXPECT_EQ(device().allocatedBytes(), bytes);
    EXPECT_EQ(*volume.transform(), moved);
    EXPECT_EQ(volume.download()->counts, voxelize({&source, 1}, moved, kBytes).counts);
    ASSERT_TRUE(voxelizer.voxelize({}, {}, moved, volume));
    const VolumeData empty = volume.download().value();
    EXPECT_THAT(empty.counts, testing::Each(0u));
    EXPECT_THAT(empty.normals, testing::Each(glm::vec3(0.0f)));
}

TEST_F(VolumeContractGlTest, ColoursAsBytesAndStreamsOfTheirOwn) {
    // Positions, normals and colours interleaved at odd places of one buffer; colours as bytes.
    struct Vertex {
        std::uint8_t color[4];
        glm::vec3 normal;
        float unused;
        glm::vec3 position;
    };
    std::vector<Vertex> vertices;
    for (const glm::uvec3& triangle : kKnot.triangles)
        for (int corner = 0; corner < 3; ++corner) {
            const glm::vec3 position = kKnot.positions[triangle[corner]];
            vertices.push_back({{51, 102, 204, 255}, {0, 3, 0}, 0.0f, position});
        }
    MeshView view;
    view.vertexBuffer = hostBuffer(std::as_bytes(std::span(vertices)));
    view.vertexStrideBytes = sizeof(Vertex);
    view.positionOffsetBytes = offsetof(Vertex, position);
    view.vertexCount = static_cast<std::uint32_t>(vertices.size());
    view.normals = {view.vertexBuffer, offsetof(Vertex, normal), sizeof(Vertex)};
    view.colors = {view.vertexBuffer, offsetof(Vertex, color), sizeof(Vertex)};
    view.colorFormat = VertexColorFormat::UNorm8;
    const GeometrySource source = view;
    const VolumeData volume = voxelize({&source, 1}, testGrid(), kFloats);
    std::uint64_t hit = 0;
    for (std::size_t i = 0; i < volume.counts.size(); ++i) {
        if (volume.counts[i] == 0)
            continue;
        ASSERT_LT(glm::length(volume.colors[i] - glm::vec3(0.2f, 0.4f, 0.8f)), 1e-4f);
        ASSERT_LT(glm::length(volume.normals[i] - glm::vec3(0, 1, 0)), 1e-4f);
        ++hit;
    }
    EXPECT_GT(hit, 1000u);
}

TEST_F(VolumeContractGlTest, NonFiniteAndDegenerateTrianglesHitNothing) {
    const auto corners = test::degenerateTriangles();
    MeshView view;
    view.vertexBuffer = hostBuffer(std::as_bytes(std::span(corners)));
    view.vertexCount = 15;
    const GeometrySource source = view;
    EXPECT_THAT(voxelize({&source, 1}, testGrid(), kFloats).counts, testing::Each(0u));
}

TEST_F(VolumeContractGlTest, BadInputIsRefusedAndLeavesTheVolumeUnchanged) {
    auto buffers = MeshBuffers::upload(device(), kKnot).value();
    auto voxelizer = VolumeVoxelizer::create(device()).value();
    auto volume = VolumeGrid::create(device(), kHalves).value();
    const GeometrySource good = buffers.view();
    ASSERT_TRUE(voxelizer.voxelize({&good, 1}, {}, testGrid(), volume));
    const VolumeData before = volume.download().value();
    const std::uint32_t texture = volume.texture(VolumePayload::Color);
    const auto expectRefused =
        [&](const GeometrySource& source, std::span<const Material> materials,
            const GridTransform& transform, ErrorCode code, const std::string& text) {
            const auto stats = voxelizer.voxelize({&source, 1}, materials, transform, volume);
            ASSERT_FALSE(stats) << text;
            EXPECT_EQ(stats.error().code, code) << stats.error().text;
            EXPECT_THAT(stats.error().text, HasSubstr(text));
            EXPECT_EQ(volume.texture(VolumePayload::Color), texture);
            EXPECT_EQ(*volume.transform(), testGrid());
            EXPECT_EQ(volume.download()->counts, before.counts);
        };
    const auto expectBadView = [&](auto change, const std::string& text) {
        MeshView view = buffers.view();
        change(view);
        expectRefused(view, {}, testGrid(), ErrorCode::InvalidArgument,
                      "voxelize: source 0: " + text);
    };
    expectBadView([](MeshView& v) { v.vertexBuffer = 0; }, "expected vertexBuffer");
    expectBadView(
        [](MeshView& v) {
            v.normals = {987654, 0, 12};
        },
        "normals: expected buffer to name a GL buffer, found 987654");
    expectBadView([](MeshView& v) { v.colors.strideBytes = 6; },
                  "colours: expected a stride above 0 and stride and offset in multiples of 4");
    expectBadView([](MeshView& v) { v.colors.offsetBytes = 8; }, "colours: expected a buffer of");
    expectBadView([](MeshView& v) { v.materialId = 1; }, "expected a material id below 1, found 1");

    const auto expectBadMaterial = [&](auto change, const std::string& text) {
        Material material;
        change(material);
        expectRefused(good, {&material, 1}, testGrid(), ErrorCode::InvalidArgument,
                      "voxelize: material 0: expected " + text);
    };
    expectBadMaterial([](Material& m) { m.absorption = -1.0f; }, "a finite absorption");
    expectBadMaterial([](Material& m) { m.refractiveIndex = 0.5f; }, "a finite refractive index");
    expectBadMaterial([](Material& m) { m.transmission = 1.5f; }, "a transmission in [0,1]");
    expectBadMaterial([](Material& m) { m.color.g = std::nanf(""); }, "a colour in [0,1]");
    const std::vector<Material> tooMany(VolumeVoxelizer::kMaxMaterials + 1);
    expectRefused(good, tooMany, testGrid(), ErrorCode::InvalidArgument, "at most 512 materials");

    DrawSource broken;
    broken.draw = [](const DrawContext&) {};
    expectRefused(broken, {}, testGrid(), ErrorCode::InvalidArgument, "with a vertex stage");
    broken.vertexShader = "// first line\nLaminaVertex laminaVertex() { return missing; }\n";
    expectRefused(broken, {}, testGrid(), ErrorCode::ShaderError, "host vertex stage:2");
    EXPECT_THAT(takeHighSeverityMessages(), testing::Not(testing::IsEmpty())); // the compiler's

    GLint layers = 0;
    gl().GetIntegerv(GL_MAX_FRAMEBUFFER_LAYERS, &layers);
    expectRefused(good, {}, testGrid(static_cast<std::uint32_t>(layers) + 1),
                  ErrorCode::DeviceLimit, "the device's limit is");
    device().setMemoryBudget(device().allocatedBytes() + (20u << 20));
    const auto large = GridTransform::box({{-1, -1, -1}, {1, 1, 1}}, {256, 256, 256}).value();
    expectRefused(good, {}, large, ErrorCode::OutOfMemory, "needs 64 MiB, the memory budget");
    device().setMemoryBudget(0);

    EXPECT_THAT(VolumeGrid::create(device())->download().error().text, HasSubstr("no size"));
    EXPECT_THAT(VolumeGrid::create(device(), {.count = VolumeFormat::RGBA8}).error().text,
                HasSubstr("expected R8 or R32UI for hit counts, found RGBA8"));
    EXPECT_THAT(VolumeGrid::create(device(), {.normal = VolumeFormat::R8}).error().text,
                HasSubstr("expected RGBA8, RGBA16F or RGBA32F for normals, found R8"));
    EXPECT_THAT(VolumeGrid::create(device(), {.count = VolumeFormat::None}).error().text,
                HasSubstr("at least one payload"));
    for (const float overlap : {-0.1f, 1.5f, std::nanf("")})
        EXPECT_THAT(VolumeVoxelizer::create(device(), {.slabOverlap = overlap}).error().text,
                    HasSubstr("expected a slab overlap in [0,1]"));
}

TEST_F(VolumeContractGlTest, ObjectsGiveTheirMemoryBack) {
    const std::uint64_t before = device().allocatedBytes();
    {
        auto buffers = MeshBuffers::upload(device(), kKnot).value();
        auto voxelizer = VolumeVoxelizer::create(device()).value();
        auto volume = VolumeGrid::create(device(), kBytes).value();
        const GeometrySource source = buffers.view();
        ASSERT_TRUE(voxelizer.voxelize({&source, 1}, {}, testGrid(), volume));
        EXPECT_GT(device().allocatedBytes(), before + volume.gpuBytes());
    }
    EXPECT_EQ(device().allocatedBytes(), before);
}

constexpr const char* kQueries = R"(
layout(local_size_x = 64) in;
layout(std430, binding = 0) readonly buffer Points { vec4 points[]; };
struct Answers { ivec4 voxelAndCount; vec4 normal; vec4 color; vec4 opticsAndAbsorption; };
layout(std430, binding = 1) buffer Results { Answers results[]; };
void main() {
    uint i = gl_GlobalInvocationID.x;
    if (i >= uint(points.length()))
        return;
    ivec3 voxel = laminaVolumeVoxelAt(points[i].xyz);
    results[i].voxelAndCount = ivec4(voxel, laminaVolumeCount(voxel));
    results[i].normal = vec4(laminaVolumeNormal(voxel), 0.0);
    results[i].color = vec4(laminaVolumeColor(voxel), 0.0);
    results[i].opticsAndAbsorption = vec4(laminaVolumeOptics(voxel), laminaVolumeAbsorption(voxel),
                                          laminaVolumeAbsorptionNearer(voxel.xy, voxel.z));
}
)";

struct Answers {
    glm::ivec4 voxelAndCount;
    glm::vec4 normal;
    glm::vec4 color;
    glm::vec4 opticsAndAbsorption;
};

TEST_F(VolumeContractGlTest, QueriesEqualTheDownloadedVolume) {
    const std::string source = "#version 450 core\n#define LAMINA_VOLUME_BLOCK_BINDING 3\n"
                               "#define LAMINA_VOLUME_TEXTURE_UNIT 5\n" +
                               shaderSource("lamina/volume.glsl").value() + kQueries;
    const GLuint program = buildProgram({{GL_COMPUTE_SHADER, source}});
    const glm::dmat4 view =
        glm::lookAt(glm::dvec3(1, 2, 3), glm::dvec3(0, 0, 0), glm::dvec3(0, 1, 0));
    const GridTransform grids[] = {
        GridTransform::box({{-1, -1, -1}, {1, 1, 1}}, {33, 40, 27}, Axis::Y).value(),
        GridTransform::camera(GridCamera::perspective(view, 0.8, 1.0, 2.0, 6.0), {40, 40, 50},
                              SliceDistribution::logarithmic())
            .value()};
    auto buffers = MeshBuffers::upload(device(), kKnot).value();
    const GeometrySource mesh = buffers.view();
    Material material;
    material.absorption = 0.3f;
    material.refractiveIndex = 1.4f;
    material.transmission = 0.6f;
    auto voxelizer = VolumeVoxelizer::create(device()).value();
    std::mt19937 random(3);
    std::uniform_real_distribution<float> place(-1.1f, 1.1f);
    std::vector<glm::vec4> points(20000);
    for (glm::vec4& point : points)
        point = {place(random), place(random), place(random), 1.0f};
    for (const VolumeLayout& layout : {kFloats, kHalves, kBytes, VolumeLayout{}})
        for (const GridTransform& transform : grids) {
            auto volume = VolumeGrid::create(device(), layout).value();
            ASSERT_TRUE(voxelizer.voxelize({&mesh, 1}, {&material, 1}, transform, volume));
            const VolumeData host = volume.download().value();
            volume.bind(3, 5);
            std::vector<Answers> answers(points.size());
            runCompute(program, std::as_bytes(std::span(points)),
                       std::as_writable_bytes(std::span(answers)),
                       static_cast<std::uint32_t>(points.size()));
            std::uint64_t hit = 0;
            for (std::size_t p = 0; p < points.size(); ++p) {
                const glm::dvec3 grid = transform.worldToGrid(glm::dvec3(points[p]));
                const auto voxel = transform.voxelAt(glm::dvec3(points[p]));
                // Single precision may choose the other voxel this close to a face.
                const glm::dvec3 toFace = glm::abs(grid - glm::round(grid));
                if (std::min({toFace.x, toFace.y, toFace.z}) < 1e-3)
                    continue;
                ASSERT_EQ(glm::ivec3(answers[p].voxelAndCount),
                          voxel ? glm::ivec3(*voxel) : glm::ivec3(-1));
                if (!voxel)
                    continue;
                const std::size_t i = host.index(*voxel);
                ASSERT_EQ(answers[p].voxelAndCount.w, static_cast<int>(host.counts[i]));
                hit += host.counts[i] != 0 ? 1 : 0;
                if (layout == VolumeLayout{}) {
                    ASSERT_EQ(answers[p].opticsAndAbsorption, glm::vec4(1, 1, 0, 0));
                    continue;
                }
                ASSERT_LT(glm::length(glm::vec3(answers[p].normal) - host.normals[i]), 1e-4f);
                ASSERT_LT(glm::length(glm::vec3(answers[p].color) - host.colors[i]), 1e-4f);
                ASSERT_NEAR(answers[p].opticsAndAbsorption.x, host.optics[i].x, 1e-4);
                ASSERT_NEAR(answers[p].opticsAndAbsorption.y, host.optics[i].y, 1e-4);
                ASSERT_NEAR(answers[p].opticsAndAbsorption.z, host.absorption[i], 1e-4);
                float nearer = 0.0f;
                for (std::uint32_t z = 0; z < voxel->z; ++z)
                    nearer += host.absorption[host.index({voxel->x, voxel->y, z})];
                ASSERT_NEAR(answers[p].opticsAndAbsorption.w, nearer, 1e-3);
            }
            EXPECT_GT(hit, 300u);
        }
    gl().DeleteProgram(program);
}

TEST_F(VolumeContractGlTest, SharedLayoutsMatchTheLinkedProgram) {
    const std::string source = "#version 450 core\n" + shaderSource("lamina/volume.glsl").value() +
                               R"(
layout(local_size_x = 64) in;
layout(std430, binding = 1) buffer Out { float sums[]; };
void main() {
    LaminaVolumeConstants c = laminaVolume.constants;
    sums[0] = c.grid.depthRange.y + float(c.payload.x) + laminaVolume.boundaries[1][2];
})";
    const GLuint program = buildProgram({{GL_COMPUTE_SHADER, source}});
    const auto offsetOf = [&](const char* name) {
        const GLuint index = gl().GetProgramResourceIndex(program, GL_UNIFORM, name);
        EXPECT_NE(index, GL_INVALID_INDEX) << name;
        const GLenum property = GL_OFFSET;
        GLint offset = -1;
        gl().GetProgramResourceiv(program, GL_UNIFORM, index, 1, &property, 1, nullptr, &offset);
        return offset;
    };
    EXPECT_EQ(offsetOf("LaminaVolumeBlock.constants.grid.depthRange"),
              static_cast<GLint>(offsetof(VolumeBlock, constants.grid.depthRange)));
    EXPECT_EQ(offsetOf("LaminaVolumeBlock.constants.payload"),
              static_cast<GLint>(offsetof(VolumeBlock, constants.payload)));
    EXPECT_EQ(offsetOf("LaminaVolumeBlock.boundaries[0]"),
              static_cast<GLint>(offsetof(VolumeBlock, boundaries)));
    gl().DeleteProgram(program);
}

} // namespace
} // namespace lamina
