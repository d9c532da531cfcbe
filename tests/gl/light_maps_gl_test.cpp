// Hole filling of imperfect maps and the rectification of the maps of area lights equal host
// references, and known answers.

#include "area_light/hole_filler.hpp"
#include "gl/support/gl_test.hpp"

#include <lamina/voxelize/epipolar_voxelizer.hpp>

#include <reference/epipolar_agreement.hpp>
#include <reference/light_maps.hpp>

#include <glm/geometric.hpp>
#include <glm/gtc/matrix_transform.hpp>
#include <glm/matrix.hpp>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <random>

namespace lamina {
namespace {

using reference::DistanceMap;

constexpr float kEmpty = std::numeric_limits<float>::max();

class LightMapsGlTest : public test::GlTest {
protected:
    void TearDown() override {
        gl().DeleteTextures(1, &mTexture);
        GlTest::TearDown();
    }
    /// The maps after a pass of hole filling, side by side in layers.
    std::vector<DistanceMap> filled(const std::vector<DistanceMap>& maps, std::uint32_t levels) {
        const auto side = static_cast<GLsizei>(maps.front().side);
        const auto layers = static_cast<GLsizei>(maps.size());
        const auto filler = HoleFiller::create(device().state(), maps.front().side, levels).value();
        const glm::ivec2 size(filler.layerSize());
        gl().DeleteTextures(1, &mTexture);
        gl().CreateTextures(GL_TEXTURE_2D_ARRAY, 1, &mTexture);
        // A layer more, which is not to be touched; and rubbish in place of the pyramids.
        gl().TextureStorage3D(mTexture, 1, GL_R32F, size.x, size.y, layers + 1);
        const float rubbish = 77.0f;
        gl().ClearTexImage(mTexture, 0, GL_RED, GL_FLOAT, &rubbish);
        for (int i = 0; i < layers; ++i) {
            const std::vector<double>& values = maps[static_cast<std::size_t>(i)].values;
            std::vector<float> content;
            for (const double value : values)
                content.push_back(static_cast<float>(value));
            gl().TextureSubImage3D(mTexture, 0, 0, 0, i, side, side, 1, GL_RED, GL_FLOAT,
                                   content.data());
        }
        filler.fill(mTexture, static_cast<std::uint32_t>(layers));
        gl().MemoryBarrier(GL_TEXTURE_UPDATE_BARRIER_BIT);
        std::vector<DistanceMap> found;
        for (int i = 0; i < layers; ++i)
            found.push_back({maps.front().side, read({0, 0, i}, {side, side}), double{kEmpty}});
        for (const double value : read({0, 0, layers}, size))
            EXPECT_EQ(value, double{rubbish}) << "a layer without a map was written";
        return found;
    }
    std::vector<double> read(const glm::ivec3& from, const glm::ivec2& size) {
        std::vector<float> content(static_cast<std::size_t>(size.x) *
                                   static_cast<std::size_t>(size.y));
        gl().GetTextureSubImage(mTexture, 0, from.x, from.y, from.z, size.x, size.y, 1, GL_RED,
                                GL_FLOAT, static_cast<GLsizei>(content.size() * sizeof(float)),
                                content.data());
        return {content.begin(), content.end()};
    }
    DistanceMap filled(const DistanceMap& map, std::uint32_t levels) {
        return filled(std::vector<DistanceMap>{map}, levels).front();
    }
    static DistanceMap flat(std::uint32_t side, double value) {
        return {side, std::vector<double>(std::size_t{side} * side, value), double{kEmpty}};
    }
    /// Compares a volume's first shadowed voxels with the reference's.
    void expectRectified(const LightDepthMap& map, const EpipolarTransform& transform,
                         const EpipolarLayout& layout, const reference::FirstSurface& surface);

