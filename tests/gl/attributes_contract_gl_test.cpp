// Every kind of source and material reaches voxel attributes; queries in GLSL; errors; GL state.

#include "gl/support/gl_state.hpp"
#include "gl/support/gl_test.hpp"
#include "gl/support/grids.hpp"
#include "gl/support/sources.hpp"

#include <lamina/gl/shaders.hpp>
#include <lamina/grid/attribute_grid.hpp>
#include <lamina/voxelize/attribute_voxelizer.hpp>
#include <lamina/voxelize/voxelizer.hpp>

#include <reference/shapes.hpp>

#include <glm/geometric.hpp>
#include <gmock/gmock.h>

#include <random>

namespace lamina {
namespace {

namespace ref = reference;
using test::testGrid;
using testing::AllOf;
using testing::HasSubstr;

/// Colour by position and normals off the faces'.
TriangleMesh painted(TriangleMesh mesh) {
    for (const glm::vec3& p : mesh.positions) {
        mesh.colors.emplace_back(glm::clamp(0.5f + 0.5f * p, 0.0f, 1.0f), 1.0f);
        mesh.normals.push_back(glm::normalize(p + glm::vec3(0.1f, 0.2f, 0.3f)));
    }
    return mesh;
}

const TriangleMesh kKnot = painted(test::makeKnot());

bool operator==(const AttributeGrid& a, const AttributeGrid& b) {
    return a.colors == b.colors && a.normals == b.normals && a.hits == b.hits &&
           a.materials == b.materials;
}

class AttributesContractGlTest : public test::GlTest {
protected:
    VoxelGrid voxels(std::span<const GeometrySource> sources, const GridTransform& transform) {
        auto voxelizer = Voxelizer::create(device(), {.coverage = Coverage::Conservative}).value();
        auto grid = VoxelGrid::create(device()).value();
        EXPECT_TRUE(voxelizer->voxelize(sources, transform, grid));
        return grid;
    }

