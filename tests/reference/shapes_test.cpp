#include <reference/mesh_measures.hpp>
#include <reference/shapes.hpp>

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>

namespace lamina::reference {
namespace {

constexpr double kPi = std::numbers::pi;

struct Solid {
    std::string name;
    TriangleMesh mesh;
    double volume;
    double tolerance; ///< Relative; what the facets cut off, or float rounding for flat faces.
};

std::vector<Solid> solids() {
    const glm::vec3 center(0.5f, -1.0f, 2.0f);
    const float radii[] = {2.0f, 1.5f, 1.0f};
    // The knot's length, by summing its chords.
    double knotLength = 0.0;
    const auto knotAt = [](double t) {
        const double reach = 1.0 + 0.5 * std::cos(3.0 * t);
        return glm::dvec3(reach * std::cos(2.0 * t), reach * std::sin(2.0 * t),
                          0.5 * std::sin(3.0 * t));
    };
    for (int i = 0; i < 10000; ++i)
        knotLength +=
            glm::distance(knotAt(2.0 * kPi * i / 10000), knotAt(2.0 * kPi * (i + 1) / 10000));
    return {
        {"box", makeBox({-1, -2, -3}, {1, 3, 0.5f}), 2 * 5 * 3.5, 1e-9},
        {"cube", makeCube(center, 1.5f), 1.5 * 1.5 * 1.5, 1e-9},
        {"tetrahedron", makeTetrahedron({0, 0, 0}, {1, 0, 0}, {0, 2, 0}, {0, 0, 3}), 1.0, 1e-9},
        {"tetrahedron, other order", makeTetrahedron({1, 0, 0}, {0, 0, 0}, {0, 2, 0}, {0, 0, 3}),
         1.0, 1e-9},
        {"uv sphere", makeUvSphere(center, 1.25f, 128, 64), 4.0 / 3.0 * kPi * std::pow(1.25, 3),
         2e-3},
        {"smallest uv sphere", makeUvSphere(center, 1.0f, 3, 2), std::sqrt(3.0) / 2.0, 1e-6},
        {"icosphere", makeIcosphere(center, 1.25f, 5), 4.0 / 3.0 * kPi * std::pow(1.25, 3), 2e-3},
        {"torus", makeTorus(center, 2.0f, 0.5f, 128, 64), 2.0 * kPi * kPi * 2.0 * 0.25, 3e-3},
        // Pappus: a tube's volume is its section times its centre line.
        {"torus knot", makeTorusKnot(center, 1.0f, 0.1f, 2, 3, 1024, 64), kPi * 0.01 * knotLength,
         3e-3},
        {"cube as sponge of level 0", makeMengerSponge(center, 3.0f, 0), 27.0, 1e-6},
        {"menger sponge", makeMengerSponge(center, 3.0f, 2), 27.0 * std::pow(20.0 / 27.0, 2), 1e-6},
        {"L block", makeLBlock(center, 2.0f), 6.0, 1e-6},
        {"nested shells", makeNestedShells(center, radii, 5), 4.0 / 3.0 * kPi * (8.0 - 3.375 + 1.0),
         2e-3},
    };
}

TEST(Shapes, SolidsAreClosedOutwardAndOfTheirVolume) {
    for (const Solid& solid : solids()) {
        SCOPED_TRACE(solid.name);
        EXPECT_TRUE(validate(solid.mesh));
        EXPECT_TRUE(isWatertight(solid.mesh));
        EXPECT_NEAR(signedVolume(solid.mesh), solid.volume, solid.tolerance * solid.volume);
    }
}

TEST(Shapes, MeasuresNoticeHolesAndFlips) {
    TriangleMesh holed = makeCube(glm::vec3(0.0f), 1.0f);
    EXPECT_NEAR(signedVolume(flipped(holed)), -1.0, 1e-12);
    EXPECT_TRUE(isWatertight(flipped(holed)));
    std::swap(holed.triangles[3].x, holed.triangles[3].y);
    EXPECT_FALSE(isWatertight(holed));
    holed.triangles.pop_back();
    EXPECT_FALSE(isWatertight(holed));
}

TEST(Shapes, CountsAreAsPromised) {
    EXPECT_EQ(makeBox(glm::vec3(0), glm::vec3(1)).triangles.size(), 12u);
    EXPECT_EQ(makeUvSphere(glm::vec3(0), 1, 10, 7).triangles.size(), 2u * 10 * 6);
    EXPECT_EQ(makeIcosphere(glm::vec3(0), 1, 3).triangles.size(), 20u * 64);
    EXPECT_EQ(makeTorus(glm::vec3(0), 2, 1, 9, 5).triangles.size(), 2u * 9 * 5);
    EXPECT_EQ(makePlane(glm::vec3(0), {1, 2, 3}, 1, 4).triangles.size(), 2u * 16);
    EXPECT_EQ(makeParallelQuads(glm::vec3(0), 1, 7, 0.1f).triangles.size(), 14u);
    EXPECT_EQ(makeSlivers({glm::dvec3(0), glm::dvec3(1)}, 33, 0.1f, 1e-4f, 1).triangles.size(),
              33u);
    EXPECT_EQ(makeTriangleSoup({glm::dvec3(0), glm::dvec3(1)}, 33, 0.1f, 1).triangles.size(), 33u);
    EXPECT_EQ(makeFan(glm::vec3(0), 1, 11, 1).triangles.size(), 11u);
}

TEST(Shapes, PlaneFacesItsNormalThroughItsCenter) {
    for (const glm::vec3 normal : {glm::vec3(0, 0, 1), glm::vec3(0, -3, 0), glm::vec3(1, 2, -2)}) {
        const glm::vec3 center(1, 2, 3);
        const TriangleMesh mesh = makePlane(center, normal, 2.0f, 3);
        EXPECT_NEAR(surfaceArea(mesh), 4.0, 1e-5);
        for (const glm::uvec3& t : mesh.triangles) {
            const glm::vec3 a = mesh.positions[t.x];
            const glm::vec3 n =
                glm::normalize(glm::cross(mesh.positions[t.y] - a, mesh.positions[t.z] - a));
            EXPECT_NEAR(glm::dot(n, glm::normalize(normal)), 1.0f, 1e-5f);
            EXPECT_NEAR(glm::dot(a - center, normal), 0.0f, 1e-5f);
        }
    }
}

TEST(Shapes, RandomShapesStayInsideTheirBounds) {
    const Box3 bounds{glm::dvec3(-1, 0, 2), glm::dvec3(3, 2, 4)};
    for (const TriangleMesh& mesh :
         {makeSlivers(bounds, 500, 0.5f, 1e-3f, 7), makeTriangleSoup(bounds, 500, 0.5f, 7)}) {
        const Box3 box = mesh.bounds();
        for (int axis = 0; axis < 3; ++axis) {
            EXPECT_GE(box.min[axis], bounds.min[axis] - 1e-3);
            EXPECT_LE(box.max[axis], bounds.max[axis] + 1e-3);
            EXPECT_GT(box.size()[axis], 0.8 * bounds.size()[axis]);
        }
    }
    const TriangleMesh slivers = makeSlivers(bounds, 500, 0.5f, 1e-3f, 7);
    EXPECT_NEAR(surfaceArea(slivers), 500 * 0.5 * 0.5 * 1e-3, 1e-4);
}

TEST(Shapes, SnappedVerticesAreExactInDyadicGrids) {
    const TriangleMesh mesh = makeIcosphere({0.3f, -0.2f, 0.1f}, 0.7f, 3);
    for (const Axis axis : {Axis::X, Axis::Y, Axis::Z}) {
        const GridTransform grid = makeDyadicGrid(mesh.bounds(), {40, 31, 57}, axis);
        const TriangleMesh moved = snapped(mesh, grid);
        for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
            const glm::dvec3 steps = 16.0 * grid.worldToGrid(moved.positions[i]);
            const glm::dvec3 before = 16.0 * grid.worldToGrid(mesh.positions[i]);
            for (int k = 0; k < 3; ++k) {
                EXPECT_EQ(steps[k], std::round(steps[k]));
                EXPECT_LE(std::abs(steps[k] - before[k]), 0.5);
            }
        }
    }
}

TEST(Shapes, DyadicGridHoldsItsBoundsWithoutWaste) {
    for (const unsigned voxels : {1u, 7u, 64u})
        for (const double offset : {0.0, 0.3, -17.7}) {
            const Box3 bounds{glm::dvec3(offset - 1.0), glm::dvec3(offset + 1.0)};
            const GridTransform grid = makeDyadicGrid(bounds, glm::uvec3(voxels));
            const Box3& box = grid.boxBounds();
            int exponent = 0;
            EXPECT_EQ(std::frexp(box.size().x / voxels, &exponent), 0.5);
            for (int axis = 0; axis < 3; ++axis) {
                EXPECT_LE(box.min[axis], bounds.min[axis]);
                EXPECT_GE(box.max[axis], bounds.max[axis]);
                EXPECT_LE(box.size()[axis], 4.0 * bounds.size()[axis]);
            }
        }
}

} // namespace
} // namespace lamina::reference
