// The two counts of lamina/volume_integral.glsl against the rules, one voxel at a time.

#include "gl/support/gl_test.hpp"
#include "refraction/evaluation_table.hpp"

#include <lamina/gl/shaders.hpp>

#include <reference/volume_integral.hpp>

namespace lamina {
namespace {

// Pairs of masks by index, the same as makePair() below; 64 a group, two dimensions of groups.
constexpr const char* kProgram = R"(
layout(local_size_x = 64) in;
layout(binding = 0) uniform sampler2D table;
layout(location = 0) uniform uint words;
layout(location = 1) uniform uint first;
layout(std430, binding = 1) buffer Results { uvec2 results[]; };

uint hash(uint x) {
    x ^= x >> 16;
    x *= 0x7feb352du;
    x ^= x >> 15;
    x *= 0x846ca68bu;
    return x ^ x >> 16;
}

// Bits that are set with probability 1/2, 1/4, 1/8 or 1/16.
uint mask(uint seed) {
    uint bits = hash(4u * seed);
    uint count = hash(seed ^ 0x9e3779b9u) & 3u;
    for (uint i = 1u; i <= count; ++i)
        bits &= hash(4u * seed + i);
    return bits;
}

void main() {
    uint index = (gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x) * 64u + gl_LocalInvocationID.x;
    LaminaIntegral direct = laminaIntegralBegin();
    LaminaTableIntegral looked = laminaTableIntegralBegin();
    for (uint word = 0u; word < words; ++word) {
        uint pair = (first + index) * words + word;
        uint front = mask(2u * pair);
        uint back = mask(2u * pair + 1u);
        if (words == 1u && first == 0xffff0000u) { // Every pair of 8-bit masks.
            front = index & 255u;
            back = index >> 8u;
        }
        laminaIntegralAdd(direct, front, back, 32);
        for (uint i = 0u; i < 32u; i += 8u) {
            uvec2 bytes = uvec2(front, back) >> i & 255u;
            ivec4 entry = ivec4(texelFetch(table, ivec2(bytes), 0) * 255.0 + 0.5);
            laminaIntegralAddEntry(looked, entry, bytes.x, bytes.y);
        }
    }
    results[index] = uvec2(laminaIntegralCount(direct) | (laminaIntegralIsClosed(direct) ? 1 << 16 : 0) |
                               (direct.isAmbiguous ? 1 << 17 : 0),
                           laminaIntegralCount(looked));
}
)";

constexpr std::uint32_t kAllBytes = 0xffff0000u;

std::uint32_t hash(std::uint32_t x) {
    x ^= x >> 16;
    x *= 0x7feb352du;
    x ^= x >> 15;
    x *= 0x846ca68bu;
    return x ^ x >> 16;
}

std::uint32_t mask(std::uint32_t seed) {
    std::uint32_t bits = hash(4 * seed);
    const std::uint32_t count = hash(seed ^ 0x9e3779b9u) & 3u;
    for (std::uint32_t i = 1; i <= count; ++i)
        bits &= hash(4 * seed + i);
    return bits;
}

class VolumeIntegralGlTest : public test::GlTest {
protected:
    void SetUp() override {
        GlTest::SetUp();
        mProgram =
            buildProgram({{GL_COMPUTE_SHADER,
                           "#version 450 core\n" +
                               shaderSource("lamina/volume_integral.glsl").value() + kProgram}});
        mTable = gl::Texture::create(device().state(), "table", GL_TEXTURE_2D);
        gl().TextureStorage2D(mTable.id(), 1, GL_RGBA8, 256, 256);
        const auto texels = makeEvaluationTable();
        gl().TextureSubImage2D(mTable.id(), 0, 0, 0, 256, 256, GL_RGBA, GL_UNSIGNED_BYTE,
                               texels.data());
        gl().TextureParameteri(mTable.id(), GL_TEXTURE_MIN_FILTER, GL_NEAREST);
    }
    void TearDown() override {
        gl().DeleteProgram(mProgram);
        mTable = {};
        GlTest::TearDown();
    }

    /// Counts `count` columns (a multiple of 64) of `words` pairs of masks each.
    void expectCounts(std::uint32_t count, std::uint32_t words, std::uint32_t first) {
        std::vector<glm::uvec2> results(count);
        const auto bytes = static_cast<GLsizeiptr>(count * sizeof(glm::uvec2));
        GLuint buffer = 0;
        gl().CreateBuffers(1, &buffer);
        gl().NamedBufferData(buffer, bytes, nullptr, GL_DYNAMIC_READ);
        gl().BindBufferBase(GL_SHADER_STORAGE_BUFFER, 1, buffer);
        gl().BindTextureUnit(0, mTable.id());
        gl().UseProgram(mProgram);
        gl().ProgramUniform1ui(mProgram, 0, words);
        gl().ProgramUniform1ui(mProgram, 1, first);
        const std::uint32_t groups = count / 64;
        const std::uint32_t rows = (groups + 32767) / 32768;
        ASSERT_EQ(groups % rows, 0u);
        gl().DispatchCompute(groups / rows, rows, 1);
        gl().MemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
        gl().GetNamedBufferSubData(buffer, 0, bytes, results.data());
        gl().UseProgram(0);
        gl().DeleteBuffers(1, &buffer);

        std::vector<reference::Facing> column(32 * std::size_t{words});
        std::size_t wrongDirect = 0, wrongTable = 0, wrongFlags = 0;
        std::size_t closed = 0;
        for (std::uint32_t i = 0; i < count; ++i) {
            bool isAmbiguous = false;
            for (std::uint32_t word = 0; word < words; ++word) {
                const std::uint32_t pair = (first + i) * words + word;
                std::uint32_t front = mask(2 * pair);
                std::uint32_t back = mask(2 * pair + 1);
                if (words == 1 && first == kAllBytes) {
                    front = i & 255u;
                    back = i >> 8;
                }
                isAmbiguous |= (front & back) != 0;
                for (std::uint32_t bit = 0; bit < 32; ++bit)
                    column[32 * word + bit] = static_cast<reference::Facing>(
                        (front >> bit & 1u) + 2 * (back >> bit & 1u));
            }
            const unsigned expected = reference::countInner(column);
            const bool isClosed = reference::looksClosed(column);
            closed += isClosed ? 1 : 0;
            wrongDirect += (results[i].x & 0xffffu) != expected ? 1 : 0;
            wrongTable += results[i].y != expected ? 1 : 0;
            wrongFlags += results[i].x >> 16 != (isClosed ? 1u : 0u) + (isAmbiguous ? 2u : 0u);
        }
        EXPECT_EQ(wrongDirect, 0u);
        EXPECT_EQ(wrongTable, 0u);
        EXPECT_EQ(wrongFlags, 0u);
        EXPECT_GT(closed, count / 100) << "the masks must try both kinds";
        EXPECT_LT(closed, count);
    }

private:
    GLuint mProgram = 0;
    gl::Texture mTable;
};

TEST_F(VolumeIntegralGlTest, EveryPairOfEightBitMasks) {
    expectCounts(1u << 16, 1, kAllBytes);
}

TEST_F(VolumeIntegralGlTest, TenMillionRandomPairs) {
    expectCounts(10'240'000, 1, 0);
}

TEST_F(VolumeIntegralGlTest, RandomColumnsOf128And1024Slices) {
    expectCounts(1u << 17, 4, 77);
    expectCounts(1u << 13, 32, 5);
}

} // namespace
} // namespace lamina
