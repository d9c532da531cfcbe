// lamina/epipolar.glsl in a host's own shaders gives the answers of EpipolarBits on the host, and
// the segmented scan those of a serial OR.

#include "gl/support/gl_test.hpp"
#include "voxelize/epipolar_constants.hpp"

#include <lamina/gl/shaders.hpp>
#include <lamina/voxelize/epipolar_voxelizer.hpp>

#include <glm/gtc/matrix_transform.hpp>

#include <cmath>
#include <random>

namespace lamina {
namespace {

constexpr const char* kQueries = R"(
layout(local_size_x = 64) in;
layout(std430, binding = 0) readonly buffer Points { vec4 points[]; };
struct Answers { vec4 values; vec4 coordinates; };
layout(std430, binding = 1) buffer Results { Answers results[]; };
void main() {
    uint i = gl_GlobalInvocationID.x;
    if (i >= uint(points.length()))
        return;
    vec3 world = points[i].xyz;
    int vsv = int(points[i].w);
    results[i].values = vec4(laminaEpipolarLit(vsv, world), laminaEpipolarLitInterpolated(vsv, world),
                             laminaEpipolarShadowedFraction(vsv, world),
                             laminaEpipolarShadowedFractionInterpolated(vsv, world));
    results[i].coordinates = vec4(laminaEpipolarCoordinates(vsv, world), 0.0);
})";

struct Answers {
    glm::vec4 values;
    glm::vec4 coordinates;
};

const GridCamera kEye = GridCamera::perspective(
    glm::lookAt(glm::dvec3(1, 2, 6), glm::dvec3(0, 0, 0), glm::dvec3(0, 1, 0)), 1.0, 1.25, 0.5,
    15.0);

EpipolarTransform fitted(const EpipolarLight& light, const glm::uvec3& size) {
    return EpipolarTransform::fit(kEye, light, size).value();
}

/// On screen, off screen, behind the eye; a sun on and off screen.
std::vector<EpipolarTransform> someVolumes(const glm::uvec3& size) {
    std::vector<EpipolarTransform> volumes;
    for (const glm::dvec3& place :
         {glm::dvec3(0.3, 0.2, -1), glm::dvec3(-9, 3, 1), glm::dvec3(1.5, 2, 9)})
        volumes.push_back(fitted({.position = place}, size));
    for (const glm::dvec3& direction : {glm::dvec3(0.1, 0.2, 1), glm::dvec3(1, -1, 0.2)})
        volumes.push_back(fitted({.kind = LightKind::Directional, .direction = direction}, size));
    return volumes;
}

EpipolarBits randomBits(std::span<const EpipolarTransform> transforms, const EpipolarLayout& layout,
                        double density, std::mt19937& random) {
    EpipolarBits bits = EpipolarBits::create(transforms, layout).value();
    std::bernoulli_distribution set(density);
    const glm::uvec3 size = bits.size();
    for (std::size_t vsv = 0; vsv < transforms.size(); ++vsv)
        for (std::uint32_t theta = 0; theta < size.y; ++theta)
            for (std::uint32_t alpha = 0; alpha < size.x; ++alpha)
                for (std::uint32_t phi = 0; phi < size.z; ++phi)
                    if (set(random))
                        bits.set(vsv, {alpha, theta, phi});
    return bits;
}

class EpipolarQueryGlTest : public test::GlTest {
protected:
    void expectHostAnswers(GLuint program, const EpipolarBits& bits);

