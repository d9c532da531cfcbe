#include <reference/crossings.hpp>
#include <reference/mesh_measures.hpp>
#include <reference/shapes.hpp>
#include <reference/test_support.hpp>
#include <reference/winding_number.hpp>

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace lamina::reference {
namespace {

std::vector<TriangleMesh> closedMeshes() {
    const glm::vec3 center(16.2f, 15.9f, 16.1f);
    const float radii[] = {13.0f, 9.0f, 5.0f};
    return {makeUvSphere(center, 12.0f, 24, 12),
            makeTorusKnot(center, 8.0f, 2.0f, 2, 3, 200, 12),
            makeMengerSponge(center, 27.0f, 2),
            makeLBlock(center, 20.0f),
            makeNestedShells(center, radii, 3),
            makeTetrahedron({2.03f, 3.17f, 1.11f}, {30.3f, 4.2f, 2.1f}, {5.4f, 29.3f, 3.7f},
                            {11.2f, 9.6f, 30.9f})};
}

TEST(Inside, BoxesHoldTheirVoxelCenters) {
    const GridTransform transform = unitGrid({8, 9, 10});
    const auto between = [](int low, const glm::ivec3& v, int high) {
        return glm::all(glm::greaterThanEqual(v, glm::ivec3(low))) &&
               glm::all(glm::lessThanEqual(v, glm::ivec3(high)));
    };
    const auto onBoundaries = inside(makeBox(glm::vec3(2), glm::vec3(6)), transform);
    EXPECT_EQ(differences(*onBoundaries, [&](const glm::ivec3& v) { return between(2, v, 5); }),
              0u);
    const auto off = inside(makeBox(glm::vec3(2.6f), glm::vec3(5.6f)), transform);
    EXPECT_EQ(differences(*off, [&](const glm::ivec3& v) { return between(3, v, 5); }), 0u);
    // Faces through centres: each row of centres is taken once, not twice and not never.
    const auto through = inside(makeBox(glm::vec3(2.5f), glm::vec3(5.5f)), transform);
    EXPECT_EQ(through->count(), 27u);
    EXPECT_TRUE(through->test({2, 5, 2}));
    EXPECT_FALSE(through->test({2, 5, 5}));
    EXPECT_EQ(inside(flipped(makeBox(glm::vec3(2), glm::vec3(6))), transform)->count(), 64u);
}

TEST(Inside, SphereHoldsTheCentersWithinItsRadius) {
    const glm::dvec3 center(16.3, 15.8, 16.1);
    const double radius = 13.2;
    const TriangleMesh mesh = makeIcosphere(center, radius, 5);
    const double inner = radius * (1.0 - 1e-3);
    const auto bits = inside(mesh, unitGrid(glm::uvec3(32)));
    std::uint64_t undecided = 0;
    EXPECT_EQ(differences(*bits,
                          [&](const glm::ivec3& v) {
                              const double r = glm::distance(glm::dvec3(v) + 0.5, center);
                              if (r > inner && r < radius) {
                                  ++undecided;
                                  return bits->test(v);
                              }
                              return r < radius;
                          }),
              0u);
    EXPECT_LT(undecided, 40u);
}

TEST(Inside, CountTimesVoxelVolumeConvergesToTheVolume) {
    const TriangleMesh tetrahedron = makeTetrahedron({0.03f, 0.05f, 0.02f}, {0.93f, 0.1f, 0.2f},
                                                     {0.2f, 0.95f, 0.1f}, {0.3f, 0.2f, 0.97f});
    const TriangleMesh sphere = makeIcosphere(glm::vec3(0.5f), 0.47f, 5);
    const Box3 unit{glm::dvec3(0.0), glm::dvec3(1.0)};
    for (const TriangleMesh& mesh : {tetrahedron, sphere}) {
        const double volume = signedVolume(mesh);
        for (const unsigned n : {16u, 64u, 128u}) {
            const auto bits = inside(mesh, *GridTransform::box(unit, glm::uvec3(n)));
            const double counted = static_cast<double>(bits->count()) / std::pow(n, 3);
            // Errors of surface voxels are independent: far below surface x voxel size.
            EXPECT_NEAR(counted, volume, 0.1 * surfaceArea(mesh) / n) << n;
        }
        const auto fine = inside(mesh, *GridTransform::box(unit, glm::uvec3(128)));
        EXPECT_NEAR(static_cast<double>(fine->count()) / std::pow(128.0, 3), volume, 1e-3 * volume);
    }
}

TEST(Inside, AgreesWithWindingNumbersAlongEveryAxis) {
    for (const TriangleMesh& mesh : closedMeshes()) {
        const GridTransform grid = unitGrid(glm::uvec3(32));
        const auto alongZ = inside(mesh, grid);
        for (const Axis axis : {Axis::X, Axis::Y}) {
            const auto turned = inside(mesh, unitGrid(glm::uvec3(32), axis))->reoriented(Axis::Z);
            EXPECT_TRUE(compare(*turned, *alongZ)->equal());
        }
        std::mt19937 engine(5);
        int insideCount = 0;
        for (int i = 0; i < 400; ++i) {
            const glm::uvec3 voxel(engine() % 32, engine() % 32, engine() % 32);
            const double winding = windingNumber(mesh, grid.voxelCenter(voxel));
            EXPECT_NEAR(winding, std::round(winding), 1e-6);
            EXPECT_EQ(alongZ->test(voxel), winding > 0.5);
            insideCount += winding > 0.5;
        }
        EXPECT_GT(insideCount, 10);
    }
}

TEST(Inside, ParityIsEvenWhereRaysMeetEdgesAndVertices) {
    for (const TriangleMesh& mesh : closedMeshes()) {
        // Every vertex on a ray through a centre or half a column beside it.
        const GridTransform grid = unitGrid(glm::uvec3(33));
        const TriangleMesh onCenters = snapped(mesh, grid, 2);
        const ColumnCrossings all(onCenters, grid);
        std::size_t crossingCount = 0;
        for (std::uint32_t y = 0; y < 33; ++y)
            for (std::uint32_t x = 0; x < 33; ++x) {
                EXPECT_EQ(all.at({x, y}).size() % 2, 0u) << x << " " << y;
                crossingCount += all.at({x, y}).size();
            }
        EXPECT_GT(crossingCount, 200u);
    }
}

TEST(Inside, EyeInsideASolid) {
    const GridCamera camera = GridCamera::perspective(glm::dmat4(1.0), 1.2, 1.0, 0.5, 20.0);
    const auto grid = GridTransform::camera(camera, {15, 15, 39});
    const TriangleMesh mesh = makeBox({-40, -40, -10.25f}, {40, 40, 7});
    const auto bits = inside(mesh, *grid);
    for (std::uint32_t z = 0; z < 39; ++z)
        EXPECT_EQ(bits->test({7, 4, z}), 0.5 + (z + 0.5) * 0.5 < 10.25) << z;
    const auto list = crossings(mesh, *grid, {7, 4});
    ASSERT_EQ(list.size(), 1u);
    EXPECT_DOUBLE_EQ(depthInside(list, 0.5, 20.0), 10.25 - 0.5);
}

TEST(Crossings, CountsLayersOfParallelQuads) {
    const TriangleMesh mesh = makeParallelQuads({4, 4, 1.25f}, 8, 6, 0.5f);
    const GridTransform grid = unitGrid(glm::uvec3(8));
    const auto list = crossings(mesh, grid, {3, 5});
    ASSERT_EQ(list.size(), 6u);
    for (std::size_t i = 0; i < 6; ++i) {
        EXPECT_DOUBLE_EQ(list[i].depth, 1.25 + 0.5 * static_cast<double>(i));
        EXPECT_FALSE(list[i].frontFacing) << "+z looks away from the camera of a box grid";
        EXPECT_EQ(list[i].triangle / 2, i);
    }
    EXPECT_EQ(crossingsNearer(list, 0.0), 0u);
    EXPECT_EQ(crossingsNearer(list, 1.25), 0u);
    EXPECT_EQ(crossingsNearer(list, 2.0), 2u);
    EXPECT_EQ(crossingsNearer(list, 99.0), 6u);
}

TEST(Crossings, AllColumnsEqualEachColumn) {
    const TriangleMesh mesh = makeTorusKnot({8, 8, 8}, 4.0f, 1.0f, 2, 3, 100, 8);
    GridCamera camera = GridCamera::perspective(glm::dmat4(1.0), 0.8, 1.0, 1.0, 30.0);
    camera.worldToEye[3] = glm::dvec4(-8, -8, -22, 1);
    for (const GridTransform& grid :
         {unitGrid(glm::uvec3(16), Axis::Y), *GridTransform::camera(camera, {16, 16, 16})}) {
        const ColumnCrossings all(mesh, grid);
        std::size_t count = 0;
        for (std::uint32_t y = 0; y < 16; ++y)
            for (std::uint32_t x = 0; x < 16; ++x) {
                const auto one = crossings(mesh, grid, {x, y});
                const auto listed = all.at({x, y});
                ASSERT_EQ(one.size(), listed.size());
                for (std::size_t i = 0; i < one.size(); ++i) {
                    EXPECT_EQ(one[i].triangle, listed[i].triangle);
                    EXPECT_EQ(one[i].depth, listed[i].depth);
                    // A closed, outward-oriented mesh is entered and left in turn.
                    EXPECT_EQ(one[i].frontFacing, i % 2 == 0);
                }
                count += one.size();
            }
        EXPECT_GT(count, 100u);
    }
}

TEST(Crossings, LengthInsideASphereIsItsChord) {
    const double radius = 3.0;
    const TriangleMesh mesh = makeIcosphere({0, 0, -8}, 3, 6);
    const GridCamera camera = GridCamera::perspective(glm::dmat4(1.0), 0.9, 1.0, 2.0, 20.0);
    const auto grid = GridTransform::camera(camera, {21, 21, 8});
    const ColumnCrossings all(mesh, *grid);
    int chords = 0;
    for (std::uint32_t y = 0; y < 21; ++y)
        for (std::uint32_t x = 0; x < 21; ++x) {
            const glm::dvec3 far = grid->gridToWorld({x + 0.5, y + 0.5, 8.0});
            const glm::dvec3 ray = glm::normalize(far);
            EXPECT_NEAR(rayLengthPerDepth(*grid, {x, y}), 1.0 / -ray.z, 1e-12);
            const double along = glm::dot(ray, glm::dvec3(0, 0, -8));
            const double squared = radius * radius - (64.0 - along * along);
            const double chord = squared > 0.0 ? 2.0 * std::sqrt(squared) : 0.0;
            const double length =
                depthInside(all.at({x, y}), 2.0, 20.0) * rayLengthPerDepth(*grid, {x, y});
            EXPECT_NEAR(length * length, chord * chord, 0.03);
            chords += chord > 0.0;
        }
    EXPECT_GT(chords, 100);
    // Only the part between the limits counts.
    const auto middle = all.at({10, 10});
    EXPECT_NEAR(depthInside(middle, 6.0, 7.0), 1.0, 1e-12);
    EXPECT_NEAR(depthInside(middle, 2.0, 6.0), 1.0, 0.01);
    EXPECT_EQ(depthInside(middle, 12.0, 20.0), 0.0);
}

TEST(WindingNumber, IsOneInsideZeroOutsideAndAShareAtHoles) {
    TriangleMesh cube = makeCube(glm::vec3(0), 2);
    EXPECT_NEAR(windingNumber(cube, {0.3, -0.9, 0.99}), 1.0, 1e-12);
    EXPECT_NEAR(windingNumber(cube, {1.3, -0.9, 0.99}), 0.0, 1e-12);
    EXPECT_NEAR(windingNumber(flipped(cube), glm::dvec3(0.1)), -1.0, 1e-12);
    EXPECT_NEAR(windingNumber(merged(cube, makeCube(glm::vec3(0), 4)), glm::dvec3(0.1)), 2.0,
                1e-12);
    cube.triangles.resize(10); // without its last face, a sixth of what the centre sees
    EXPECT_NEAR(windingNumber(cube, glm::dvec3(0.0)), 5.0 / 6.0, 1e-12);
}

} // namespace
} // namespace lamina::reference