    AttributeGrid attributes(std::span<const GeometrySource> sources,
                             std::span<const Material> materials = {}) {
        const VoxelGrid grid = voxels(sources, testGrid());
        auto out = VoxelAttributes::create(device()).value();
        auto voxelizer = AttributeVoxelizer::create(device()).value();
        const auto stats = voxelizer.voxelize(sources, materials, grid, out);
        EXPECT_TRUE(stats) << stats.error().text;
        return out.download().value();
    }
    AttributeGrid attributes(const GeometrySource& source,
                             std::span<const Material> materials = {}) {
        return attributes({&source, 1}, materials);
    }
};

TEST_F(AttributesContractGlTest, SourcesOfEveryLayoutGiveTheSame) {
    auto buffers = MeshBuffers::upload(device(), kKnot).value();
    const MeshView plain = buffers.view();
    const AttributeGrid right = attributes(plain);
    ASSERT_GT(right.colors.size(), 1000u);

    // Interleaved, not indexed, larger than a chunk's alignment at odd offsets.
    struct Vertex {
        glm::vec3 normal, position;
        glm::vec4 color;
        float unused;
    };
    std::vector<Vertex> soup(1);
    std::vector<std::uint16_t> indices;
    for (const glm::uvec3& triangle : kKnot.triangles)
        for (int i = 0; i < 3; ++i) {
            const std::uint32_t v = triangle[i];
            soup.push_back({kKnot.normals[v], kKnot.positions[v], kKnot.colors[v], 0.0f});
            indices.push_back(static_cast<std::uint16_t>(v));
        }
    MeshView interleaved;
    interleaved.vertexBuffer = hostBuffer(std::as_bytes(std::span(soup)));
    interleaved.vertexStrideBytes = sizeof(Vertex);
    interleaved.positionOffsetBytes = sizeof(Vertex) + offsetof(Vertex, position);
    interleaved.vertexCount = static_cast<std::uint32_t>(soup.size() - 1);
    interleaved.normals = {interleaved.vertexBuffer, sizeof(Vertex) + offsetof(Vertex, normal),
                           sizeof(Vertex)};
    interleaved.colors = {interleaved.vertexBuffer, sizeof(Vertex) + offsetof(Vertex, color),
                          sizeof(Vertex)};
    EXPECT_TRUE(attributes(interleaved) == right);

    // An odd number of 16-bit indices cannot be read as storage: captured.
    indices.insert(indices.begin(), std::uint16_t{0});
    ASSERT_EQ(indices.size() % 2, 1u);
    MeshView captured = plain;
    captured.indexBuffer = hostBuffer(std::as_bytes(std::span(indices)));
    captured.indexType = IndexType::UInt16;
    captured.indexOffsetBytes = 2;
    EXPECT_TRUE(attributes(captured) == right);

    // The host's own vertex stage, of known and of unknown size.
    GLuint vertexArray = 0;
    gl().CreateVertexArrays(1, &vertexArray);
    const auto attribute = [&](GLuint location, GLint size, std::size_t offset) {
        gl().EnableVertexArrayAttrib(vertexArray, location);
        gl().VertexArrayAttribFormat(vertexArray, location, size, GL_FLOAT, GL_FALSE,
                                     static_cast<GLuint>(offset));
        gl().VertexArrayAttribBinding(vertexArray, location, 0);
    };
    attribute(0, 3, offsetof(Vertex, position));
    attribute(1, 3, offsetof(Vertex, normal));
    attribute(2, 4, offsetof(Vertex, color));
    gl().VertexArrayVertexBuffer(vertexArray, 0, interleaved.vertexBuffer, sizeof(Vertex),
                                 sizeof(Vertex));
    DrawSource drawn;
    drawn.vertexShader = R"(
        layout(location = 0) in vec3 position;
        layout(location = 1) in vec3 normal;
        layout(location = 2) in vec4 color;
        LaminaVertex laminaVertex() {
            laminaVertexColor = color;
            return LaminaVertex(position, normal, 0u);
        })";
    drawn.draw = [&](const DrawContext&) {
        gl().BindVertexArray(vertexArray);
        gl().DrawArrays(GL_TRIANGLES, 0, static_cast<GLsizei>(soup.size() - 1));
    };
    EXPECT_TRUE(attributes(drawn) == right);
    drawn.maxTriangles = kKnot.triangles.size();
    EXPECT_TRUE(attributes(drawn) == right);
    gl().DeleteVertexArrays(1, &vertexArray);
}

TEST_F(AttributesContractGlTest, ByteColoursMaterialsAndDefaults) {
    TriangleMesh plane = ref::makePlane({0, 0, 0.01f}, {0, 0, 1}, 1.0f);
    auto buffers = MeshBuffers::upload(device(), plane).value();
    MeshView view = buffers.view();
    const Material materials[] = {{.color = {1, 0.5f, 0.25f, 1}}, {.color = {0, 1, 1, 0.2f}}};
    // White without colours, times the material's.
    view.materialId = 1;
    AttributeGrid found = attributes(view, materials);
    for (std::size_t i = 0; i < found.colors.size(); ++i) {
        EXPECT_EQ(found.colors[i], glm::u8vec4(0, 255, 255, 51));
        EXPECT_EQ(found.materials[i], 1u);
        EXPECT_NEAR(found.normals[i].z, 1.0f, 1e-4f); // the face's own
    }
    EXPECT_EQ(attributes(view, std::span(materials).first(2)).colors, found.colors);
    // Bytes: 200/255 times 1, 0.5, 0.25.
    const std::vector<std::uint32_t> bytes(plane.positions.size(), 0x80c8c8c8u);
    view.materialId = 0;
    view.colors = {hostBuffer(std::as_bytes(std::span(bytes))), 0, 4};
    view.colorFormat = VertexColorFormat::UNorm8;
    found = attributes(view, materials);
    EXPECT_THAT(found.colors, testing::Each(glm::u8vec4(200, 100, 50, 128)));
}

TEST_F(AttributesContractGlTest, TheLargestPartGivesTheMaterial) {
    // In the voxel at the origin, material 2 has the larger part and fewer triangles.
    auto large = MeshBuffers::upload(device(), ref::makePlane({0, 0, 0.01f}, {0, 0, 1}, 4.0f));
    auto small =
        MeshBuffers::upload(device(), ref::makePlane({0.01f, 0.01f, 0.02f}, {0, 0, 1}, 0.01f, 8));
    MeshView first = small->view(), second = large->view();
    first.materialId = 1;
    second.materialId = 2;
    const std::vector<Material> materials(3);
    const GeometrySource sources[] = {first, second};
    const AttributeGrid found = attributes(sources, materials);
    EXPECT_THAT(found.materials, testing::Each(2u));
    EXPECT_GE(*std::ranges::max_element(found.hits), 128u);
}

constexpr const char* kQueries = R"(
layout(local_size_x = 64) in;
layout(std430, binding = 0) readonly buffer Voxels { ivec4 voxels[]; };
struct Answer { vec4 color; vec4 normal; uvec4 counts; };
layout(std430, binding = 1) buffer Answers { Answer answers[]; };
void main() {
    uint i = gl_GlobalInvocationID.x;
    if (i >= uint(voxels.length()))
        return;
    LaminaAttributes a = laminaVoxelAttributes(voxels[i].xyz);
    LaminaAttributes b = laminaPointAttributes((vec3(voxels[i].xyz) + 0.5) / vec3(48, 40, 300) * 2.0 - 1.0);
    answers[i].color = a.color;
    answers[i].normal = vec4(a.normal, distance(a.normal, b.normal) + distance(a.color, b.color));
    answers[i].counts = uvec4(a.hits, a.material, laminaVoxelRank(voxels[i].xyz), b.hits);
}
)";

