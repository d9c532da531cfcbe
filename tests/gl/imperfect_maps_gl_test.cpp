// The parts that imperfect shadow maps are made of: point samples, splats, hole filling and the
// rectification of hemispheres, each against the host.

#include "area_light/imperfect_maps.hpp"
#include "area_light/point_samples.hpp"
#include "gl/support/gl_test.hpp"

#include <lamina/voxelize/epipolar_voxelizer.hpp>

#include <reference/epipolar_agreement.hpp>
#include <reference/shapes.hpp>

#include <glm/geometric.hpp>
#include <glm/gtc/matrix_transform.hpp>

#include <bit>
#include <cmath>
#include <cstdio>
#include <limits>

namespace lamina {
namespace {

constexpr float kEmpty = std::numeric_limits<float>::max();

/// The point samples as the GPU holds them.
struct Sample {
    glm::vec4 position; ///< Radius in w.
    glm::vec4 normal;   ///< Area of the triangle in w.
    glm::uvec4 triangle;
};

/// Direction of a map's texel, in the map's frame, written anew from the definition.
glm::dvec3 texelDirection(int x, int y, int side) {
    const double a = (x + 0.5) / side * 2.0 - 1.0;
    const double b = (y + 0.5) / side * 2.0 - 1.0;
    const double s = 0.5 * (a + b);
    const double t = 0.5 * (a - b);
    return glm::normalize(glm::dvec3(s, t, 1.0 - std::abs(s) - std::abs(t)));
}

class ImperfectMapsGlTest : public test::GlTest {
protected:
    std::vector<Sample> draw(std::span<const GeometrySource> sources, const glm::dvec3& middle,
                             double near, std::uint32_t count) {
        auto samples = PointSamples::create(device().state(), count).value();
        const auto prepared = samples.prepare(sources);
        EXPECT_TRUE(prepared) << prepared.error().text;
        const auto drawn = samples.draw(sources, middle, near);
        EXPECT_TRUE(drawn) << drawn.error().text;
        std::vector<Sample> found(count);
        gl().GetNamedBufferSubData(samples.points(), 0,
                                   static_cast<GLsizeiptr>(count * sizeof(Sample)), found.data());
        return found;
    }
};

TEST_F(ImperfectMapsGlTest, PointsAreUniformByAreaOverAllSources) {
    // Areas 4 and 24 * 0.25, the latter by a model matrix, and more than a block of triangles.
    const TriangleMesh plate = reference::makePlane({0, 0, 0}, {0, 1, 0}, 2.0f);
    const TriangleMesh ball = reference::makeIcosphere({5, 0, 0}, 1.0f, 4);
    const auto first = MeshBuffers::upload(device(), plate).value();
    const auto second = MeshBuffers::upload(device(), ball).value();
    const glm::mat4 half =
        glm::scale(glm::translate(glm::mat4(1.0f), glm::vec3(0, 9, 0)), glm::vec3(0.5f));
    MeshView none = first.view();
    none.indexCount = 0;
    const GeometrySource sources[] = {first.view(), none, second.view(half)};
    constexpr std::uint32_t kCount = 20000;
    const auto points = draw(sources, glm::dvec3(0.0), 0.0, kCount);
    const double plateArea = 4.0;
    const double ballArea = 3.14159265; // 4 pi / 4.
    std::size_t onPlate = 0;
    double area = 0.0;
    glm::dvec3 mean(0.0);
    for (const Sample& point : points) {
        area += 3.14159265 * static_cast<double>(point.position.w * point.position.w);
        ASSERT_NEAR(glm::length(glm::vec3(point.normal)), 1.0f, 1e-4f);
        if (point.position.y < 4.0f) {
            ++onPlate;
            mean += glm::dvec3(point.position);
            ASSERT_EQ(point.position.y, 0.0f);
            ASSERT_LE(std::abs(point.position.x), 1.0f);
        } else {
            const float radius = glm::distance(glm::vec3(point.position), glm::vec3(2.5f, 9, 0));
            ASSERT_NEAR(radius, 0.5f, 0.005f);
        }
    }
    // Strata of the list: counts hit their shares but for the last point.
    EXPECT_NEAR(static_cast<double>(onPlate), kCount * plateArea / (plateArea + ballArea), 30.0);
    EXPECT_NEAR(area, plateArea + ballArea, 0.02);
    EXPECT_LT(glm::length(mean) / static_cast<double>(onPlate), 0.02);
}

TEST_F(ImperfectMapsGlTest, PointsAreDenserNearTheLight) {
    const TriangleMesh plates = reference::merged(reference::makePlane({0, 0, 1}, {0, 1, 0}, 0.2f),
                                                  reference::makePlane({0, 0, 4}, {0, 1, 0}, 0.2f));
    const auto buffers = MeshBuffers::upload(device(), plates).value();
    const GeometrySource source = buffers.view();
    const auto points = draw({&source, 1}, glm::dvec3(0.0), 0.1, 4096);
    std::size_t nearOnes = 0;
    for (const Sample& point : points)
        nearOnes += point.position.z < 2.0f ? 1 : 0;
    EXPECT_NEAR(static_cast<double>(nearOnes) / 4096.0, 16.0 / 17.0, 0.02);
}

TEST_F(ImperfectMapsGlTest, NothingToSampleMakesEmptyMaps) {
    for (const Sample& point : draw({}, glm::dvec3(0.0), 0.0, 1024))
        ASSERT_EQ(point.position.w, 0.0f);
}

TEST_F(ImperfectMapsGlTest, MapsHoldTheDistancesThatRaysFind) {
    const TriangleMesh scene = reference::makeFenceScene();
    const reference::ShadowRays rays(scene);
    const auto buffers = MeshBuffers::upload(device(), scene).value();
    const GeometrySource source = buffers.view();
    DiskLight disk;
    disk.center = {0.3, 3.0, -2.6};
    disk.normal = {0.0, -0.8, 0.6};
    disk.radius = 0.3;
    const auto lights = sampleVirtualLights(disk, 3).value();
    AreaLightDesc desc;
    desc.mapTexels = 65;
    desc.imperfect = {1u << 17u, 1u << 15u, 2};
    std::vector<EpipolarTransform> transforms;
    for (const VirtualLight& light : lights)
        transforms.push_back(
            EpipolarTransform::fit(reference::frontEye(), light.light, {16, 16, 16}).value());
    auto maker = ImperfectMapMaker::create(device().state(), desc).value();
    const auto prepared = maker.prepare({&source, 1}, static_cast<std::uint32_t>(lights.size()));
    ASSERT_TRUE(prepared) << prepared.error().text;
    const auto maps = maker.make({&source, 1}, lights, transforms);
    ASSERT_TRUE(maps) << maps.error().text;
    std::size_t hits = 0, wrong = 0, texels = 0, filledGaps = 0, holes = 0;
    for (std::uint32_t i = 0; i < lights.size(); ++i) {
        const LightDepthMap& map = (*maps)[i];
        std::vector<float> content(65 * 65);
        gl().GetTextureSubImage(
            map.texture, 0, 0, 0, static_cast<GLint>(map.layer), 65, 65, 1, GL_RED, GL_FLOAT,
            static_cast<GLsizei>(content.size() * sizeof(float)), content.data());
        const glm::dmat3 toWorld = glm::transpose(map.worldToHemisphere);
        for (int y = 0; y < 65; ++y)
            for (int x = 0; x < 65; ++x) {
                const double expected =
                    rays.firstHit(lights[i].light.position, toWorld * texelDirection(x, y, 65));
                const float found = content[static_cast<std::size_t>(65 * y + x)];
                ++texels;
                if (std::isinf(expected)) {
                    filledGaps += found != kEmpty ? 1 : 0;
                    continue;
                }
                ++hits;
                holes += found == kEmpty ? 1 : 0;
                wrong += std::abs(static_cast<double>(found) / expected - 1.0) > 0.05 ? 1 : 0;
            }
    }
    std::printf("%zu of %zu texels hit, %zu holes, %zu wrong, %zu gaps closed\n", hits, texels,
                holes, wrong, filledGaps);
    EXPECT_GT(hits, texels / 4);
    // Disks of samples are wider than thin bars; bare spots between them let light through.
    EXPECT_LT(wrong, hits / 15);
    EXPECT_LT(holes, hits / 100);
    EXPECT_LT(filledGaps, texels / 50);
}

TEST_F(ImperfectMapsGlTest, RectifiedHemispheresAgreeWithRays) {
    const TriangleMesh scene = reference::makeFenceScene();
    const reference::ShadowRays rays(scene);
    constexpr int kSide = 400;
    const EpipolarLight light{.position = {0.3, 3.0, -2.6}};
    const glm::dvec3 middle = glm::normalize(glm::dvec3(0.1, -0.8, 0.6));
    const glm::dvec3 s = glm::normalize(glm::cross(glm::dvec3(0, 0, 1), middle));
    const glm::dmat3 toWorld(s, glm::cross(middle, s), middle);
    std::vector<float> distances;
    for (int y = 0; y < kSide; ++y)
        for (int x = 0; x < kSide; ++x) {
            const double hit = rays.firstHit(light.position, toWorld * texelDirection(x, y, kSide));
            distances.push_back(std::isinf(hit) ? kEmpty : static_cast<float>(hit));
        }
    // A part of a layer of a larger texture.
    GLuint texture = 0;
    gl().CreateTextures(GL_TEXTURE_2D_ARRAY, 1, &texture);
    gl().TextureStorage3D(texture, 1, GL_R32F, kSide + 7, kSide + 3, 2);
    gl().TextureSubImage3D(texture, 0, 7, 3, 1, kSide, kSide, 1, GL_RED, GL_FLOAT,
                           distances.data());
    LightDepthMap map;
    map.texture = texture;
    map.kind = DepthMapKind::HemisphereArray;
    map.layer = 1;
    map.firstTexel = {7, 3};
    map.size = glm::uvec2(kSide);
    map.worldToHemisphere = glm::transpose(toWorld);
    map.emptyDepth = kEmpty;
    const EpipolarTransform transform =
        EpipolarTransform::fit(reference::frontEye(), light, {256, 256, 256}).value();
    auto voxelizer = EpipolarVoxelizer::create(device()).value();
    auto grid = EpipolarGrid::create(device()).value();
    const auto made = voxelizer.voxelize({&map, 1}, {&transform, 1}, grid);
    ASSERT_TRUE(made) << made.error().text;
    const auto found =
        reference::compareWithRays(grid.download().value(), 0, rays, reference::frontEye(), 50000);
    std::printf("disagree %.2f %% (ideal %.2f %%)\n",
                100.0 * static_cast<double>(found.disagreements) /
                    static_cast<double>(found.points),
                100.0 * static_cast<double>(found.ideal) / static_cast<double>(found.points));
    EXPECT_LE(found.disagreements, found.points / 33);
    EXPECT_GT(found.points - found.lit, found.points / 20);

    const auto refuses = [&](const LightDepthMap& bad, const char* text) {
        const auto refused = voxelizer.voxelize({&bad, 1}, {&transform, 1}, grid);
        ASSERT_FALSE(refused) << text;
        EXPECT_NE(refused.error().text.find(text), std::string::npos) << refused.error().text;
    };
    LightDepthMap bad = map;
    bad.worldToHemisphere[0] *= 2.0;
    refuses(bad, "rotation");
    bad = map;
    bad.layer = 2;
    refuses(bad, "layer below 2");
    bad = map;
    bad.firstTexel = {8, 3};
    refuses(bad, "inside the texture");
    gl().DeleteTextures(1, &texture);
}

} // namespace
} // namespace lamina
