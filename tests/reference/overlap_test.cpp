#include <reference/crossings.hpp>
#include <reference/filled.hpp>
#include <reference/overlap.hpp>
#include <reference/shapes.hpp>
#include <reference/test_support.hpp>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace lamina::reference {
namespace {

bool isInCube(int low, const glm::ivec3& v, int high) {
    return std::min({v.x, v.y, v.z}) >= low && std::max({v.x, v.y, v.z}) <= high;
}

/// The clear voxels that a walk through faces of clear voxels reaches from the grid's corner.
BitGrid reachableFromCorner(const BitGrid& grid) {
    const glm::ivec3 size(grid.size());
    BitGrid reached = *BitGrid::create(grid.transform());
    std::vector<glm::ivec3> open;
    const auto visit = [&](const glm::ivec3& v) {
        if (glm::any(glm::lessThan(v, glm::ivec3(0))) || glm::any(glm::greaterThanEqual(v, size)) ||
            grid.test(v) || reached.test(v))
            return;
        reached.set(v);
        open.push_back(v);
    };
    visit({0, 0, 0});
    while (!open.empty()) {
        const glm::ivec3 v = open.back();
        open.pop_back();
        for (int axis = 0; axis < 3; ++axis)
            for (const int step : {-1, 1}) {
                glm::ivec3 next = v;
                next[axis] += step;
                visit(next);
            }
    }
    return reached;
}

TEST(Overlap, BoxOffVoxelBoundariesIsAShell) {
    const auto bits = overlap(makeBox(glm::vec3(2.25f), glm::vec3(5.75f)), unitGrid(glm::uvec3(8)));
    EXPECT_EQ(
        differences(*bits,
                    [](const glm::ivec3& v) { return isInCube(2, v, 5) && !isInCube(3, v, 4); }),
        0u);
}

TEST(Overlap, BoxOnVoxelBoundariesTouchesBothSides) {
    for (const Axis axis : {Axis::X, Axis::Y, Axis::Z}) {
        const auto bits =
            overlap(makeBox(glm::vec3(2), glm::vec3(6)), unitGrid(glm::uvec3(8), axis));
        EXPECT_EQ(
            differences(
                *bits, [](const glm::ivec3& v) { return isInCube(1, v, 6) && !isInCube(3, v, 4); }),
            0u);
    }
    const auto shrunk =
        overlap(makeBox(glm::vec3(2), glm::vec3(6)), unitGrid(glm::uvec3(8)), {.grow = -1e-9});
    EXPECT_EQ(shrunk->count(), 0u);
}

TEST(Overlap, MeshBeyondTheGridIsCutOff) {
    const auto bits = overlap(makeBox(glm::vec3(-40.5f), glm::vec3(3.5f)), unitGrid(glm::uvec3(8)));
    EXPECT_EQ(
        differences(*bits,
                    [](const glm::ivec3& v) { return isInCube(0, v, 3) && !isInCube(0, v, 2); }),
        0u);
    EXPECT_EQ(overlap(makeCube(glm::vec3(99), 4), unitGrid(glm::uvec3(8)))->count(), 0u);
    // The outermost voxels are closed too.
    EXPECT_EQ(overlap(makePlane({4, 4, 8}, {0, 0, 1}, 30), unitGrid(glm::uvec3(8)))->count(), 64u);
    EXPECT_EQ(overlap(makePlane({4, 4, 0}, {0, 0, 1}, 30), unitGrid(glm::uvec3(8)))->count(), 64u);
}

TEST(Overlap, SphereShellIsWhereTheSphereIs) {
    const double radius = 27.3;
    const glm::dvec3 center(32.1, 31.7, 32.4);
    const TriangleMesh mesh = makeIcosphere(center, radius, 5);
    // Facets sag inward by at most this much.
    double inner = radius;
    for (const glm::uvec3& t : mesh.triangles) {
        const glm::dvec3 middle =
            (glm::dvec3(mesh.positions[t.x]) + glm::dvec3(mesh.positions[t.y]) +
             glm::dvec3(mesh.positions[t.z])) /
            3.0;
        inner = std::min(inner, glm::distance(middle, center));
    }
    EXPECT_LT(radius - inner, 0.03);
    const auto bits = overlap(mesh, unitGrid(glm::uvec3(64)));
    std::uint64_t sure = 0, wrong = 0;
    differences(*bits, [&](const glm::ivec3& v) {
        const glm::dvec3 low = glm::dvec3(v) - center;
        const glm::dvec3 high = low + 1.0;
        const glm::dvec3 nearest = glm::clamp(glm::dvec3(0.0), low, high);
        const double min = glm::length(nearest);
        const double max = glm::length(glm::max(glm::abs(low), glm::abs(high)));
        const bool set = bits->test(v);
        if (min < inner - 1e-4 && max > radius + 1e-4) {
            ++sure;
            wrong += !set;
        } else if (min > radius + 1e-4 || max < inner - 1e-4) {
            wrong += set;
        }
        return false;
    });
    EXPECT_EQ(wrong, 0u);
    EXPECT_GT(sure, bits->count() * 95 / 100);
}

TEST(Overlap, EqualsDepthSpansInGeneralPosition) {
    // touched() finds the same voxels by depth ranges: nothing in common but the vertices.
    const Box3 around{glm::dvec3(-3.1), glm::dvec3(35.3)};
    const TriangleMesh meshes[] = {
        makeIcosphere({16.1f, 15.7f, 16.3f}, 13.37f, 2),
        makeIcosphere({16.1f, 15.7f, 16.3f}, 13.37f, 6),
        makeTorusKnot({16.1f, 15.7f, 16.3f}, 8.0f, 2.0f, 2, 3, 300, 16),
        makeTriangleSoup(around, 3000, 9.0f, 1),
        makeSlivers(around, 3000, 9.0f, 1e-4f, 2),
    };
    for (const TriangleMesh& mesh : meshes)
        for (const Axis axis : {Axis::X, Axis::Z}) {
            const GridTransform grid = unitGrid({32, 29, 35}, axis);
            const auto bySpans = touched(mesh, grid);
            const auto byAxes = overlap(mesh, grid);
            EXPECT_GT(byAxes->count(), 2000u);
            EXPECT_TRUE(compare(*bySpans, *byAxes)->equal());
            EXPECT_TRUE(isSubset(*filled(mesh, grid), *byAxes));
        }
}

TEST(Overlap, ContainsFilledAlsoOnBoundaries) {
    const GridTransform grid = unitGrid(glm::uvec3(17));
    const TriangleMesh meshes[] = {
        makeMengerSponge({8.5f, 8.5f, 8.5f}, 9.0f, 2),
        snapped(makeTorusKnot({8, 8, 8}, 4.0f, 1.5f, 2, 3, 60, 8), grid, 1),
    };
    for (const TriangleMesh& mesh : meshes) {
        const auto all = overlap(mesh, grid);
        const auto halfOpen = touched(mesh, grid);
        EXPECT_TRUE(isSubset(*halfOpen, *all));
        EXPECT_TRUE(isSubset(*filled(mesh, grid), *all));
        EXPECT_LT(halfOpen->count(), all->count()) << "closed voxels touch on both sides";
    }
}

TEST(Overlap, SameVoxelsAlongEveryAxis) {
    const TriangleMesh mesh = makeTorusKnot({16, 16, 16}, 8.0f, 2.0f, 2, 3, 300, 16);
    const GridTransform reference = makeDyadicGrid(mesh.bounds(), {40, 50, 60});
    const TriangleMesh dyadic = snapped(mesh, reference);
    const auto alongZ = overlap(dyadic, reference);
    for (const Axis axis : {Axis::X, Axis::Y}) {
        const auto turned = GridTransform::box(reference.boxBounds(), {40, 50, 60}, axis);
        const auto bits = overlap(dyadic, *turned)->reoriented(Axis::Z);
        EXPECT_TRUE(compare(*bits, *alongZ)->equal());
    }
}

TEST(Overlap, CameraGridsAreUnitCubesToo) {
    GridCamera camera;
    camera.left = camera.bottom = 0.0;
    camera.right = camera.top = 16.0;
    camera.near = 2.0;
    camera.far = 18.0;
    const auto grid = GridTransform::camera(camera, {16, 16, 16});
    const TriangleMesh mesh = makeIcosphere({8, 8, -10}, 6, 3);
    const auto bits = overlap(mesh, *grid);
    const auto box =
        overlap(transformed(mesh, glm::dmat4(1, 0, 0, 0, 0, 1, 0, 0, 0, 0, -1, 0, 0, 0, -2, 1)),
                unitGrid(glm::uvec3(16)));
    EXPECT_GT(bits->count(), 500u);
    EXPECT_TRUE(compare(*bits, *box)->equal());
}

TEST(Overlap, GrowEnclosesFromBothSides) {
    const TriangleMesh mesh = makeIcosphere({8, 8, 8}, 6, 3);
    const GridTransform grid = unitGrid(glm::uvec3(16));
    const auto must = overlap(mesh, grid, {.grow = -0.01});
    const auto exact = overlap(mesh, grid);
    const auto may = overlap(mesh, grid, {.grow = 0.01});
    EXPECT_TRUE(isSubset(*must, *exact));
    EXPECT_TRUE(isSubset(*exact, *may));
    EXPECT_LT(must->count(), exact->count());
    EXPECT_LT(exact->count(), may->count());
    // A plane half a voxel under voxel 5 is met by a voxel grown by more than that.
    const TriangleMesh plane = makePlane({8, 8, 4.5f}, {0, 0, 1}, 10);
    EXPECT_FALSE(overlap(plane, grid, {.grow = 0.49})->test({8, 8, 5}));
    EXPECT_TRUE(overlap(plane, grid, {.grow = 0.51})->test({8, 8, 5}));
}

TEST(Overlap, RowsOfVoxelsNeedNoTestOnlyIfWhole) {
    const GridTransform grid = unitGrid(glm::uvec3(4));
    TriangleMesh needle;
    needle.triangles = {{0, 1, 2}};
    // Along x through voxels 1 and 2, rising out of a row of smaller ones before it reaches the
    // second.
    needle.positions = {{1.5f, 1.85f, 1.5f}, {2.5f, 1.99f, 1.5f}, {2.5f, 1.98f, 1.5f}};
    EXPECT_EQ(overlap(needle, grid)->count(), 2u);
    EXPECT_EQ(overlap(needle, grid, {.grow = -0.1})->count(), 1u);
    // In a voxel's corner, far from its crosshair.
    needle.positions = {{1.8f, 1.8f, 1.8f}, {1.9f, 1.8f, 1.8f}, {1.8f, 1.9f, 1.9f}};
    EXPECT_EQ(overlap(needle, grid)->count(), 1u);
    EXPECT_EQ(separating6(needle, grid)->count(), 0u);
}

TEST(Overlap, FloatAndThreadsAgree) {
    const TriangleMesh mesh = makeTorusKnot({32, 32, 32}, 16.0f, 4.0f, 2, 3, 400, 30);
    const GridTransform transform = unitGrid(glm::uvec3(64));
    const auto exact = overlap(mesh, transform);
    for (const unsigned threads : {1u, 3u, 16u}) {
        BitGrid grid = *BitGrid::create(transform);
        ASSERT_TRUE(addOverlap<double>(grid, mesh, VoxelShape::Cube, {}, threads));
        EXPECT_TRUE(compare(grid, *exact)->equal());
    }
    BitGrid single = *BitGrid::create(transform);
    ASSERT_TRUE(addOverlap<float>(single, mesh, VoxelShape::Cube));
    const auto comparison = compare(single, *exact);
    EXPECT_LE(comparison->onlyFirst + comparison->onlySecond, exact->count() / 1000);
    EXPECT_TRUE(isSubset(single, *overlap(mesh, transform, {.grow = 1e-4})));
    EXPECT_TRUE(isSubset(*overlap(mesh, transform, {.grow = -1e-4}), single));
}

TEST(Overlap, RefusesGridsWhoseVoxelsAreNoCubes) {
    const TriangleMesh mesh = makeCube({0, 0, -5}, 1);
    const GridCamera camera = GridCamera::perspective(glm::dmat4(1.0), 1.0, 1.0, 1.0, 9.0);
    const auto perspective = GridTransform::camera(camera, {8, 8, 8});
    const auto uneven = GridTransform::box({glm::dvec3(0), glm::dvec3(1)}, {4, 4, 2}, Axis::Z,
                                           SliceDistribution::custom({0.0f, 0.7f, 1.0f}));
    for (const auto& grid : {*perspective, *uneven}) {
        const auto result = overlap(mesh, grid);
        ASSERT_FALSE(result);
        EXPECT_EQ(result.error().code, ErrorCode::Unsupported);
        EXPECT_NE(result.error().text.find("linear slices"), std::string::npos);
    }
    const auto lost = overlap(makeCube({1e12f, 0, 0}, 1e6f), unitGrid(glm::uvec3(4)));
    ASSERT_FALSE(lost);
    EXPECT_EQ(lost.error().code, ErrorCode::InvalidArgument);
    EXPECT_EQ(overlap(TriangleMesh{}, unitGrid(glm::uvec3(4))).error().code,
              ErrorCode::InvalidMesh);
}

TEST(Separating6, PlanesAreOneVoxelThick) {
    const GridTransform grid = unitGrid(glm::uvec3(12));
    for (const int slice : {4, 5}) {
        const auto bits = separating6(makePlane({6, 6, slice + 0.3f}, {0, 0, 1}, 40), grid);
        EXPECT_EQ(differences(*bits, [&](const glm::ivec3& v) { return v.z == slice; }), 0u);
    }
    // A diagonal plane x + y + z = s: centres sum to whole numbers + 1/2; the crosshair reaches
    // half a unit, so s between meets one layer of each residue, three times thinner than cubes.
    const TriangleMesh diagonal = makePlane({5.9f, 5.9f, 5.9f}, {1, 1, 1}, 80);
    const auto thin = separating6(diagonal, grid);
    EXPECT_EQ(differences(*thin,
                          [&](const glm::ivec3& v) {
                              return std::abs(v.x + v.y + v.z + 1.5 - 17.7) <= 0.5;
                          }),
              0u);
}

TEST(Separating6, IsThinAndClosed) {
    const TriangleMesh sphere = makeIcosphere({24.2f, 23.7f, 24.1f}, 17.3f, 4);
    const TriangleMesh knot = makeTorusKnot({24.2f, 23.7f, 24.1f}, 12.0f, 3.5f, 2, 3, 300, 24);
    const GridTransform grid = unitGrid(glm::uvec3(48));
    for (const TriangleMesh& mesh : {sphere, knot}) {
        const auto thin = separating6(mesh, grid);
        const auto thick = overlap(mesh, grid);
        EXPECT_TRUE(isSubset(*thin, *thick));
        EXPECT_LT(thin->count(), thick->count() * 7 / 10);
        // Between a centre outside and one inside, the surface crosses one of two crosshairs.
        const BitGrid outside = reachableFromCorner(*thin);
        EXPECT_GT(outside.count(), 10000u);
        EXPECT_EQ(compare(outside, *inside(mesh, grid))->both, 0u);
    }
    // The walk does get in through a hole of one column.
    BitGrid holed = *separating6(sphere, grid);
    for (std::uint32_t z = 0; z < 12; ++z)
        holed.set({24, 24, z}, false);
    EXPECT_GT(compare(reachableFromCorner(holed), *inside(sphere, grid))->both, 10000u);
}

} // namespace
} // namespace lamina::reference
