// Shadow volumes of real, large and dirty meshes show the shadows that rays find.

#include "gl/support/gl_test.hpp"
#include "gl/support/shadow_rays.hpp"
#include "gl/support/test_meshes.hpp"

#include <reference/shapes.hpp>

#include <glm/common.hpp>

#include <algorithm>

namespace lamina {
namespace {

using test::lookAt;
using test::SceneHost;
using test::ScenePart;

constexpr glm::uvec2 kSize{128, 96};
const glm::dvec4 kSun{1.0, 0.9, -0.4, 0.0};
const glm::dvec4 kLamp{1.6, 3.6, 1.0, 1.0};

/// The mesh in a box of this size that stands on the floor in the middle.
TriangleMesh standing(TriangleMesh mesh, float size) {
    const Box3 bounds = mesh.bounds();
    const glm::dvec3 extent = bounds.size();
    const auto scale = size / static_cast<float>(std::max({extent.x, extent.y, extent.z}));
    const glm::vec3 foot(bounds.center().x, bounds.min.y, bounds.center().z);
    for (glm::vec3& position : mesh.positions)
        position = scale * (position - foot) + glm::vec3(0.0f, 0.02f, 0.0f);
    return mesh;
}

std::vector<ScenePart> onFloor(TriangleMesh mesh) {
    std::vector<ScenePart> parts;
    parts.push_back({reference::makePlane({0, 0, 0}, {0, 1, 0}, 24.0f), false});
    parts.push_back({std::move(mesh)});
    return parts;
}

/// A number in [0,1) of a seed, the same everywhere.
float chance(std::uint32_t& seed) {
    seed = seed * 1664525u + 1013904223u;
    return static_cast<float>(seed >> 8) / 16777216.0f;
}

/// What meshes from the wild suffer from: holes, triangles turned over, doubled, doubled and turned
/// over, without an area, and cut on one side of an edge alone (T-junctions).
TriangleMesh spoiled(const TriangleMesh& mesh) {
    TriangleMesh dirty;
    dirty.positions = mesh.positions;
    std::uint32_t seed = 7;
    for (const glm::uvec3& t : mesh.triangles) {
        const float fate = chance(seed);
        if (fate < 0.08f)
            continue;
        if (fate < 0.2f) {
            dirty.triangles.emplace_back(t.x, t.z, t.y);
        } else if (fate < 0.3f) {
            dirty.triangles.push_back(t);
            dirty.triangles.push_back(t);
        } else if (fate < 0.4f) {
            dirty.triangles.push_back(t);
            dirty.triangles.emplace_back(t.y, t.x, t.z);
        } else if (fate < 0.5f) {
            const auto middle = static_cast<std::uint32_t>(dirty.positions.size());
            dirty.positions.push_back(0.5f * (mesh.positions[t.x] + mesh.positions[t.y]));
            dirty.triangles.emplace_back(t.x, middle, t.z);
            dirty.triangles.emplace_back(middle, t.y, t.z);
        } else {
            dirty.triangles.push_back(t);
        }
        if (fate > 0.95f)
            dirty.triangles.emplace_back(t.x, t.y, t.y);
    }
    return dirty;
}

class ShadowVolumesMeshGlTest : public test::GlTest {
protected:
    /// Both extents against rays, and against each other.
    void expectShadows(const std::string& name, SceneHost& host, const glm::dvec4& light,
                       const test::RayComparison& comparison = {}) {
        SCOPED_TRACE(name);
        const View view = lookAt({0.3, 2.6, 4.2}, {-0.3, 0.6, 0.2}, kSize);
        auto volumes = ShadowVolumes::create(device()).value();
        ShadowScene scene;
        scene.view = view;
        scene.depthTexture = host.drawDepth(view);
        scene.light = light;
        scene.casters = host.casters();
        const auto prepared = volumes.prepare(scene);
        ASSERT_TRUE(prepared) << prepared.error().text;
        const auto whole =
            test::readRed(gl(), volumes.apply(VolumeExtent::Whole).value(), view.size);
        test::expectRayCastShadow(name, whole, host, view, light, comparison);
        EXPECT_TRUE(test::readRed(gl(), volumes.apply().value(), view.size) == whole);
    }
};

TEST_F(ShadowVolumesMeshGlTest, RealMeshesCastTheShadowsOfRays) {
    for (const test::NamedMesh& real :
         test::readRealMeshes({"bunny.ply", "armadillo.ply", "teapot.ply", "tree.ply"})) {
        SceneHost host(device(), onFloor(standing(real.mesh, 2.6f)));
        // Rays of single precision may pass a leaf's edge on its other side.
        expectShadows(real.name + "_sun", host, kSun, {.mostWrong = 2e-4});
        expectShadows(real.name + "_lamp", host, kLamp, {.mostWrong = 2e-4});
    }
}

TEST_F(ShadowVolumesMeshGlTest, AMillionTrianglesCastTheShadowOfRays) {
    const TriangleMesh knot =
        reference::makeTorusKnot({0.0f, 1.3f, 0.0f}, 0.8f, 0.2f, 2, 3, 4096, 128);
    ASSERT_EQ(knot.triangles.size(), 1u << 20);
    SceneHost host(device(), onFloor(knot));
    EXPECT_TRUE(host.casters().front().topology->isClosed());
    expectShadows("million", host, kLamp);
}

TEST_F(ShadowVolumesMeshGlTest, DirtyMeshesCastTheShadowsOfTheirTriangles) {
    const TriangleMesh sphere = spoiled(reference::makeIcosphere({0.0f, 1.2f, 0.0f}, 0.9f, 3));
    const TriangleMesh knot =
        spoiled(reference::makeTorusKnot({0.0f, 1.2f, 0.0f}, 0.8f, 0.2f, 2, 3, 96, 10));
    for (const TriangleMesh& mesh : {sphere, knot}) {
        SceneHost host(device(), onFloor(mesh));
        const ShadowTopology& topology = *host.casters().front().topology;
        EXPECT_FALSE(topology.isClosed());
        EXPECT_EQ(topology.surface(), CasterSurface::Sheet);
        EXPECT_GT(topology.openEdgeCount(), mesh.triangles.size() / 10);
        // T-junctions leave single pixels.
        expectShadows("dirty_sun", host, kSun, {.leastCompared = 0.5, .mostWrong = 0.001});
        expectShadows("dirty_lamp", host, kLamp, {.leastCompared = 0.5, .mostWrong = 0.001});
    }
}

} // namespace
} // namespace lamina
