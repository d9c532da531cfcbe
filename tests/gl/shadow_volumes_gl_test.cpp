// Stencil shadow volumes show the shadows that rays find, for every kind of light, surface and
// depth buffer.

#include "gl/support/gl_test.hpp"
#include "gl/support/host_draw.hpp"
#include "gl/support/shadow_rays.hpp"

#include <reference/shapes.hpp>

#include <cmath>

namespace lamina {
namespace {

using test::lookAt;
using test::SceneHost;
using test::ScenePart;

constexpr glm::uvec2 kSize{128, 96};
const glm::dvec4 kSun{0.5, 1.0, 0.3, 0.0};

std::vector<ScenePart> closedScene() {
    std::vector<ScenePart> parts;
    parts.push_back({reference::makePlane({0, 0, 0}, {0, 1, 0}, 24.0f), false});
    parts.push_back({reference::makeBox({-2.0f, 0.0f, -1.5f}, {-1.0f, 1.5f, -0.5f})});
    parts.push_back({reference::makeIcosphere({1.2f, 1.4f, 0.3f}, 0.7f, 3)});
    parts.push_back({reference::makeTorus({0.0f, 0.9f, 1.6f}, 0.6f, 0.2f, 32, 16)});
    parts.push_back({reference::makeTorusKnot({-0.3f, 2.2f, -0.4f}, 0.7f, 0.13f, 2, 3, 96, 10)});
    return parts;
}

/// Surfaces that are not closed: plates, a fan of both windings, a bowl.
std::vector<ScenePart> openScene() {
    std::vector<ScenePart> parts;
    parts.push_back({reference::makePlane({0, 0, 0}, {0, 1, 0}, 24.0f), false});
    parts.push_back({reference::makePlane({-1.0f, 1.2f, 0.2f}, {0.3f, 1.0f, 0.2f}, 1.4f, 3)});
    parts.push_back({reference::makePlane({1.0f, 1.0f, 0.5f}, {-0.7f, -0.3f, 0.4f}, 1.2f)});
    parts.push_back({reference::makeFan({0.4f, 1.2f, -1.5f}, 1.0f, 17, 3)});
    TriangleMesh bowl = reference::makeIcosphere({0.1f, 0.8f, 1.7f}, 0.6f, 3);
    std::erase_if(bowl.triangles, [&](const glm::uvec3& t) {
        return bowl.positions[t.x].y + bowl.positions[t.y].y + bowl.positions[t.z].y > 2.7f;
    });
    parts.push_back({bowl});
    return parts;
}

/// A closed prism about an axis, of many facets along it.
TriangleMesh makePrism(const glm::dvec3& center, const glm::dvec3& axis, double radius,
                       double length) {
    constexpr std::uint32_t kSides = 48, kRings = 9;
    const glm::dvec3 along = glm::normalize(axis);
    const glm::dvec3 u = glm::normalize(glm::cross(along, glm::dvec3(0.3, 0.2, 1.0)));
    const glm::dvec3 v = glm::cross(along, u);
    TriangleMesh mesh;
    for (std::uint32_t ring = 0; ring < kRings; ++ring)
        for (std::uint32_t side = 0; side < kSides; ++side) {
            const double angle = 6.283185307179586 * side / kSides;
            mesh.positions.emplace_back(
                center + length * (static_cast<double>(ring) / (kRings - 1) - 0.5) * along +
                radius * (std::cos(angle) * u + std::sin(angle) * v));
        }
    for (std::uint32_t ring = 0; ring + 1 < kRings; ++ring)
        for (std::uint32_t side = 0; side < kSides; ++side) {
            const std::uint32_t a = ring * kSides + side;
            const std::uint32_t b = ring * kSides + (side + 1) % kSides;
            mesh.triangles.emplace_back(a, b, b + kSides);
            mesh.triangles.emplace_back(a, b + kSides, a + kSides);
        }
    const std::uint32_t last = (kRings - 1) * kSides;
    for (std::uint32_t side = 1; side + 1 < kSides; ++side) {
        mesh.triangles.emplace_back(0, side + 1, side);
        mesh.triangles.emplace_back(last, last + side, last + side + 1);
    }
    return mesh;
}

class ShadowVolumesGlTest : public test::GlTest {
protected:
    std::vector<float> light(ShadowVolumes& volumes, SceneHost& host, const View& view,
                             const glm::dvec4& light, VolumeExtent extent) {
        ShadowScene scene;
        scene.view = view;
        scene.depthTexture = host.drawDepth(view);
        scene.light = light;
        scene.casters = host.casters();
        const auto prepared = volumes.prepare(scene);
        EXPECT_TRUE(prepared) << prepared.error().text;
        const auto texture = volumes.apply(extent);
        EXPECT_TRUE(texture) << texture.error().text;
        return test::readRed(gl(), texture.value(), view.size);
    }

