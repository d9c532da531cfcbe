// lamina/grid.glsl in a host's own shaders gives the answers of BitGrid on the host.

#include "gl/support/gl_test.hpp"

#include <lamina/gl/shaders.hpp>
#include <lamina/grid/voxel_grid.hpp>

#include "grid/grid_constants.hpp"

#include <glm/gtc/matrix_transform.hpp>

#include <algorithm>
#include <cmath>
#include <random>

namespace lamina {
namespace {

constexpr const char* kQueries = R"(
layout(local_size_x = 64) in;
layout(std430, binding = 0) readonly buffer Points { vec4 points[]; };
struct Answers { ivec4 counts; uvec4 bits; vec4 grid; vec2 range; };
layout(std430, binding = 1) buffer Results { Answers results[]; };
uniform int grid;
void main() {
    uint i = gl_GlobalInvocationID.x;
    if (i >= uint(points.length()))
        return;
    vec3 world = points[i].xyz;
    bool inside;
    vec3 place = laminaWorldToGrid(grid, world, inside);
    ivec3 voxel = laminaVoxelOf(grid, place);
    results[i].counts = ivec4(laminaPointSet(grid, world), laminaPointCountNearer(grid, world),
                              laminaCountNearer(grid, voxel.xy, voxel.z), inside);
    results[i].bits = laminaColumnBits(grid, voxel.xy, voxel.z >> 7);
    results[i].grid = vec4(place, float(laminaGridSize(grid).z));
    results[i].range = laminaColumnRange(grid, ivec2(floor(place.xy)));
}
)";

struct Answers {
    glm::ivec4 counts;
    glm::uvec4 bits;
    glm::vec4 grid;
    glm::vec2 range;
    glm::vec2 padding;
};

class GridQueryGlTest : public test::GlTest {
protected:
    BitGrid randomBits(const GridTransform& transform, double density) {
        BitGrid bits = BitGrid::create(transform).value();
        std::bernoulli_distribution set(density);
        const glm::uvec3 size = transform.size();
        for (std::uint32_t z = 0; z < size.z; ++z)
            for (std::uint32_t y = 0; y < size.y; ++y)
                for (std::uint32_t x = 0; x < size.x; ++x)
                    if (set(mRandom))
                        bits.set({x, y, z});
        return bits;
    }

    /// Random bits in random ranges of at least a fifth of the depths; some columns are empty, some
    /// ranges have no extent.
    BitGrid randomLocalBits(const GridTransform& transform, double density) {
        const BitGrid uniform = randomBits(transform, density);
        const auto near = static_cast<float>(transform.nearDepth());
        const float extent = static_cast<float>(transform.farDepth()) - near;
        std::uniform_real_distribution<float> share(0.0f, 1.0f);
        std::vector<ColumnRange> ranges(std::size_t{transform.size().x} * transform.size().y);
        for (ColumnRange& range : ranges) {
            range.near = near + 0.4f * share(mRandom) * extent;
            range.far = range.near + (0.2f + 0.4f * share(mRandom)) * extent;
            const float kind = share(mRandom);
            if (kind < 0.2f)
                range = {};
            else if (kind < 0.3f)
                range.far = range.near;
        }
        BitGrid bits = BitGrid::create(transform, std::move(ranges)).value();
        uniform.forEachSet([&](const glm::uvec3& voxel) {
            if (!bits.columnRange(glm::uvec2(voxel)).isEmpty())
                bits.set(voxel);
        });
        return bits;
    }

