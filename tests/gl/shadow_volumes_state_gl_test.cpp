// Every call of the shadow volumes leaves the GL state as it found it, works in a state far from
// the defaults, and refuses bad input.

#include "gl/state_guard.hpp"
#include "gl/support/gl_state.hpp"
#include "gl/support/gl_test.hpp"
#include "gl/support/shadow_scene.hpp"

#include <reference/shapes.hpp>

#include <gmock/gmock.h>

#include <limits>
#include <optional>

namespace lamina {
namespace {

using test::lookAt;
using test::SceneHost;
using testing::HasSubstr;

constexpr glm::uvec2 kSize{64, 48};

class ShadowVolumesStateGlTest : public test::GlTest {
protected:
    void SetUp() override {
        test::GlTest::SetUp();
        mHost.emplace(device(), std::vector<test::ScenePart>{
                                    {reference::makePlane({0, 0, 0}, {0, 1, 0}, 20.0f), false},
                                    {reference::makeCube({0, 1, 0}, 1.0f)},
                                    {reference::makePlane({1, 1, 1}, {0, 1, 0.2f}, 1.0f)}});
        mScene.view = lookAt({2, 4, 6}, {0, 0.5, 0}, kSize);
        mScene.depthTexture = mHost->drawDepth(mScene.view);
        mScene.light = {1.0, 5.0, 2.0, 1.0};
        mScene.casters = mHost->casters();
        mScene.receivers = mHost->sources();
    }
    void TearDown() override {
        mHost.reset();
        test::GlTest::TearDown();
    }
    std::vector<float> picture(ShadowVolumes& volumes) {
        EXPECT_TRUE(volumes.prepare(mScene));
        return test::readRed(gl(), volumes.apply().value(), kSize);
    }
    void expectRefused(const ShadowScene& scene, const ShadowVolumesDesc& desc, const char* text) {
        auto volumes = ShadowVolumes::create(device(), desc).value();
        const auto prepared = volumes.prepare(scene);
        ASSERT_FALSE(prepared) << text;
        EXPECT_EQ(prepared.error().code, ErrorCode::InvalidArgument);
        EXPECT_THAT(prepared.error().text, HasSubstr(text));
        EXPECT_THAT(prepared.error().text, HasSubstr("shadow volumes"));
    }