    std::mt19937 mRandom{5};
};

void EpipolarQueryGlTest::expectHostAnswers(GLuint program, const EpipolarBits& bits) {
    auto grid = EpipolarGrid::create(device(), bits.layout()).value();
    ASSERT_TRUE(grid.upload(bits));
    ASSERT_TRUE(std::ranges::equal(grid.download()->words(), bits.words()));
    grid.bind(3, 5);

    constexpr std::size_t kPoints = 20000;
    const GridTransform view = GridTransform::camera(kEye, {1, 1, 1}).value();
    std::uniform_real_distribution<double> unit(0.0, 1.0);
    std::uniform_int_distribution<std::size_t> pick(0, bits.transforms().size() - 1);
    std::vector<glm::vec4> points;
    for (std::size_t i = 0; i < kPoints; ++i) {
        const glm::dvec3 world =
            view.gridToWorld({unit(mRandom), unit(mRandom), std::pow(unit(mRandom), 2.0)});
        points.emplace_back(glm::vec3(world), static_cast<float>(pick(mRandom)));
    }
    std::vector<Answers> answers(kPoints);
    runCompute(program, std::as_bytes(std::span(points)),
               std::as_writable_bytes(std::span(answers)), kPoints);

    std::size_t compared = 0;
    std::size_t shadowed = 0;
    const glm::dvec3 bias(bits.layout().alphaBias, 0.0, bits.layout().phiBias);
    for (std::size_t i = 0; i < kPoints; ++i) {
        const auto vsv = static_cast<std::size_t>(points[i].w);
        const glm::dvec3 world(points[i]);
        const EpipolarTransform& transform = bits.transforms()[vsv];
        const glm::dvec3 place = transform.worldToVoxel(world);
        // Single precision may choose the other voxel within this distance of a face, and near the
        // axis, where an angle loses what the position has, it is not compared.
        constexpr double kTolerance = 4e-3;
        const glm::dvec3 off = glm::abs(glm::dvec3(answers[i].coordinates) - place);
        const double ruleEdge = bits.layout().epipoleVoxels;
        const double alpha = place.x + transform.origin().x * transform.scale().x;
        EXPECT_LT(std::max(off.x, off.z), kTolerance) << i;
        const glm::dvec3 biased = place + bias;
        const auto isNearFace = [](double value) {
            return std::abs(value - std::round(value)) < kTolerance;
        };
        if (off.y > kTolerance || isNearFace(biased.x) || isNearFace(biased.y) ||
            isNearFace(biased.z) || isNearFace(2.0 * biased.y) || isNearFace(2.0 * biased.z) ||
            std::abs(alpha - ruleEdge) < kTolerance)
            continue;
        ++compared;
        const bool isLit = bits.lit(vsv, world);
        shadowed += isLit ? 0 : 1;
        EXPECT_EQ(answers[i].values.x != 0.0f, isLit) << i;
        EXPECT_NEAR(answers[i].values.y, bits.litInterpolated(vsv, world), 4 * kTolerance) << i;
        EXPECT_NEAR(answers[i].values.z, bits.shadowedFraction(vsv, world), 4 * kTolerance) << i;
        EXPECT_NEAR(answers[i].values.w, bits.shadowedFractionInterpolated(vsv, world),
                    4 * kTolerance)
            << i;
        if (HasFailure())
            return;
    }
    EXPECT_GT(compared, kPoints * 8 / 10);
    EXPECT_GT(shadowed, compared / 10);
    EXPECT_LT(shadowed, compared * 9 / 10);
}

TEST_F(EpipolarQueryGlTest, AnswersEqualTheHosts) {
    const std::string source = "#version 450 core\n#define LAMINA_EPIPOLAR_BLOCK_BINDING 3\n"
                               "#define LAMINA_EPIPOLAR_TEXTURE_UNIT 5\n" +
                               shaderSource("lamina/epipolar.glsl").value() + kQueries;
    const GLuint program = buildProgram({{GL_COMPUTE_SHADER, source}});
    const EpipolarLayout layouts[] = {
        {},
        {.bitsPerTexel = 127, .alphaBias = -2.25, .phiBias = -1.0},
        {.epipoleVoxels = 2.0},
    };
    for (const glm::uvec3& size : {glm::uvec3(40, 24, 128), glm::uvec3(17, 33, 300),
                                   glm::uvec3(64, 7, 127), glm::uvec3(5, 1, 1)})
        for (const EpipolarLayout& layout : layouts) {
            SCOPED_TRACE(testing::Message()
                         << size.x << " x " << size.y << " x " << size.z << ", "
                         << layout.bitsPerTexel << " bits, rule " << layout.epipoleVoxels);
            const auto volumes = someVolumes(size);
            expectHostAnswers(program, randomBits(volumes, layout, 0.4, mRandom));
        }
    gl().DeleteProgram(program);
}

TEST_F(EpipolarQueryGlTest, ScanEqualsASerialOr) {
    auto voxelizer = EpipolarVoxelizer::create(device()).value();
    auto grid = EpipolarGrid::create(device()).value();
    struct Case {
        std::uint32_t tiles;
        glm::uvec3 size;
        std::uint32_t bitsPerTexel;
    };
    const Case cases[] = {
        {1, {512, 5, 512}, 128},    {1, {1, 3, 128}, 128},    {3, {37, 9, 300}, 128},
        {3, {15, 4, 127}, 127},     {64, {128, 7, 128}, 128}, {64, {17, 6, 200}, 127},
        {256, {16, 5, 128}, 128},   {256, {65, 2, 130}, 128}, {1000, {33, 3, 128}, 128},
        {1000, {128, 2, 130}, 127}, {2, {2048, 2, 128}, 128},
    };
    for (const Case& test : cases) {
        SCOPED_TRACE(testing::Message() << test.tiles << " tiles of " << test.size.x << " x "
                                        << test.size.y << " x " << test.size.z);
        const std::vector<EpipolarTransform> volumes(test.tiles,
                                                     fitted({.position = {0, 3, 0}}, test.size));
        const double density = 1.5 / test.size.x;
        EpipolarBits expected =
            randomBits(volumes, {.bitsPerTexel = test.bitsPerTexel}, density, mRandom);
        ASSERT_TRUE(grid.upload(expected));
        ASSERT_TRUE(voxelizer.scan(grid));
        for (std::size_t vsv = 0; vsv < test.tiles; ++vsv)
            for (std::uint32_t group = 0; group < expected.groupCount(); ++group)
                for (std::uint32_t theta = 0; theta < test.size.y; ++theta)
                    for (std::uint32_t alpha = 1; alpha < test.size.x; ++alpha)
                        for (std::size_t word = 0; word < 4; ++word)
                            expected
                                .words()[expected.texelIndex(vsv, alpha, theta, group) + word] |=
                                expected.words()[expected.texelIndex(vsv, alpha - 1, theta, group) +
                                                 word];
        const EpipolarBits found = grid.download().value();
        ASSERT_TRUE(std::ranges::equal(found.words(), expected.words()));
    }
}

TEST_F(EpipolarQueryGlTest, SharedLayoutsMatchTheLinkedProgram) {
    const std::string source =
        "#version 450 core\n" + shaderSource("lamina/epipolar.glsl").value() + R"(
layout(local_size_x = 64) in;
layout(std430, binding = 1) readonly buffer Maps { LaminaEpipolarMap maps[]; };
layout(std430, binding = 2) buffer Out { float sums[]; };
void main() {
    sums[0] = laminaEpipolarSpaces[1].bias.x + float(laminaEpipolarSpaces[1].tile.z) + maps[1].spot.x +
              maps[1].fromTexel[2].x + float(maps[1].layersAndSpace.x);
})";
    const GLuint program = buildProgram({{GL_COMPUTE_SHADER, source}});
    const auto propertyOf = [&](const char* name, GLenum property) {
        const GLuint index = gl().GetProgramResourceIndex(program, GL_BUFFER_VARIABLE, name);
        EXPECT_NE(index, GL_INVALID_INDEX) << name;
        GLint value = -1;
        gl().GetProgramResourceiv(program, GL_BUFFER_VARIABLE, index, 1, &property, 1, nullptr,
                                  &value);
        return static_cast<std::size_t>(value);
    };
    using Space = shared::LaminaEpipolarSpace;
    using Map = shared::LaminaEpipolarMap;
    const std::string space = "laminaEpipolarSpaces[0].";
    EXPECT_EQ(propertyOf((space + "bias").c_str(), GL_OFFSET), offsetof(Space, bias));
    EXPECT_EQ(propertyOf((space + "tile").c_str(), GL_OFFSET), offsetof(Space, tile));
    EXPECT_EQ(propertyOf((space + "tile").c_str(), GL_TOP_LEVEL_ARRAY_STRIDE), sizeof(Space));
    EXPECT_EQ(propertyOf("maps[0].spot", GL_OFFSET), offsetof(Map, spot));
    EXPECT_EQ(propertyOf("maps[0].layersAndSpace", GL_OFFSET), offsetof(Map, layersAndSpace));
    EXPECT_EQ(propertyOf("maps[0].fromTexel", GL_OFFSET), offsetof(Map, fromTexel));
    EXPECT_EQ(propertyOf("maps[0].fromTexel", GL_TOP_LEVEL_ARRAY_STRIDE), sizeof(Map));
    gl().DeleteProgram(program);
}

} // namespace
} // namespace lamina