    std::mt19937 mRandom{7};
};

GridTransform perspectiveGrid(std::uint32_t slices, const SliceDistribution& distribution) {
    const glm::dmat4 view =
        glm::lookAt(glm::dvec3(1, 2, 3), glm::dvec3(0, 0, 0), glm::dvec3(0, 1, 0));
    return GridTransform::camera(GridCamera::perspective(view, 1.0, 1.25, 0.5, 9.0),
                                 {25, 20, slices}, distribution)
        .value();
}

class GridStoreGlTest : public GridQueryGlTest, public testing::WithParamInterface<VoxelStore> {};
INSTANTIATE_TEST_SUITE_P(Stores, GridStoreGlTest,
                         testing::Values(VoxelStore::Texture, VoxelStore::Buffer),
                         [](const auto& store) { return std::string(name(store.param)); });

TEST_P(GridStoreGlTest, AnswersEqualTheHosts) {
    const bool isBuffer = GetParam() == VoxelStore::Buffer;
    const std::string source = "#version 450 core\n#define LAMINA_GRID_COUNT 2\n"
                               "#define LAMINA_GRID_BUFFER_STORE " +
                               std::to_string(isBuffer) +
                               "\n"
                               "#define LAMINA_GRID_BLOCK_BINDING 3\n"
                               "#define LAMINA_GRID_TEXTURE_UNIT 5\n" +
                               shaderSource("lamina/grid.glsl").value() + kQueries;
    const GLuint program = buildProgram({{GL_COMPUTE_SHADER, source}});
    const std::pair<GridTransform, GridTransform> pairs[] = {
        {GridTransform::box({{-2, -1, 0}, {2, 1, 3}}, {40, 23, 31}, Axis::X).value(),
         perspectiveGrid(300, SliceDistribution::linear())},
        {GridTransform::box({{-2, -1, 0}, {2, 1, 3}}, {13, 33, 129}, Axis::Y).value(),
         perspectiveGrid(128, SliceDistribution::logarithmic())},
        {GridTransform::box({{-2, -1, 0}, {2, 1, 3}}, {9, 7, 4}, Axis::Z,
                            SliceDistribution::custom({0.0f, 0.1f, 0.15f, 0.7f, 1.0f}))
             .value(),
         perspectiveGrid(1, SliceDistribution::linear())},
    };
    for (const auto& [first, second] : pairs) {
        const BitGrid bits[] = {randomBits(first, 0.3), randomBits(second, 0.6)};
        auto gridA = VoxelGrid::create(device(), GetParam()).value();
        auto gridB = VoxelGrid::create(device(), GetParam()).value();
        ASSERT_TRUE(gridA.upload(bits[0]));
        ASSERT_TRUE(gridB.upload(bits[1]));
        ASSERT_TRUE(compare(gridA.download().value(), bits[0])->equal());
        ASSERT_TRUE(compare(gridB.download().value(), bits[1])->equal());
        EXPECT_EQ(gridA.store(), GetParam());
        EXPECT_EQ(gridA.buffer() != 0, isBuffer);
        gridA.bind(3, 5, 0);
        gridB.bind(3, 5, 1);

        constexpr std::size_t kPoints = 20000;
        std::vector<glm::vec4> points(kPoints);
        std::uniform_real_distribution<float> place(-3.5f, 4.0f);
        for (std::size_t i = 0; i < kPoints; ++i)
            points[i] = {place(mRandom), place(mRandom), place(mRandom), 1.0f};
        std::vector<Answers> answers(kPoints);
        for (int index = 0; index < 2; ++index) {
            const BitGrid& host = bits[index];
            const GridTransform& transform = host.transform();
            gl().ProgramUniform1i(program, gl().GetUniformLocation(program, "grid"), index);
            runCompute(program, std::as_bytes(std::span(points)),
                       std::as_writable_bytes(std::span(answers)), kPoints);

            std::size_t inside = 0;
            std::size_t set = 0;
            for (std::size_t i = 0; i < kPoints; ++i) {
                const glm::dvec3 world(points[i]);
                const glm::dvec3 grid = transform.worldToGrid(world);
                // Single precision may choose the other voxel within this distance of a face.
                constexpr double kTolerance = 1e-3;
                const glm::dvec3 size(transform.size());
                const auto isNearFace = [&](double value) {
                    return std::isnan(value) || std::abs(value - std::round(value)) < kTolerance;
                };
                if (isNearFace(grid.x) || isNearFace(grid.y))
                    continue;
                const auto voxel = transform.voxelAt(world);
                if (voxel && isNearFace(grid.z))
                    continue;
                ASSERT_EQ(answers[i].counts.w != 0, voxel.has_value()) << i;
                ASSERT_EQ(answers[i].counts.x != 0, host.at(world)) << i;
                ASSERT_EQ(answers[i].grid.w, size.z);
                if (voxel) {
                    ++inside;
                    set += host.at(world) ? 1 : 0;
                    EXPECT_NEAR(answers[i].grid.x, grid.x, kTolerance);
                    EXPECT_NEAR(answers[i].grid.y, grid.y, kTolerance);
                    EXPECT_NEAR(answers[i].grid.z, grid.z, kTolerance);
                    const std::uint32_t nearer = host.countNearer({voxel->x, voxel->y}, voxel->z);
                    EXPECT_EQ(answers[i].counts.y, static_cast<int>(nearer)) << i;
                    EXPECT_EQ(answers[i].counts.z, static_cast<int>(nearer)) << i;
                    const std::size_t word = host.wordIndex({voxel->x, voxel->y, voxel->z & ~127u});
                    for (std::size_t w = 0; w < 4; ++w)
                        EXPECT_EQ(answers[i].bits[static_cast<int>(w)], host.words()[word + w])
                            << i;
                } else if (grid.x > 0 && grid.x < size.x && grid.y > 0 && grid.y < size.y) {
                    // Before the near depth no voxel is nearer; beyond the far depth all are.
                    const glm::uvec2 column(grid);
                    const double depth = (transform.worldToColumn() * glm::dvec4(world, 1.0)).z;
                    const std::uint32_t expected =
                        depth > transform.farDepth() ? host.countNearer(column, ~0u) : 0u;
                    EXPECT_EQ(answers[i].counts.y, static_cast<int>(expected)) << i;
                } else {
                    EXPECT_EQ(answers[i].counts.y, 0) << i;
                }
            }
            EXPECT_GT(inside, 500u);
            EXPECT_GT(set, 100u);
        }
    }
    gl().DeleteProgram(program);
}

TEST_P(GridStoreGlTest, AnswersWithLocalRangesEqualTheHosts) {
    const std::string source =
        "#version 450 core\n#define LAMINA_GRID_COUNT 3\n"
        "#define LAMINA_GRID_BUFFER_STORE " +
        std::to_string(GetParam() == VoxelStore::Buffer) +
        "\n"
        "#define LAMINA_GRID_LOCAL_RANGES 1\n#define LAMINA_GRID_RANGE_UNIT 4\n" +
        shaderSource("lamina/grid.glsl").value() + kQueries;
    const GLuint program = buildProgram({{GL_COMPUTE_SHADER, source}});
    const BitGrid bits[] = {
        randomLocalBits(GridTransform::box({{-2, -1, 0}, {2, 1, 3}}, {9, 7, 200}, Axis::X).value(),
                        0.3),
        // A grid without, between two with local ranges.
        randomBits(perspectiveGrid(128, SliceDistribution::logarithmic()), 0.6),
        randomLocalBits(perspectiveGrid(300, SliceDistribution::logarithmic()), 0.5),
    };
    std::vector<VoxelGrid> grids;
    for (std::uint32_t i = 0; i < 3; ++i) {
        grids.push_back(VoxelGrid::create(device(), GetParam()).value());
        ASSERT_TRUE(grids[i].upload(bits[i]));
        EXPECT_EQ(grids[i].hasLocalRanges(), i != 1);
        EXPECT_EQ(grids[i].rangeTexture() != 0, i != 1);
        const BitGrid back = grids[i].download().value();
        EXPECT_TRUE(compare(back, bits[i])->equal());
        EXPECT_TRUE(std::ranges::equal(back.ranges(), bits[i].ranges()));
        grids[i].bind(0, 0, i, 4);
    }
    constexpr std::size_t kPoints = 20000;
    std::vector<glm::vec4> points(kPoints);
    std::uniform_real_distribution<float> place(-3.5f, 4.0f);
    for (glm::vec4& point : points)
        point = {place(mRandom), place(mRandom), place(mRandom), 1.0f};
    std::vector<Answers> answers(kPoints);
    for (int index = 0; index < 3; ++index) {
        const BitGrid& host = bits[index];
        const GridTransform& transform = host.transform();
        const double extent = transform.farDepth() - transform.nearDepth();
        gl().ProgramUniform1i(program, gl().GetUniformLocation(program, "grid"), index);
        runCompute(program, std::as_bytes(std::span(points)),
                   std::as_writable_bytes(std::span(answers)), kPoints);
        std::size_t inside = 0;
        std::size_t empty = 0;
        std::size_t beyond = 0;
        for (std::size_t i = 0; i < kPoints; ++i) {
            const glm::dvec3 world(points[i]);
            const glm::dvec3 grid = transform.worldToGrid(world);
            const auto column = transform.columnAt(world);
            // Single precision may choose another voxel within this distance of a face.
            constexpr double kTolerance = 5e-3;
            const auto isNearFace = [&](double value) {
                return std::isnan(value) || std::abs(value - std::round(value)) < kTolerance;
            };
            if (isNearFace(grid.x) || isNearFace(grid.y))
                continue;
            if (!column) {
                EXPECT_EQ(answers[i].counts.x + answers[i].counts.y + answers[i].counts.w, 0) << i;
                continue;
            }
            const ColumnRange range = host.columnRange(column->column);
            ASSERT_EQ(answers[i].range, glm::vec2(range.near, range.far)) << i;
            if (std::min(std::abs(column->depth - range.near),
                         std::abs(column->depth - range.far)) < 1e-5 * extent)
                continue;
            const auto voxel = host.voxelAt(world);
            double slice = 0.0;
            if (voxel) {
                slice = host.hasLocalRanges() ? transform.sliceCoordinate(column->depth, range)
                                              : transform.sliceCoordinate(column->depth);
                if (isNearFace(slice))
                    continue;
                EXPECT_NEAR(answers[i].grid.z, slice, kTolerance) << i;
            }
            ASSERT_EQ(answers[i].counts.w != 0, voxel.has_value()) << i;
            ASSERT_EQ(answers[i].counts.x != 0, host.at(world)) << i;
            ASSERT_EQ(answers[i].counts.y, static_cast<int>(host.countNearer(world))) << i;
            inside += voxel ? 1 : 0;
            empty += range.isEmpty() ? 1 : 0;
            beyond += !range.isEmpty() && column->depth > range.far ? 1 : 0;
        }
        EXPECT_GT(inside, 300u);
        EXPECT_GT(beyond, index == 1 ? 0u : 100u);
        EXPECT_EQ(empty > 100u, index != 1);
    }
    gl().DeleteProgram(program);
}

TEST_F(GridQueryGlTest, MasksBelowEveryBit) {
    const std::string source =
        "#version 450 core\n" + shaderSource("lamina/grid.glsl").value() + R"(
layout(local_size_x = 64) in;
layout(std430, binding = 0) readonly buffer In { int bits[]; };
layout(std430, binding = 1) buffer Out { uvec4 masks[]; };
void main() {
    uint i = gl_GlobalInvocationID.x;
    if (i < uint(bits.length()))
        masks[i] = laminaMaskBelow(bits[i]);
})";
    const GLuint program = buildProgram({{GL_COMPUTE_SHADER, source}});
    std::vector<int> bits;
    for (int bit = -5; bit <= 140; ++bit)
        bits.push_back(bit);
    std::vector<glm::uvec4> masks(bits.size());
    runCompute(program, std::as_bytes(std::span(bits)), std::as_writable_bytes(std::span(masks)),
               static_cast<std::uint32_t>(bits.size()));
    for (std::size_t i = 0; i < bits.size(); ++i)
        for (int bit = 0; bit < 128; ++bit)
            ASSERT_EQ((masks[i][bit / 32] >> (bit % 32)) & 1u, bit < bits[i] ? 1u : 0u)
                << "below " << bits[i] << ", bit " << bit;
    gl().DeleteProgram(program);
}