    std::optional<SceneHost> mHost;
    ShadowScene mScene;
};

TEST_F(ShadowVolumesStateGlTest, EveryCallRestoresTheState) {
    for (const bool isOther : {false, true}) {
        ShadowVolumesDesc desc;
        desc.lightMapTexels = 64;
        desc.layers = 40;
        desc.litmap = !isOther;
        desc.clipVolumes = isOther;
        desc.search = isOther ? LayerSearch::Queries : LayerSearch::Reduction;
        auto expectedFrom = ShadowVolumes::create(device(), desc).value();
        const auto expected = picture(expectedFrom);
        ASSERT_THAT(expected, testing::Contains(0.0f));

        // The host's depths, with modes that plain reads would suffer from.
        gl().TextureParameteri(mScene.depthTexture, GL_TEXTURE_COMPARE_MODE,
                               GL_COMPARE_REF_TO_TEXTURE);
        std::vector<float> found;
        {
            const test::OddGlState odd(gl());
            std::optional<ShadowTopology> topology;
            expectUnchanged("ShadowTopology::create", [&] {
                topology.emplace(ShadowTopology::create(device(), mHost->sources()[1]).value());
            });
            std::optional<ShadowVolumes> volumes;
            expectUnchanged(
                "create", [&] { volumes.emplace(ShadowVolumes::create(device(), desc).value()); });
            expectUnchanged("prepare", [&] { ASSERT_TRUE(volumes->prepare(mScene)); });
            expectUnchanged("overdraw", [&] { ASSERT_TRUE(volumes->overdraw()); });
            expectUnchanged("report", [&] {
                const auto report = volumes->downloadReport();
                ASSERT_TRUE(report);
                EXPECT_GT(report->stencilFragments, 0u);
            });
            GLuint texture = 0;
            expectUnchanged("apply", [&] { texture = volumes->apply().value(); });
            {
                const gl::PixelPackGuard pack(*device().state());
                found = test::readRed(gl(), texture, kSize);
            }
            expectUnchanged("failed prepare", [&] {
                ShadowScene bad = mScene;
                bad.depthTexture = 0;
                EXPECT_FALSE(volumes->prepare(bad));
            });
            expectUnchanged("destruction", [&] {
                volumes.reset();
                topology.reset();
            });
        }
        EXPECT_TRUE(found == expected);
    }
}

TEST_F(ShadowVolumesStateGlTest, TheHostsProvokingVertexDoesNotMatter) {
    const auto provoking = [this] {
        GLint value = 0;
        gl().GetIntegerv(GL_PROVOKING_VERTEX, &value);
        return static_cast<GLenum>(value);
    };
    gl().ProvokingVertex(GL_FIRST_VERTEX_CONVENTION);
    {
        const gl::RasterStateGuard guard(*device().state(), 0);
        EXPECT_EQ(provoking(), static_cast<GLenum>(GL_LAST_VERTEX_CONVENTION));
    }
    EXPECT_EQ(provoking(), static_cast<GLenum>(GL_FIRST_VERTEX_CONVENTION));
    gl().ProvokingVertex(GL_LAST_VERTEX_CONVENTION);
}

TEST_F(ShadowVolumesStateGlTest, RefusesWhatItCannotServe) {
    const ShadowVolumesDesc desc{.lightMapTexels = 32};
    ShadowScene scene = mScene;
    scene.view.size.x = 65;
    expectRefused(scene, desc, "65 x 48 texels");
    scene = mScene;
    scene.depthTexture = 0;
    expectRefused(scene, desc, "no texture");
    scene = mScene;
    scene.light = glm::dvec4(0.0);
    expectRefused(scene, desc, "expected a light");
    scene.light = {std::numeric_limits<double>::quiet_NaN(), 0, 0, 1};
    expectRefused(scene, desc, "expected a light");
    scene.light = {1e300, 0, 0, 1e-300};
    expectRefused(scene, desc, "expected a light");
    scene.light = {1e300, 1e300, 0, 0};
    expectRefused(scene, desc, "expected a light");
    for (const double w : {0.5, -1.0, 2.0}) {
        scene.light = {1.0, 5.0, 2.0, w};
        expectRefused(scene, desc, "(w 1)");
    }
    scene = mScene;
    scene.view.size = {0, 0};
    expectRefused(scene, desc, "0 x 0");
    scene = mScene;
    scene.view.worldToClip[1] = glm::dvec4(0.0);
    expectRefused(scene, desc, "inverse");
    scene = mScene;
    std::vector<ShadowCaster> casters = mHost->casters();
    casters[1].topology = nullptr;
    scene.casters = casters;
    expectRefused(scene, desc, "caster 1: expected a topology");
    casters = mHost->casters();
    casters[0].topology = casters[1].topology;
    std::get<MeshView>(casters[0].source).vertexCount = 2;
    scene.casters = casters;
    expectRefused(scene, desc, "caster 0: expected the 4 vertices");
    scene = mScene;
    scene.receivers = {};
    ShadowVolumesDesc noLitmap = desc;
    noLitmap.litmap = false;
    expectRefused(scene, noLitmap, "expected receivers");

    GLuint query = 0;
    gl().CreateQueries(GL_SAMPLES_PASSED, 1, &query);
    gl().BeginQuery(GL_SAMPLES_PASSED, query);
    ShadowVolumesDesc queries = desc;
    queries.search = LayerSearch::Queries;
    expectRefused(mScene, queries, "no active occlusion query");
    gl().EndQuery(GL_SAMPLES_PASSED);
    gl().DeleteQueries(1, &query);

    auto volumes = ShadowVolumes::create(device(), desc).value();
    EXPECT_EQ(volumes.apply().error().code, ErrorCode::InvalidArgument);
    EXPECT_EQ(volumes.downloadReport().error().code, ErrorCode::InvalidArgument);
    for (const ShadowVolumesDesc& bad :
         {ShadowVolumesDesc{.layers = 0}, ShadowVolumesDesc{.layers = 129},
          ShadowVolumesDesc{.lightMapTexels = 8}, ShadowVolumesDesc{.depthBiasSlope = -1.0f}})
        EXPECT_EQ(ShadowVolumes::create(device(), bad).error().code, ErrorCode::InvalidArgument);
    const auto search = ShadowVolumes::create(device(), {.search = static_cast<LayerSearch>(9)});
    ASSERT_FALSE(search);
    EXPECT_EQ(search.error().code, ErrorCode::InvalidArgument);
    EXPECT_THAT(search.error().text, HasSubstr("LayerSearch, found 9"));
    const auto surface =
        ShadowTopology::create(device(), mHost->sources()[1], static_cast<CasterSurface>(9));
    ASSERT_FALSE(surface);
    EXPECT_EQ(surface.error().code, ErrorCode::InvalidArgument);
    EXPECT_THAT(surface.error().text, HasSubstr("CasterSurface, found 9"));
    MeshView bad = std::get<MeshView>(mHost->sources()[1]);
    bad.vertexCount = 3;
    EXPECT_EQ(ShadowTopology::create(device(), bad).error().code, ErrorCode::InvalidMesh);
}

TEST_F(ShadowVolumesStateGlTest, RefusedFramesLeaveTheOneBefore) {
    auto volumes = ShadowVolumes::create(device(), {.lightMapTexels = 64}).value();
    const auto expected = picture(volumes);
    const auto report = volumes.downloadReport().value();
    // More casters, the last of them bad; another view; a bad receiver.
    SceneHost other(device(), {{reference::makePlane({0, 0, 0}, {0, 1, 0}, 20.0f), false},
                               {reference::makeCube({0, 1, 0}, 0.5f)},
                               {reference::makeCube({1, 1, 0}, 0.5f)},
                               {reference::makeCube({2, 1, 0}, 0.5f)},
                               {reference::makeCube({3, 1, 0}, 0.5f)}});
    ShadowScene scene;
    scene.view = lookAt({4, 4, 6}, {0, 0.5, 0}, {32, 80});
    scene.depthTexture = other.drawDepth(scene.view);
    scene.light = {0.0, 1.0, 0.0, 0.0};
    std::vector<ShadowCaster> casters = other.casters();
    std::get<MeshView>(casters.back().source).vertexCount = 3;
    scene.casters = casters;
    EXPECT_FALSE(volumes.prepare(scene));
    scene.casters = other.casters();
    std::vector<GeometrySource> receivers = other.sources();
    std::get<MeshView>(receivers.back()).vertexBuffer = 0;
    scene.receivers = receivers;
    EXPECT_FALSE(volumes.prepare(scene));
    EXPECT_TRUE(test::readRed(gl(), volumes.apply().value(), kSize) == expected);
    const auto again = volumes.downloadReport().value();
    EXPECT_EQ(again.keptLayers, report.keptLayers);
    EXPECT_EQ(again.receiversCulled, report.receiversCulled);
    EXPECT_EQ(again.stencilFragments, report.stencilFragments);

    // A map beyond the device: nothing is prepared, and a smaller one may follow.
    auto large = ShadowVolumes::create(device(), {.layers = 128, .lightMapTexels = 8192}).value();
    EXPECT_EQ(large.prepare(mScene).error().code, ErrorCode::DeviceLimit);
    EXPECT_THAT(large.apply().error().text, HasSubstr("prepare()"));
    scene.receivers = {};
    ASSERT_TRUE(volumes.prepare(scene));
    EXPECT_EQ(volumes.downloadReport()->casters, 4u);
    EXPECT_EQ(gl().GetError(), static_cast<GLenum>(GL_NO_ERROR));
}

TEST_F(ShadowVolumesStateGlTest, CastersWithoutTrianglesCastNothing) {
    TriangleMesh nothing = reference::makeCube({0, 1, 0}, 1.0f);
    for (glm::uvec3& triangle : nothing.triangles)
        triangle.y = triangle.x;
    SceneHost host(device(),
                   {{reference::makePlane({0, 0, 0}, {0, 1, 0}, 20.0f), false}, {nothing}});
    ShadowScene scene = mScene;
    scene.depthTexture = host.drawDepth(scene.view);
    scene.casters = host.casters();
    EXPECT_FALSE(host.casters().front().topology->isClosed());
    for (const LayerSearch search : {LayerSearch::Reduction, LayerSearch::Queries}) {
        auto volumes =
            ShadowVolumes::create(device(), {.lightMapTexels = 32, .search = search}).value();
        ASSERT_TRUE(volumes.prepare(scene));
        for (const VolumeExtent extent : {VolumeExtent::Kept, VolumeExtent::Whole})
            EXPECT_THAT(test::readRed(gl(), volumes.apply(extent).value(), kSize),
                        testing::Each(1.0f));
        EXPECT_EQ(volumes.downloadReport()->castersCulled, 1u);
    }
    EXPECT_EQ(gl().GetError(), static_cast<GLenum>(GL_NO_ERROR));
}

TEST_F(ShadowVolumesStateGlTest, NoCastersAndNothingVisibleAreLit) {
    auto volumes = ShadowVolumes::create(device(), {.lightMapTexels = 32}).value();
    ShadowScene scene = mScene;
    scene.casters = {};
    ASSERT_TRUE(volumes.prepare(scene));
    EXPECT_THAT(test::readRed(gl(), volumes.apply().value(), kSize), testing::Each(1.0f));
    scene = mScene;
    scene.view = lookAt({2, 4, 6}, {2, 40, 8}, kSize);
    scene.depthTexture = mHost->drawDepth(scene.view);
    ASSERT_TRUE(volumes.prepare(scene));
    EXPECT_THAT(test::readRed(gl(), volumes.apply().value(), kSize), testing::Each(1.0f));
    EXPECT_EQ(volumes.downloadReport()->castersCulled, 2u);
}

TEST_F(ShadowVolumesStateGlTest, TopologyFindsWhatIsClosed) {
    const auto topology = [&](const TriangleMesh& mesh) {
        auto buffers = MeshBuffers::upload(device(), mesh).value();
        return ShadowTopology::create(device(), buffers.view()).value();
    };
    const auto cube = topology(reference::makeCube({0, 0, 0}, 1.0f));
    EXPECT_TRUE(cube.isClosed());
    EXPECT_EQ(cube.surface(), CasterSurface::Closed);
    EXPECT_EQ(cube.edgeCount(), 18u);
    TriangleMesh split = reference::makeCube({0, 0, 0}, 1.0f);
    TriangleMesh soup;
    for (const glm::uvec3& t : split.triangles) {
        const auto first = static_cast<std::uint32_t>(soup.positions.size());
        for (glm::length_t k = 0; k < 3; ++k)
            soup.positions.push_back(split.positions[t[k]]);
        soup.triangles.emplace_back(first, first + 1, first + 2);
    }
    EXPECT_TRUE(topology(soup).isClosed());
    EXPECT_EQ(topology(soup).edgeCount(), 18u);
    split.triangles.pop_back();
    const auto open = topology(split);
    EXPECT_FALSE(open.isClosed());
    EXPECT_EQ(cube.openEdgeCount(), 0u);
    EXPECT_EQ(open.openEdgeCount(), 3u);
    EXPECT_EQ(open.surface(), CasterSurface::Sheet);
    EXPECT_EQ(open.edgeCount(), 18u);
    TriangleMesh turned = reference::makeCube({0, 0, 0}, 1.0f);
    std::swap(turned.triangles[0].x, turned.triangles[0].y);
    EXPECT_FALSE(topology(turned).isClosed());
    EXPECT_EQ(topology(turned).openEdgeCount(), 3u);
    // Triangles that are degenerate or nowhere cast nothing, and open nothing.
    TriangleMesh flawed = reference::makeCube({0, 0, 0}, 1.0f);
    flawed.positions.emplace_back(0.0f);
    flawed.triangles.emplace_back(0, 1, 1);
    flawed.triangles.emplace_back(0, 1, 8);
    flawed.positions[8].x = std::numeric_limits<float>::quiet_NaN();
    const auto vertices = gl::createBuffer(device().state(), 9 * sizeof(glm::vec3),
                                           flawed.positions.data(), 0, "test", "test");
    const auto indices = gl::createBuffer(device().state(), 14 * sizeof(glm::uvec3),
                                          flawed.triangles.data(), 0, "test", "test");
    MeshView view;
    view.vertexBuffer = vertices->id();
    view.vertexCount = 9;
    view.indexBuffer = indices->id();
    view.indexType = IndexType::UInt32;
    view.indexCount = 42;
    const auto sound = ShadowTopology::create(device(), view).value();
    EXPECT_TRUE(sound.isClosed());
    EXPECT_EQ(sound.triangleCount(), 12u);
    EXPECT_EQ(sound.vertexCount(), 8u);
    // Two cubes that share an edge: four triangles at it.
    const TriangleMesh pair = reference::merged(reference::makeBox({0, 0, 0}, {1, 1, 1}),
                                                reference::makeBox({1, 1, 0}, {2, 2, 1}));
    EXPECT_TRUE(topology(pair).isClosed());
    EXPECT_EQ(topology(pair).edgeCount(), 36u);
}

} // namespace
} // namespace lamina