    GLuint mTexture = 0;
    std::mt19937 mRandom{5};
};

TEST_F(LightMapsGlTest, HolesAreFilledAsByTheHost) {
    struct Case {
        std::uint32_t side, maps, levels;
        double holes; ///< Share of texels.
    };
    const Case cases[] = {{1, 2, 3, 0.5},   {2, 3, 1, 0.3},   {7, 4, 3, 0.4},
                          {64, 3, 1, 0.2},  {65, 5, 4, 0.45}, {128, 2, 2, 0.3},
                          {33, 70, 2, 0.6}, {24, 1, 8, 0.35}, {16, 2, 0, 0.5}};
    std::uniform_real_distribution<double> unit(0.0, 1.0);
    for (const Case& test : cases) {
        SCOPED_TRACE(testing::Message() << test.maps << " maps of " << test.side << " texels, "
                                        << test.levels << " levels");
        std::vector<DistanceMap> maps;
        for (std::uint32_t i = 0; i < test.maps; ++i) {
            DistanceMap map = flat(test.side, double{kEmpty});
            // Two surfaces, one far behind the other; distances that floats hold.
            for (std::uint32_t y = 0; y < test.side; ++y)
                for (std::uint32_t x = 0; x < test.side; ++x)
                    if (unit(mRandom) >= test.holes)
                        map.values[std::size_t{y} * test.side + x] =
                            static_cast<float>((3 * x + 2 * y < 2 * test.side ? 1.0 : 4.0) +
                                               0.002 * x + 0.003 * y + 0.3 * unit(mRandom));
            maps.push_back(std::move(map));
        }
        const auto found = filled(maps, test.levels);
        std::size_t closed = 0;
        for (std::size_t i = 0; i < maps.size(); ++i) {
            const DistanceMap expected = reference::fillHoles(maps[i], test.levels);
            for (std::size_t texel = 0; texel < expected.values.size(); ++texel) {
                const double value = found[i].values[texel];
                // Values that were there are kept bit for bit, empty texels exactly empty.
                if (maps[i].values[texel] != maps[i].empty ||
                    expected.values[texel] == expected.empty)
                    ASSERT_EQ(value, expected.values[texel]) << "map " << i << " texel " << texel;
                else
                    // A few roundings of single precision.
                    ASSERT_NEAR(value, expected.values[texel], 1e-6 * value)
                        << "map " << i << " texel " << texel;
                closed += maps[i].values[texel] != value ? 1 : 0;
            }
        }
        EXPECT_TRUE(closed > 0 || test.levels == 0 || test.side < 3);
    }
}

TEST_F(LightMapsGlTest, HolesUpToTheLevelsSizeAreClosedAndOutlinesStay) {
    // A square hole of 3 texels needs two levels.
    DistanceMap map = flat(32, 2.0);
    for (const std::uint32_t y : {13u, 14u, 15u})
        for (const std::uint32_t x : {17u, 18u, 19u})
            map.values[32 * y + x] = map.empty;
    const auto holesOf = [](const DistanceMap& in) {
        return std::ranges::count(in.values, in.empty);
    };
    EXPECT_GT(holesOf(filled(map, 1)), 0);
    const DistanceMap closed = filled(map, 3);
    EXPECT_EQ(holesOf(closed), 0);
    for (const double value : closed.values)
        ASSERT_DOUBLE_EQ(value, 2.0);
    // Half a map stays half a map.
    for (const std::uint32_t edge : {8u, 11u, 16u, 21u}) {
        DistanceMap half = flat(32, double{kEmpty});
        for (std::uint32_t y = 0; y < 32; ++y)
            for (std::uint32_t x = 0; x < edge; ++x)
                half.values[32 * y + x] = 1.5;
        const DistanceMap same = filled(half, 3);
        for (std::uint32_t y = 0; y < 32; ++y)
            for (std::uint32_t x = edge + 1; x < 32; ++x)
                ASSERT_EQ(same.at(x, y), same.empty) << edge << ": " << x << ", " << y;
    }
    EXPECT_EQ(holesOf(filled(flat(32, double{kEmpty}), 3)), 32 * 32);
}

void LightMapsGlTest::expectRectified(const LightDepthMap& map, const EpipolarTransform& transform,
                                      const EpipolarLayout& layout,
                                      const reference::FirstSurface& surface) {
    auto voxelizer = EpipolarVoxelizer::create(device()).value();
    auto grid = EpipolarGrid::create(device(), layout).value();
    const auto made = voxelizer.rectify({&map, 1}, {&transform, 1}, grid);
    ASSERT_TRUE(made) << made.error().text;
    const EpipolarBits bits = grid.download().value();
    const auto expected = reference::rectify(transform, surface);
    const glm::uvec3 size = transform.size();
    std::size_t differs = 0, apart = 0, occluded = 0;
    for (std::uint32_t theta = 0; theta < size.y; ++theta)
        for (std::uint32_t phi = 0; phi < size.z; ++phi) {
            std::uint32_t first = size.x;
            std::uint32_t count = 0;
            for (std::uint32_t alpha = size.x; alpha-- > 0;)
                if (bits.test(0, {alpha, theta, phi})) {
                    first = alpha;
                    ++count;
                }
            ASSERT_LE(count, 1u) << "one voxel a light ray";
            const std::uint32_t wanted = expected[std::size_t{theta} * size.z + phi];
            occluded += wanted < size.x ? 1 : 0;
            differs += first != wanted ? 1 : 0;
            apart += std::max(first, wanted) - std::min(first, wanted) > 1 ? 1 : 0;
        }
    const double rays = static_cast<double>(expected.size());
    std::printf("%zu of %zu rays occluded, %.3f %% differ, %.3f %% by more than a voxel\n",
                occluded, expected.size(), 100.0 * static_cast<double>(differs) / rays,
                100.0 * static_cast<double>(apart) / rays);
    // Single precision finds the next texel for a ray along a texel's edge, and the next voxel for
    // a surface at a voxel's centre.
    EXPECT_LE(static_cast<double>(differs), 2e-3 * rays);
    EXPECT_LE(static_cast<double>(apart), 1e-3 * rays);
    EXPECT_GT(occluded, expected.size() / 10);
    EXPECT_LT(occluded, expected.size());
}

TEST_F(LightMapsGlTest, HemispheresAreRectifiedAsByTheHost) {
    constexpr int kSide = 61;
    const EpipolarLight light{.position = {0.3, 3.0, -2.6}};
    const glm::dvec3 middle = glm::normalize(glm::dvec3(0.1, -0.8, 0.6));
    const glm::dvec3 s = glm::normalize(glm::cross(glm::dvec3(0, 0, 1), middle));
    const glm::dmat3 toWorld(s, glm::cross(middle, s), middle);
    std::uniform_real_distribution<float> distance(0.4f, 9.0f);
    std::vector<float> distances;
    for (int i = 0; i < kSide * kSide; ++i)
        distances.push_back(i % 5 == 0 ? kEmpty : distance(mRandom));
    gl().CreateTextures(GL_TEXTURE_2D_ARRAY, 1, &mTexture);
    gl().TextureStorage3D(mTexture, 1, GL_R32F, kSide, kSide, 2);
    gl().TextureSubImage3D(mTexture, 0, 0, 0, 1, kSide, kSide, 1, GL_RED, GL_FLOAT,
                           distances.data());
    LightDepthMap map;
    map.texture = mTexture;
    map.kind = DepthMapKind::HemisphereArray;
    map.layer = 1;
    map.worldToHemisphere = glm::transpose(toWorld);
    map.emptyDepth = kEmpty;
    // The definition of LightDepthMap::worldToHemisphere.
    const auto surface = [&](const glm::dvec3& origin,
                             const glm::dvec3& direction) -> std::optional<glm::dvec3> {
        const glm::dvec3 d = map.worldToHemisphere * direction;
        if (d.z <= 0.0)
            return {};
        const glm::dvec2 place = glm::dvec2(d) / (std::abs(d.x) + std::abs(d.y) + d.z);
        const glm::dvec2 square(place.x + place.y, place.x - place.y);
        const auto texel = glm::clamp(glm::ivec2(glm::floor((square * 0.5 + 0.5) * double{kSide})),
                                      glm::ivec2(0), glm::ivec2(kSide - 1));
        const float found = distances[static_cast<std::size_t>(texel.y * kSide + texel.x)];
        if (found == kEmpty)
            return {};
        const glm::dvec2 center = (glm::dvec2(texel) + 0.5) * (2.0 / kSide) - 1.0;
        const glm::dvec2 back(0.5 * (center.x + center.y), 0.5 * (center.x - center.y));
        const glm::dvec3 along =
            glm::normalize(glm::dvec3(back, 1.0 - std::abs(back.x) - std::abs(back.y)));
        return origin + double{found} * (toWorld * along);
    };
    for (const glm::uvec3& size :
         {glm::uvec3(128, 96, 128), glm::uvec3(33, 61, 200), glm::uvec3(600, 17, 64)})
        for (const std::uint32_t bitsPerTexel : {128u, 127u})
            expectRectified(map, EpipolarTransform::fit(reference::frontEye(), light, size).value(),
                            {.bitsPerTexel = bitsPerTexel}, surface);
}

TEST_F(LightMapsGlTest, PlanarMapsAreRectifiedAsByTheHost) {
    constexpr int kSide = 75;
    std::uniform_real_distribution<float> depth(0.2f, 0.95f);
    std::vector<float> depths;
    for (int i = 0; i < kSide * kSide; ++i)
        depths.push_back(i % 7 == 0 ? 1.0f : depth(mRandom));
    gl().CreateTextures(GL_TEXTURE_2D_ARRAY, 1, &mTexture);
    gl().TextureStorage3D(mTexture, 1, GL_R32F, kSide, kSide, 1);
    gl().TextureSubImage3D(mTexture, 0, 0, 0, 0, kSide, kSide, 1, GL_RED, GL_FLOAT, depths.data());
    const EpipolarLight lamp{.position = {-2.0, 4.0, -1.0}};
    const EpipolarLight sun{.kind = LightKind::Directional, .direction = {0.4, -1.0, 0.3}};
    const glm::dmat4 lampClip =
        glm::perspective(1.9, 1.0, 0.3, 20.0) *
        glm::lookAt(lamp.position, glm::dvec3(0.0, 0.5, 0.0), glm::dvec3(0.0, 0.0, 1.0));
    const glm::dmat4 sunClip = glm::ortho(-6.0, 6.0, -6.0, 6.0, -9.0, 9.0) *
                               glm::lookAt(-sun.direction, glm::dvec3(0.0), glm::dvec3(0, 0, 1));
    for (const bool isSun : {false, true})
        for (const bool zeroToOne : {false, true}) {
            SCOPED_TRACE(testing::Message() << (isSun ? "sun" : "lamp") << ", " << zeroToOne);
            LightDepthMap map;
            map.texture = mTexture;
            map.kind = DepthMapKind::TextureArray;
            map.worldToClip = isSun ? sunClip : lampClip;
            map.zeroToOneDepth = zeroToOne;
            const glm::dmat4 fromClip = glm::inverse(map.worldToClip);
            const auto surface = [&](const glm::dvec3& origin,
                                     const glm::dvec3& direction) -> std::optional<glm::dvec3> {
                const glm::dvec4 clip = map.worldToClip * glm::dvec4(origin + direction, 1.0);
                if (clip.w <= 0.0)
                    return {};
                const glm::dvec2 texel = glm::floor((glm::dvec2(clip) / clip.w * 0.5 + 0.5) *
                                                    static_cast<double>(kSide));
                if (texel.x < 0.0 || texel.y < 0.0 || texel.x >= kSide || texel.y >= kSide)
                    return {};
                const double found = double{depths[static_cast<std::size_t>(texel.y) * kSide +
                                                   static_cast<std::size_t>(texel.x)]};
                if (found == 1.0)
                    return {};
                const glm::dvec2 center = (texel + 0.5) * (2.0 / kSide) - 1.0;
                const glm::dvec4 point =
                    fromClip * glm::dvec4(center, zeroToOne ? found : 2.0 * found - 1.0, 1.0);
                return glm::dvec3(point) / point.w;
            };
            expectRectified(
                map,
                EpipolarTransform::fit(reference::frontEye(), isSun ? sun : lamp, {128, 80, 128})
                    .value(),
                {}, surface);
        }
}

} // namespace
} // namespace lamina