TEST_F(AttributesContractGlTest, ShaderQueriesEqualTheHosts) {
    const GridTransform transform = testGrid(300);
    auto buffers = MeshBuffers::upload(device(), kKnot).value();
    const GeometrySource source = buffers.view();
    const BitGrid bits = voxels({&source, 1}, transform).download().value();
    const BitRank rank = BitRank::create(bits).value();
    EXPECT_EQ(rank.count(), bits.count());
    for (const VoxelStore store : {VoxelStore::Texture, VoxelStore::Buffer}) {
        auto grid = VoxelGrid::create(device(), store).value();
        ASSERT_TRUE(grid.upload(bits));
        auto out = VoxelAttributes::create(device()).value();
        auto voxelizer = AttributeVoxelizer::create(device()).value();
        ASSERT_TRUE(voxelizer.voxelize({&source, 1}, {}, grid, out));
        const AttributeGrid host = out.download().value();

        const std::string text = "#version 450 core\n#define LAMINA_GRID_COUNT 2\n"
                                 "#define LAMINA_GRID_TEXTURE_UNIT 3\n"
                                 "#define LAMINA_ATTRIBUTES_GRID 1\n"
                                 "#define LAMINA_ATTRIBUTES_TEXTURE_UNIT 6\n"
                                 "#define LAMINA_GRID_BUFFER_STORE " +
                                 std::to_string(static_cast<int>(store)) + "\n" +
                                 shaderSource("lamina/attributes.glsl").value() + kQueries;
        const GLuint program = buildProgram({{GL_COMPUTE_SHADER, text}});
        grid.bind(0, 3, 1);
        out.bind(6);
        std::vector<glm::ivec4> asked;
        std::mt19937 random(3);
        for (int i = 0; i < 20000; ++i)
            asked.emplace_back(int(random() % 50) - 1, int(random() % 42) - 1,
                               int(random() % 302) - 1, 0);
        bits.forEachSet([&](const glm::uvec3& voxel) {
            if (asked.size() < 60000)
                asked.emplace_back(voxel, 0);
        });
        struct Answer {
            glm::vec4 color, normal;
            glm::uvec4 counts;
        };
        std::vector<Answer> answers(asked.size());
        runCompute(program, std::as_bytes(std::span(asked)),
                   std::as_writable_bytes(std::span(answers)),
                   static_cast<std::uint32_t>(asked.size()));
        std::size_t wrong = 0, set = 0;
        for (std::size_t i = 0; i < asked.size(); ++i) {
            const glm::ivec3 voxel(asked[i]);
            const Answer& answer = answers[i];
            const bool isSet = glm::all(glm::greaterThanEqual(voxel, glm::ivec3(0))) &&
                               glm::all(glm::lessThan(voxel, glm::ivec3(transform.size()))) &&
                               bits.test(glm::uvec3(voxel));
            if (!isSet) {
                wrong += answer.counts.x != 0 || answer.counts.z != ~0u ||
                         answer.color != glm::vec4(0.0f);
                continue;
            }
            ++set;
            const std::size_t index = rank(glm::uvec3(voxel));
            wrong += answer.counts.z != index || answer.counts.x != host.hits[index] ||
                     answer.counts.y != host.materials[index] ||
                     answer.counts.w != host.hits[index] || answer.normal.w > 1e-6f ||
                     glm::distance(answer.color * 255.0f, glm::vec4(host.colors[index])) > 1e-3f ||
                     glm::distance(glm::vec3(answer.normal), host.normals[index]) > 1e-5f;
        }
        EXPECT_EQ(wrong, 0u) << name(store);
        EXPECT_GT(set, 10000u);
        gl().DeleteProgram(program);
    }
}