    void expectShadows(const char* name, SceneHost& host, const View& view,
                       const glm::dvec4& lightAt) {
        SCOPED_TRACE(name);
        auto volumes = ShadowVolumes::create(device()).value();
        const auto whole = light(volumes, host, view, lightAt, VolumeExtent::Whole);
        test::expectRayCastShadow(name, whole, host, view, lightAt);
        EXPECT_TRUE(light(volumes, host, view, lightAt, VolumeExtent::Kept) == whole);
    }
};

TEST_F(ShadowVolumesGlTest, ShadowsOfClosedMeshesAreThoseOfRays) {
    SceneHost host(device(), closedScene());
    const View view = lookAt({0.5, 4.0, 6.0}, {0.1, 0.6, 0.3}, kSize);
    expectShadows("sun", host, view, kSun);
    expectShadows("lamp", host, view, {1.5, 4.0, 1.0, 1.0});
    expectShadows("lamp_ahead", host, view, {-1.0, 2.5, -3.5, 1.0});
    expectShadows("lamp_behind", host, view, {3.0, 2.5, 9.0, 1.0});
    // Volumes and casters cut by the near plane, and the viewer in a volume.
    expectShadows("near_plane", host, lookAt({-2.6, 0.7, -1.6}, {0.1, 0.6, 0.3}, kSize, 0.9), kSun);
    expectShadows("viewer_in_shadow_of_sun", host,
                  lookAt({-2.3, 0.3, -1.4}, {0.1, 0.6, 0.3}, kSize), kSun);
    expectShadows("viewer_in_shadow", host, lookAt({-0.9, 0.6, -1.6}, {0.1, 0.6, 0.3}, kSize),
                  {-3.0, 3.0, 0.5, 1.0});
}

TEST_F(ShadowVolumesGlTest, ShadowsOfSheetsAreThoseOfRays) {
    SceneHost host(device(), openScene());
    const View view = lookAt({0.5, 4.0, 6.0}, {0.1, 0.6, 0.3}, kSize);
    expectShadows("sheets_sun", host, view, kSun);
    expectShadows("sheets_lamp", host, view, {-0.4, 3.0, 0.8, 1.0});
}

TEST_F(ShadowVolumesGlTest, ALightInsideASheetIsShutIn) {
    auto parts = closedScene();
    parts.resize(3);
    for (ScenePart& part : parts)
        part.surface = CasterSurface::Sheet;
    SceneHost host(device(), parts);
    const View view = lookAt({0.5, 4.0, 6.0}, {0.1, 0.6, 0.3}, kSize);
    const glm::dvec4 inSphere{1.2, 1.4, 0.3, 1.0};
    expectShadows("light_in_sphere", host, view, inSphere);
}

TEST_F(ShadowVolumesGlTest, FacetsThatTheLightGrazesLeakNothing) {
    // Rounding decides which facets along the sun's rays cast: each edge must find the same ones.
    const View view = lookAt({0.5, 4.0, 6.0}, {0.1, 0.6, 0.3}, kSize);
    for (const glm::dvec3& sun :
         {glm::dvec3(0.5, 1.0, 0.3), {-0.71, 0.9, 0.13}, {0.3, 0.8, -0.6}}) {
        SceneHost host(device(), {{reference::makePlane({0, 0, 0}, {0, 1, 0}, 24.0f), false},
                                  {makePrism({0.0, 1.3, 0.4}, sun, 0.8, 1.0)}});
        EXPECT_TRUE(host.casters().front().topology->isClosed());
        expectShadows("prism", host, view, glm::dvec4(sun, 0.0));
    }
}

TEST_F(ShadowVolumesGlTest, EveryDepthConventionShowsTheSameShadows) {
    SceneHost host(device(), closedScene());
    const glm::dmat4 camera =
        glm::lookAt(glm::dvec3(0.5, 4.0, 6.0), glm::dvec3(0.1, 0.6, 0.3), glm::dvec3(0, 1, 0));
    View view;
    view.size = kSize;
    view.worldToClip = glm::orthoNO(-4.0, 4.0, -3.0, 3.0, 1.0, 30.0) * camera;
    expectShadows("orthographic", host, view, kSun);
    view.worldToClip = glm::perspectiveZO(0.9, 4.0 / 3.0, 0.1, 9.0) * camera;
    view.clipDepth = ClipDepth::ZeroToOne;
    expectShadows("zero_to_one_short", host, view, {1.5, 4.0, 1.0, 1.0});
    view.depthRange = {0.75, 0.25};
    view.backgroundDepth = 0.0f;
    expectShadows("flipped_range", host, view, kSun);
    view.depthRange = {0.0, 1.0};
    glm::dmat4 reversed(0.0);
    const double f = 1.0 / std::tan(0.45);
    reversed[0][0] = f * 0.75;
    reversed[1][1] = f;
    reversed[2][3] = -1.0;
    reversed[3][2] = 0.1;
    view.worldToClip = reversed * camera;
    expectShadows("reversed_infinite", host, view, {1.5, 4.0, 1.0, 1.0});
}

TEST_F(ShadowVolumesGlTest, ScenesFarFromTheOriginKeepTheirShadows) {
    const glm::vec3 away(4096.0f, -512.0f, 8192.0f);
    auto parts = closedScene();
    for (ScenePart& part : parts)
        part.mesh =
            reference::transformed(part.mesh, glm::translate(glm::dmat4(1.0), glm::dvec3(away)));
    SceneHost host(device(), parts);
    const glm::dvec3 at(away);
    auto volumes = ShadowVolumes::create(device()).value();
    const View view = lookAt(at + glm::dvec3(0.5, 4.0, 6.0), at + glm::dvec3(0.1, 0.6, 0.3), kSize);
    const auto whole = light(volumes, host, view, kSun, VolumeExtent::Whole);
    EXPECT_TRUE(light(volumes, host, view, kSun, VolumeExtent::Kept) == whole);

    SceneHost near(device(), closedScene());
    const View nearView = lookAt({0.5, 4.0, 6.0}, {0.1, 0.6, 0.3}, kSize);
    const auto expected = light(volumes, near, nearView, kSun, VolumeExtent::Whole);
    std::size_t different = 0;
    for (std::size_t i = 0; i < whole.size(); ++i)
        different += whole[i] != expected[i] ? 1 : 0;
    // The meshes are rounded to 1/2048 there: edges move.
    EXPECT_LT(different, whole.size() / 100);
}

constexpr const char* kVertexStage = R"(
layout(location = 0) in vec3 position;
layout(location = 0) uniform vec3 shift;
LaminaVertex laminaVertex() { return LaminaVertex(position + shift, vec3(0.0), 0u); }
)";

TEST_F(ShadowVolumesGlTest, CastersOfTheHostsVertexStageCast) {
    const glm::vec3 shift(0.5f, 0.25f, -0.75f);
    const TriangleMesh still = reference::makeTorus({0.0f, 1.0f, 1.0f}, 0.6f, 0.2f, 32, 16);
    auto buffers = MeshBuffers::upload(device(), still).value();
    const MeshView mesh = buffers.view();
    const gl::VertexArray vertexArray = test::makeVertexArray(device(), mesh);
    DrawSource source;
    source.vertexShader = kVertexStage;
    source.draw = [&](const DrawContext& context) {
        gl().ProgramUniform3f(context.program, 0, shift.x, shift.y, shift.z);
        gl().BindVertexArray(vertexArray.id());
        gl().DrawElements(GL_TRIANGLES, static_cast<GLsizei>(mesh.indexCount), GL_UNSIGNED_INT,
                          reinterpret_cast<const void*>(mesh.indexOffsetBytes));
    };
    auto topology = ShadowTopology::create(device(), source).value();
    EXPECT_TRUE(topology.isClosed());
    EXPECT_EQ(topology.triangleCount(), still.triangles.size());
    EXPECT_EQ(topology.edgeCount(), still.triangles.size() * 3 / 2);

    std::vector<ScenePart> parts;
    parts.push_back({reference::makePlane({0, 0, 0}, {0, 1, 0}, 24.0f), false});
    parts.push_back(
        {reference::transformed(still, glm::translate(glm::dmat4(1.0), glm::dvec3(shift)))});
    SceneHost host(device(), parts);
    const View view = lookAt({0.5, 4.0, 6.0}, {0.1, 0.6, 0.3}, kSize);
    const ShadowCaster caster{&topology, source};
    ShadowScene scene;
    scene.view = view;
    scene.depthTexture = host.drawDepth(view);
    scene.light = kSun;
    scene.casters = {&caster, 1};
    auto volumes = ShadowVolumes::create(device()).value();
    const auto prepared = volumes.prepare(scene);
    ASSERT_TRUE(prepared) << prepared.error().text;
    const auto found = test::readRed(gl(), volumes.apply().value(), kSize);
    test::expectRayCastShadow("draw_source", found, host, view, kSun);
}

} // namespace
} // namespace lamina
