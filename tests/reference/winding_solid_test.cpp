#include <reference/winding_solid.hpp>

#include <reference/crossings.hpp>
#include <reference/mesh_measures.hpp>
#include <reference/shapes.hpp>
#include <reference/test_support.hpp>
#include <reference/winding_number.hpp>

#include <gtest/gtest.h>

#include <cmath>

namespace lamina::reference {
namespace {

const Box3 kBox{{-1.01, -1.02, -0.97}, {1.03, 1.04, 1.05}};

/// A sphere with a hole of several triangles, one triangle flipped and one doubled.
TriangleMesh makeDirtySphere() {
    TriangleMesh mesh = makeIcosphere({0.05f, 0.02f, -0.03f}, 0.8f, 3);
    std::erase_if(mesh.triangles, [&](const glm::uvec3& t) {
        const glm::vec3& p = mesh.positions[t.x];
        return p.z > 0.5f && p.x > 0.0f;
    });
    std::swap(mesh.triangles[100].x, mesh.triangles[100].y);
    mesh.triangles.push_back(mesh.triangles[200]);
    return mesh;
}

TEST(WindingSolidTest, TheClosureBalancesEveryEdge) {
    EXPECT_TRUE(closure(makeIcosphere({0, 0, 0}, 1.0f, 2)).triangles.empty());
    const TriangleMesh dirty = makeDirtySphere();
    const TriangleMesh caps = closure(dirty);
    EXPECT_GT(caps.triangles.size(), 10u);
    EXPECT_TRUE(closure(merged(dirty, caps)).triangles.empty());
}

TEST(WindingSolidTest, ClosedMeshesEqualParity) {
    const GridTransform grid = *GridTransform::box(kBox, {31, 33, 40});
    for (const TriangleMesh& mesh : {makeTorusKnot({0, 0, 0}, 0.55f, 0.2f, 2, 3, 128, 16),
                                     makeMengerSponge({0, 0, 0}, 1.8f, 2)})
        EXPECT_TRUE(compare(*insideByWinding(mesh, grid), *inside(mesh, grid))->equal());
}

TEST(WindingSolidTest, OpenMeshesEqualTheSumOverAllTriangles) {
    const GridTransform grid = *GridTransform::box(kBox, {23, 21, 25});
    const TriangleMesh mesh = makeDirtySphere();
    const BitGrid found = *insideByWinding(mesh, grid);
    EXPECT_GT(found.count(), 2000u);
    EXPECT_EQ(differences(found,
                          [&](const glm::ivec3& v) {
                              return windingNumber(mesh, grid.voxelCenter(glm::uvec3(v))) > 0.5;
                          }),
              0u);
}

} // namespace
} // namespace lamina::reference