TEST_F(AttributesContractGlTest, RoomThatIsGivenIsKeptAndItsLackReported) {
    auto buffers = MeshBuffers::upload(device(), kKnot).value();
    const GeometrySource source = buffers.view();
    const VoxelGrid grid = voxels({&source, 1}, testGrid());
    const auto count = static_cast<std::uint32_t>(grid.download()->count());
    auto voxelizer = AttributeVoxelizer::create(device()).value();
    const AttributeGrid right = attributes(source);

    auto enough = VoxelAttributes::create(device(), {.maxVoxels = count + 100}).value();
    const auto stats = voxelizer.voxelize({&source, 1}, {}, grid, enough);
    ASSERT_TRUE(stats);
    EXPECT_EQ(stats->voxels, count + 100);
    EXPECT_TRUE(enough.download().value() == right);
    EXPECT_EQ(stats->attributeBytes, enough.gpuBytes());

    auto tight = VoxelAttributes::create(device(), {.maxVoxels = count - 1}).value();
    ASSERT_TRUE(voxelizer.voxelize({&source, 1}, {}, grid, tight));
    const auto failed = tight.download();
    ASSERT_FALSE(failed);
    EXPECT_EQ(failed.error().code, ErrorCode::DeviceLimit);
    EXPECT_THAT(failed.error().text,
                AllOf(HasSubstr(std::to_string(count - 1)), HasSubstr(std::to_string(count))));
}

TEST_F(AttributesContractGlTest, ReuseAcrossFramesAllocatesOnlyForMore) {
    auto buffers = MeshBuffers::upload(device(), kKnot).value();
    auto voxelizer = AttributeVoxelizer::create(device()).value();
    auto out = VoxelAttributes::create(device()).value();
    const GeometrySource large = buffers.view();
    const GeometrySource small = buffers.view(glm::mat4(glm::mat3(0.4f)));
    const VoxelGrid largeGrid = voxels({&large, 1}, testGrid());
    const VoxelGrid smallGrid = voxels({&small, 1}, testGrid());
    ASSERT_TRUE(voxelizer.voxelize({&large, 1}, {}, largeGrid, out));
    const std::uint64_t before = device().allocatedBytes();
    ASSERT_TRUE(voxelizer.voxelize({&small, 1}, {}, smallGrid, out));
    EXPECT_TRUE(out.download().value() == attributes(small));
    ASSERT_TRUE(voxelizer.voxelize({&large, 1}, {}, largeGrid, out));
    EXPECT_EQ(device().allocatedBytes(), before);
    EXPECT_TRUE(out.download().value() == attributes(large));
    // Nothing drawn, nothing set.
    const VoxelGrid empty = voxels({}, testGrid());
    ASSERT_TRUE(voxelizer.voxelize({}, {}, empty, out));
    EXPECT_TRUE(out.download()->colors.empty());
}

