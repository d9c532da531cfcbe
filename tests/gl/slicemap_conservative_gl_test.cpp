// Coverage::Conservative of the slicemap backend against the double-precision references.

#include "gl/support/gl_test.hpp"
#include "gl/support/grids.hpp"
#include "gl/support/test_meshes.hpp"
#include "gl/support/voxelize.hpp"

#include <reference/filled.hpp>
#include <reference/overlap.hpp>
#include <reference/shapes.hpp>

#include <iostream>

namespace lamina {
namespace {

namespace ref = reference;
using test::NamedMesh;

const Box3 kUnitBox{{-1, -1, -1}, {1, 1, 1}};

class SlicemapConservativeGlTest : public test::GlTest {
protected:
    BitGrid voxelize(const TriangleMesh& mesh, const GridTransform& transform,
                     Backend backend = Backend::Slicemap) {
        return test::voxelize(device(), {backend, Coverage::Conservative}, mesh, transform);
    }

    /// Nothing missing, nothing that a voxel grown by 1e-5 would not touch.
    void expectTouched(const TriangleMesh& mesh, const GridTransform& transform,
                       const std::string& name) {
        const BitGrid found = voxelize(mesh, transform);
        // Shrunk by what double rounding may decide either way.
        const BitGrid must = ref::touched(mesh, transform, {.grow = -1e-9}).value();
        const BitGrid may = ref::touched(mesh, transform, {.grow = 1e-5}).value();
        EXPECT_EQ(compare(must, found)->onlyFirst, 0u) << name << ": missing voxels";
        EXPECT_EQ(compare(found, may)->onlyFirst, 0u) << name << ": superfluous voxels";
        EXPECT_GT(found.count(), 0u) << name;
    }
};

/// Rectangles, segments and points seen edge-on along z: on column centres, on column boundaries,
/// along diagonals through column corners, anywhere. In [0,8]^3.
TriangleMesh makeEdgeOn() {
    TriangleMesh mesh;
    const auto add = [&](const glm::vec3& a, const glm::vec3& b, const glm::vec3& c) {
        const auto first = static_cast<std::uint32_t>(mesh.positions.size());
        mesh.positions.insert(mesh.positions.end(), {a, b, c});
        mesh.triangles.emplace_back(first, first + 1, first + 2);
    };
    add({0.5f, 0.25f, 0.5f}, {0.5f, 2.75f, 0.5f}, {0.5f, 2.75f, 6.5f});  // on centres
    add({2.0f, 0.25f, 0.5f}, {2.0f, 2.75f, 3.25f}, {2.0f, 1.0f, 6.5f});  // on a boundary
    add({3.0f, 0.0f, 1.0f}, {6.0f, 3.0f, 2.0f}, {5.0f, 2.0f, 7.5f});     // on a diagonal
    add({3.1f, 4.3f, 7.7f}, {7.6f, 5.9f, 0.3f}, {5.35f, 5.1f, 2.0f});    // anywhere
    add({0.3f, 4.2f, 0.4f}, {0.3f, 4.2f, 5.6f}, {0.3f, 4.2f, 3.0f});     // along a column
    add({1.2f, 4.2f, 0.4f}, {1.2f, 4.2f, 5.6f}, {2.9f, 4.2f, 5.6f});     // one edge along a column
    add({0.5f, 6.5f, 2.25f}, {2.75f, 7.25f, 4.5f}, {0.5f, 6.5f, 2.25f}); // a segment
    add({4.25f, 6.75f, 4.5f}, {4.25f, 6.75f, 4.5f}, {4.25f, 6.75f, 4.5f}); // a point
    add({6.0f, 7.0f, 3.0f}, {6.0f, 7.0f, 3.0f}, {6.0f, 7.0f, 3.0f});       // a voxel's corner
    return mesh;
}

TEST_F(SlicemapConservativeGlTest, AgreesWithTheReferenceOnAllShapes) {
    const GridTransform transform = test::shapesGrid({101, 83, 128});
    for (const NamedMesh& shape : test::makeShapes())
        expectTouched(shape.mesh, transform, shape.name);
}

TEST_F(SlicemapConservativeGlTest, ContactsAreClosedOnVerticesAtPowerOfTwoFractions) {
    // Contacts of faces, edges and corners with voxel boundaries everywhere.
    for (const NamedMesh& shape : test::makeShapes())
        for (const Axis axis : {Axis::X, Axis::Y, Axis::Z}) {
            const GridTransform transform = ref::makeDyadicGrid(kUnitBox, {64, 48, 57}, axis);
            const TriangleMesh mesh = ref::snapped(shape.mesh, transform);
            const BitGrid expected = ref::overlap(mesh, transform).value();
            const BitGridComparison comparison =
                compare(voxelize(mesh, transform), expected).value();
            EXPECT_TRUE(comparison.equal())
                << shape.name << " along axis " << static_cast<int>(axis) << ": "
                << comparison.onlyFirst << " more, " << comparison.onlySecond << " fewer";
            EXPECT_GT(expected.count(), 0u) << shape.name;
        }
}

TEST_F(SlicemapConservativeGlTest, EdgeOnTrianglesSegmentsAndPointsCount) {
    const TriangleMesh mesh = makeEdgeOn();
    for (const std::uint32_t voxels : {8u, 64u, 200u}) {
        const GridTransform transform =
            GridTransform::box({glm::dvec3(0), glm::dvec3(8)}, glm::uvec3(voxels)).value();
        for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
            TriangleMesh one = mesh;
            one.triangles = {mesh.triangles[i]};
            expectTouched(one, transform,
                          "triangle " + std::to_string(i) + " in " + transform.describe());
        }
    }
    const GridTransform transform =
        GridTransform::box({glm::dvec3(0), glm::dvec3(8)}, glm::uvec3(8)).value();
    EXPECT_TRUE(compare(voxelize(mesh, transform), ref::overlap(mesh, transform).value())->equal());
    // The triangle through column centres alone, rows 0 to 2.
    TriangleMesh wall = mesh;
    wall.triangles = {mesh.triangles[0]};
    EXPECT_EQ(voxelize(wall, transform).count(), 3u + 5u + 7u);
    // Edge-on, it covers no centre, and Filled knows it not, as its definition says.
    EXPECT_EQ(
        test::voxelize(device(), {Backend::Slicemap, Coverage::Filled}, mesh, transform).count(),
        0u);
}

TEST_F(SlicemapConservativeGlTest, AlmostEdgeOnTrianglesAgreeWithTheReference) {
    const GridTransform transform =
        GridTransform::box({glm::dvec3(0), glm::dvec3(8)}, {64, 56, 200}).value();
    for (const float tilt : {1e-2f, 1e-4f, 1e-5f, 1e-6f, 3e-7f}) {
        TriangleMesh mesh = makeEdgeOn();
        for (std::size_t i = 0; i < mesh.positions.size(); i += 3)
            mesh.positions[i] += glm::vec3(tilt * 3.0f, tilt * 2.0f, 0.0f);
        expectTouched(mesh, transform, "tilt " + std::to_string(tilt));
    }
}

TEST_F(SlicemapConservativeGlTest, CameraGridsAndSliceDistributionsAgreeWithTheReference) {
    for (const GridTransform& transform : test::makeCameraGrids({90, 71, 100}))
        for (const NamedMesh& shape : test::makeShapes())
            expectTouched(shape.mesh, transform,
                          shape.name + ", " + transform.describe() + ", distribution " +
                              std::to_string(static_cast<int>(transform.distribution().kind())));
}

TEST_F(SlicemapConservativeGlTest, TrianglesEdgeOnToAPerspectiveEyeCount) {
    // Planes through the eye, in front of it and cut by it.
    const glm::dvec3 eye(0.05, 0.1, 0.2);
    const GridTransform transform = test::eyeGrid({80, 80, 96});
    const glm::vec3 forward = glm::normalize(glm::vec3(0.65f, 0.1f, -0.6f));
    const glm::vec3 side = glm::normalize(glm::cross(forward, glm::vec3(0.3f, 1.0f, 0.1f)));
    for (const float back : {0.4f, -0.7f}) {
        TriangleMesh mesh;
        mesh.positions = {glm::vec3(eye) + back * forward + 0.05f * side,
                          glm::vec3(eye) + 1.6f * forward + 0.4f * side,
                          glm::vec3(eye) + 2.1f * forward - 0.5f * side};
        mesh.triangles = {{0, 1, 2}};
        expectTouched(mesh, transform, "plane through the eye from " + std::to_string(back));
    }
    // Along one ray.
    TriangleMesh ray;
    const glm::vec3 direction = forward + 0.1f * side;
    ray.positions = {glm::vec3(eye) + 0.3f * direction, glm::vec3(eye) + 1.1f * direction,
                     glm::vec3(eye) + 2.2f * direction};
    ray.triangles = {{0, 1, 2}};
    expectTouched(ray, transform, "along a ray");
}

TEST_F(SlicemapConservativeGlTest, TrianglesAroundTheEyeAgreeWithTheReference) {
    const GridTransform transform = test::eyeGrid({80, 80, 96});
    for (const NamedMesh& shape : test::makeShapes())
        if (shape.name != "steep plane") // out of sight
            expectTouched(shape.mesh, transform, shape.name);
}

TEST_F(SlicemapConservativeGlTest, LargeAndSmallTrianglesAndGridSizes) {
    const TriangleMesh torus = ref::makeTorus({0.69f, 0.03f, 0}, 0.7f, 0.25f, 40, 20);
    for (const glm::uvec3 size : {glm::uvec3{1, 1, 1},
                                  {1, 65, 31},
                                  {63, 2, 129},
                                  {513, 3, 64},
                                  {2049, 5, 300},
                                  {5, 2049, 33}})
        expectTouched(torus, GridTransform::box({{-1, -1, -0.3}, {1, 1, 0.3}}, size).value(),
                      GridTransform::box({{-1, -1, -0.3}, {1, 1, 0.3}}, size)->describe());
    // Triangles of hundreds of columns, many of them partly outside.
    const GridTransform close =
        GridTransform::box({{-0.6, -0.8, -0.9}, {0.8, 0.7, 0.95}}, {400, 333, 380}).value();
    for (const NamedMesh& shape : test::makeShapes())
        if (shape.mesh.triangles.size() < 100)
            expectTouched(shape.mesh, close, shape.name);
}

TEST_F(SlicemapConservativeGlTest, LargeTrianglesOfAnyShapeLoseNoColumn) {
    const GridTransform transform = GridTransform::box(kUnitBox, {280, 250, 30}).value();
    const TriangleMesh meshes[] = {ref::makeTriangleSoup(kUnitBox, 40, 2.5f, 7),
                                   ref::makeSlivers(kUnitBox, 60, 1.7f, 0.05f, 8),
                                   ref::makeSlivers(kUnitBox, 60, 1.7f, 1e-5f, 9)};
    for (const TriangleMesh& mesh : meshes)
        for (const glm::uvec3& triangle : mesh.triangles) {
            // Alone, so that no other covers what it misses; both windings.
            TriangleMesh one = mesh;
            one.triangles = {triangle};
            expectTouched(one, transform, "triangle");
            EXPECT_TRUE(
                compare(voxelize(one, transform), voxelize(ref::flipped(one), transform))->equal());
        }
}

TEST_F(SlicemapConservativeGlTest, TrianglesThatReachFarBeyondTheGridLoseNoColumn) {
    const GridTransform transform =
        GridTransform::box({{0, 0, 0}, {1, 1, 1}}, {64, 64, 64}).value();
    for (const float reach : {1e2f, 1e4f, 1e6f}) {
        TriangleMesh mesh;
        mesh.positions = {{-reach, -0.37f * reach, 0.1f},
                          {reach, 0.37f * reach + 0.5f, 0.7f},
                          {0.3f, reach, 0.4f},
                          {0.3f, -reach, 0.2f},
                          {0.3f, reach, 0.9f}};
        mesh.triangles = {{0, 1, 2}, {3, 4, 4}, {3, 4, 2}};
        expectTouched(mesh, transform, "reach " + std::to_string(reach));
    }
}

TEST_F(SlicemapConservativeGlTest, RealMeshesMissNothingAndHoldHardlyMore) {
    for (const NamedMesh& real : test::readRealMeshes({"bunny.ply", "armadillo.ply"})) {
        const GridTransform transform =
            GridTransform::box(real.mesh.bounds(), glm::uvec3(512)).value();
        const BitGrid found = voxelize(real.mesh, transform);
        const BitGrid must = ref::overlap(real.mesh, transform, {.grow = -1e-9}).value();
        const BitGrid exact = ref::overlap(real.mesh, transform).value();
        const BitGrid may = ref::overlap(real.mesh, transform, {.grow = 1e-5}).value();
        EXPECT_EQ(compare(must, found)->onlyFirst, 0u) << real.name << ": missing voxels";
        EXPECT_EQ(compare(found, may)->onlyFirst, 0u) << real.name << ": superfluous voxels";
        // 5 % were asked for.
        const std::uint64_t extra = compare(found, exact)->onlyFirst;
        EXPECT_LE(extra * 10000, exact.count()) << real.name;
        const BitGridComparison both =
            compare(found, voxelize(real.mesh, transform, Backend::Overlap)).value();
        EXPECT_GT(both.iou(), 0.9999) << real.name;
        std::cout << real.name << " at 512 cubed: " << exact.count() << " voxels, " << extra
                  << " extra (" << 100.0 * static_cast<double>(extra) / double(exact.count())
                  << " %), IoU with overlap " << both.iou() << "\n";
    }
}

} // namespace
} // namespace lamina