TEST_F(GridQueryGlTest, SharedLayoutsMatchTheLinkedProgram) {
    const std::string source =
        "#version 450 core\n" + shaderSource("lamina/grid.glsl").value() + R"(
layout(local_size_x = 64) in;
layout(std430, binding = 1) buffer Out { float sums[]; };
void main() {
    LaminaGridConstants c = laminaGrid[0].constants;
    sums[0] = c.worldToColumn[2].x + c.depthRange.y + float(c.size.w) + laminaGrid[0].boundaries[1][2];
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
    EXPECT_EQ(offsetOf("LaminaGridBlock.constants.worldToColumn[0]"),
              static_cast<GLint>(offsetof(GridBlock, constants.worldToColumn)));
    EXPECT_EQ(offsetOf("LaminaGridBlock.constants.depthRange"),
              static_cast<GLint>(offsetof(GridBlock, constants.depthRange)));
    EXPECT_EQ(offsetOf("LaminaGridBlock.constants.size"),
              static_cast<GLint>(offsetof(GridBlock, constants.size)));
    EXPECT_EQ(offsetOf("LaminaGridBlock.boundaries[0]"),
              static_cast<GLint>(offsetof(GridBlock, boundaries)));
    const GLuint block =
        gl().GetProgramResourceIndex(program, GL_UNIFORM_BLOCK, "LaminaGridBlock[0]");
    ASSERT_NE(block, GL_INVALID_INDEX);
    const GLenum property = GL_BUFFER_DATA_SIZE;
    GLint size = 0;
    gl().GetProgramResourceiv(program, GL_UNIFORM_BLOCK, block, 1, &property, 1, nullptr, &size);
    EXPECT_EQ(size, static_cast<GLint>(sizeof(GridBlock)));
    gl().DeleteProgram(program);
}

} // namespace
} // namespace lamina