TEST_F(AttributesContractGlTest, ErrorsSayWhatWasExpected) {
    auto buffers = MeshBuffers::upload(device(), kKnot).value();
    const GeometrySource source = buffers.view();
    auto voxelizer = AttributeVoxelizer::create(device()).value();
    auto out = VoxelAttributes::create(device()).value();
    const auto expectError = [&](const Result<AttributeStats>& result, ErrorCode code,
                                 const char* text) {
        ASSERT_FALSE(result);
        EXPECT_EQ(result.error().code, code) << result.error().text;
        EXPECT_THAT(result.error().text, HasSubstr(text));
    };
    EXPECT_THAT(out.download().error().text, HasSubstr("AttributeVoxelizer::voxelize()"));
    auto none = VoxelGrid::create(device()).value();
    expectError(voxelizer.voxelize({&source, 1}, {}, none, out), ErrorCode::InvalidArgument,
                "expected voxels, found a grid of no size");

    auto perspective = VoxelGrid::create(device()).value();
    ASSERT_TRUE(perspective.resize(
        GridTransform::camera(GridCamera::perspective(glm::dmat4(1.0), 1.0, 1.0, 0.5, 9.0),
                              {8, 8, 8})
            .value()));
    expectError(voxelizer.voxelize({&source, 1}, {}, perspective, out), ErrorCode::Unsupported,
                "use VolumeVoxelizer");

    auto uneven = VoxelGrid::create(device()).value();
    ASSERT_TRUE(uneven.resize(GridTransform::box({{-1, -1, -1}, {1, 1, 1}}, {8, 8, 2}, Axis::Z,
                                                 SliceDistribution::custom({0, 0.25f, 1}))
                                  .value()));
    expectError(voxelizer.voxelize({&source, 1}, {}, uneven, out), ErrorCode::Unsupported,
                "linear slices, found ");
    expectError(voxelizer.voxelize({&source, 1}, {}, uneven, out), ErrorCode::Unsupported,
                "use VolumeVoxelizer");

    auto local = VoxelGrid::create(device()).value();
    ASSERT_TRUE(local.resize(testGrid(), VoxelStore::Texture, SliceRanges::Local));
    expectError(voxelizer.voxelize({&source, 1}, {}, local, out), ErrorCode::Unsupported,
                "BitGrid::toUniform()");

    const VoxelGrid grid = voxels({&source, 1}, testGrid());
    MeshView bad = buffers.view();
    bad.materialId = 7;
    const GeometrySource badMaterial = bad;
    expectError(voxelizer.voxelize({&badMaterial, 1}, {}, grid, out), ErrorCode::InvalidArgument,
                "expected a material id below 1, found 7");
    bad = buffers.view();
    bad.colors.strideBytes = 1u << 10u;
    const GeometrySource badColors = bad;
    expectError(voxelizer.voxelize({&badColors, 1}, {}, grid, out), ErrorCode::InvalidArgument,
                "source 0: colours");
    device().setMemoryBudget(device().allocatedBytes() + 1000);
    expectError(voxelizer.voxelize({&source, 1}, {}, grid, out), ErrorCode::OutOfMemory, "memory");
    device().setMemoryBudget(0);
    EXPECT_TRUE(voxelizer.voxelize({&source, 1}, {}, grid, out));
}

TEST_F(AttributesContractGlTest, EveryCallRestoresTheState) {
    const AttributeGrid right = [&] {
        auto buffers = MeshBuffers::upload(device(), kKnot).value();
        return attributes(buffers.view());
    }();
    const test::OddGlState odd(gl());
    auto buffers = MeshBuffers::upload(device(), kKnot).value();
    MeshView captured = buffers.view();
    DrawSource drawn;
    drawn.vertexShader = "LaminaVertex laminaVertex() { return LaminaVertex(vec3(gl_VertexID), "
                         "vec3(0), 0u); }";
    drawn.draw = [](const DrawContext&) {};
    for (const bool isDrawn : {false, true}) {
        const std::vector<GeometrySource> sources =
            isDrawn ? std::vector<GeometrySource>{captured, drawn}
                    : std::vector<GeometrySource>{captured};
        for (const VoxelStore store : {VoxelStore::Texture, VoxelStore::Buffer}) {
            auto grid = VoxelGrid::create(device(), store).value();
            ASSERT_TRUE(grid.upload(voxels({sources.data(), 1}, testGrid()).download().value()));
            std::optional<AttributeVoxelizer> voxelizer;
            std::optional<VoxelAttributes> out;
            std::optional<AttributeGrid> data;
            expectUnchanged("create", [&] {
                voxelizer.emplace(AttributeVoxelizer::create(device()).value());
                out.emplace(VoxelAttributes::create(device()).value());
            });
            expectUnchanged("voxelize",
                            [&] { ASSERT_TRUE(voxelizer->voxelize(sources, {}, grid, *out)); });
            expectUnchanged("download", [&] { data = out->download().value(); });
            EXPECT_TRUE(*data == right);
            expectUnchanged("destruction", [&] {
                out.reset();
                voxelizer.reset();
            });
        }
    }
}

} // namespace
} // namespace lamina
