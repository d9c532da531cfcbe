// SolidRule::Voted and SolidRule::FloodFill: against their rules spelled out on the host, against
// generalized winding numbers, and against solids that are known before the mesh is damaged.

#include "gl/support/gl_test.hpp"
#include "gl/support/solid.hpp"
#include "gl/support/test_meshes.hpp"
#include "gl/support/voxelize.hpp"

#include <reference/crossings.hpp>
#include <reference/mesh_measures.hpp>
#include <reference/shapes.hpp>
#include <reference/solid_rules.hpp>
#include <reference/winding_solid.hpp>

#include <gmock/gmock.h>

#include <random>

namespace lamina {
namespace {

namespace ref = reference;
using test::NamedMesh;
using test::Solid;
using test::voxelizeSolid;
using testing::HasSubstr;

const Box3 kUnitBox{{-1, -1, -1}, {1, 1, 1}};
/// Votes that the smaller side has at least on a doubtful voxel.
constexpr int kDoubtfulVotes = 5;

/// A cube of voxels around the box.
GridTransform cubicGrid(const Box3& box, std::uint32_t size) {
    const glm::dvec3 middle = (box.min + box.max) * 0.5;
    const glm::dvec3 sides = box.max - box.min;
    const double half = 0.5 * std::max({sides.x, sides.y, sides.z});
    return GridTransform::box({middle - half, middle + half}, glm::uvec3(size)).value();
}

/// Voxels that differ, as a share of those of `expected`.
double errorShare(const BitGrid& found, const BitGrid& expected) {
    const BitGridComparison comparison = compare(found, expected).value();
    return static_cast<double>(comparison.onlyFirst + comparison.onlySecond) /
           static_cast<double>(expected.count());
}

/// Does something to about that share of the triangles, seeded.
template<class Change>
TriangleMesh damaged(TriangleMesh mesh, double share, Change&& change) {
    std::mt19937 random(7);
    std::bernoulli_distribution isHit(share);
    std::vector<glm::uvec3> triangles;
    for (const glm::uvec3& triangle : mesh.triangles)
        if (isHit(random))
            change(triangle, triangles);
        else
            triangles.push_back(triangle);
    mesh.triangles = std::move(triangles);
    return mesh;
}

TriangleMesh withMissing(const TriangleMesh& mesh, double share) {
    return damaged(mesh, share, [](const glm::uvec3&, auto&) {});
}
TriangleMesh withFlipped(const TriangleMesh& mesh, double share) {
    return damaged(mesh, share, [](const glm::uvec3& t, auto& triangles) {
        triangles.push_back({t.x, t.z, t.y});
    });
}
TriangleMesh withDoubled(const TriangleMesh& mesh, double share) {
    return damaged(mesh, share, [](const glm::uvec3& t, auto& triangles) {
        triangles.insert(triangles.end(), {t, t});
    });
}

/// An icosphere and a torus knot beside each other: convex and far from it.
TriangleMesh makeKnotAndBall() {
    return ref::merged(ref::makeTorusKnot({0, 0, 0}, 0.55f, 0.14f, 2, 3, 256, 24),
                       ref::makeIcosphere({0.72f, 0.72f, 0.72f}, 0.22f, 4));
}

class SolidRulesGlTest : public test::GlTest {
protected:
    Solid voted(const TriangleMesh& mesh, const GridTransform& transform) {
        return voxelizeSolid(device(), mesh, transform, SolidRule::Voted);
    }
    Solid flooded(const TriangleMesh& mesh, const GridTransform& transform) {
        return voxelizeSolid(device(), mesh, transform, SolidRule::FloodFill);
    }

    /// Majorities and doubts as counted on the host; at most one voxel in 100,000 of the grid
    /// differs, and two at least may: a line that passes an edge or a centre within rounding.
    void expectVotes(const TriangleMesh& mesh, const GridTransform& transform,
                     const std::string& name) {
        const std::vector<ref::SolidVotes> votes = ref::solidVotes(mesh, transform);
        const Solid solid = voted(mesh, transform);
        const glm::uvec3 size = transform.size();
        std::uint64_t differing = 0;
        std::uint64_t doubtful = 0;
        std::size_t index = 0;
        for (std::uint32_t z = 0; z < size.z; ++z)
            for (std::uint32_t y = 0; y < size.y; ++y)
                for (std::uint32_t x = 0; x < size.x; ++x) {
                    const ref::SolidVotes& vote = votes[index++];
                    const bool isContested = vote.axes > 0 && vote.axes < 6;
                    const int count = vote.axes + vote.diagonals;
                    const bool isSolid = isContested ? count > 7 : vote.axes == 6;
                    const bool isDoubtful =
                        isContested && std::min(count, 14 - count) >= kDoubtfulVotes;
                    doubtful += isDoubtful ? 1 : 0;
                    differing += solid.bits.test({x, y, z}) != isSolid ||
                                         solid.doubtful.test({x, y, z}) != isDoubtful
                                     ? 1
                                     : 0;
                }
        EXPECT_LE(differing, std::max<std::uint64_t>(2, votes.size() / 100000)) << name;
        EXPECT_EQ(solid.report.doubtfulVoxels, solid.doubtful.count()) << name;
        EXPECT_NEAR(static_cast<double>(solid.report.doubtfulVoxels), static_cast<double>(doubtful),
                    2.0 + 1e-5 * static_cast<double>(votes.size()))
            << name;
    }
};

TEST_F(SolidRulesGlTest, VotesAreThoseOfTheHost) {
    // Sizes around words and layers, every axis the longest once; the box cuts most shapes off.
    const Box3 box{{-0.8, -0.93, -0.75}, {0.77, 0.85, 0.9}};
    for (const NamedMesh& shape : test::makeShapes())
        for (const glm::uvec3 size : {glm::uvec3{61, 30, 31}, glm::uvec3{17, 65, 33},
                                      glm::uvec3{5, 9, 161}, glm::uvec3{1, 2, 3}})
            expectVotes(shape.mesh, GridTransform::box(box, size).value(), shape.name);
    for (const Axis axis : {Axis::X, Axis::Y})
        expectVotes(withFlipped(withMissing(makeKnotAndBall(), 0.1), 0.2),
                    GridTransform::box(kUnitBox, {40, 50, 70}, axis).value(), "knot and ball");
}

TEST_F(SolidRulesGlTest, ClosedMeshesOfEitherOrientationEqualParityWithoutDoubt) {
    const TriangleMesh mesh = makeKnotAndBall();
    for (const glm::uvec3 size : {glm::uvec3{101, 83, 129}, glm::uvec3{200, 190, 180}}) {
        const GridTransform transform = GridTransform::box(kUnitBox, size).value();
        const BitGrid expected = ref::inside(mesh, transform).value();
        for (const TriangleMesh& either : {mesh, ref::flipped(mesh)}) {
            const Solid solid = voted(either, transform);
            EXPECT_LE(errorShare(solid.bits, expected), 1e-5); // rounding
            EXPECT_EQ(solid.report.doubtfulVoxels, 0u);
            EXPECT_EQ(solid.report.oddColumns, 0u);
        }
    }
}

TEST_F(SolidRulesGlTest, FacesThroughVoxelCentresAreConsistent) {
    // Vertices, edges and faces on voxel centres: every ray of a centre ends on a tie, and all
    // agree.
    for (const glm::vec3 low : {glm::vec3(1.5f, 2.5f, 3.5f), glm::vec3(1.25f, 2.5f, 3.75f)}) {
        const TriangleMesh box = ref::makeBox(low, {6.5f, 5.5f, 7.5f});
        for (const Axis axis : {Axis::X, Axis::Y, Axis::Z}) {
            const GridTransform transform =
                GridTransform::box({glm::dvec3(0), glm::dvec3(9)}, glm::uvec3(9), axis).value();
            const Solid solid = voted(box, transform);
            EXPECT_TRUE(compare(solid.bits, ref::inside(box, transform).value())->equal());
            EXPECT_EQ(solid.report.doubtfulVoxels, 0u);
        }
    }
}

TEST_F(SolidRulesGlTest, OverlappingPartsAreTheirUnionAndInwardOnesCavities) {
    const GridTransform transform = GridTransform::box(kUnitBox, glm::uvec3(90)).value();
    const TriangleMesh left = ref::makeIcosphere({-0.25f, 0.03f, 0.02f}, 0.6f, 4);
    const TriangleMesh right = ref::makeCube({0.31f, 0.07f, -0.05f}, 0.9f);
    BitGrid both = ref::inside(left, transform).value();
    ref::inside(right, transform).value().forEachSet([&](const glm::uvec3& v) { both.set(v); });
    const TriangleMesh overlapping = ref::merged(left, right);
    for (const TriangleMesh& mesh :
         {overlapping, ref::flipped(overlapping), ref::merged(overlapping, overlapping)}) {
        const Solid solid = voted(mesh, transform);
        EXPECT_LE(errorShare(solid.bits, both), 1e-5);
        EXPECT_EQ(solid.report.doubtfulVoxels, 0u);
    }
    // Parity hollows them out.
    EXPECT_GT(
        errorShare(voxelizeSolid(device(), overlapping, transform, SolidRule::Parity).bits, both),
        0.1);

    const float radii[] = {0.9f, 0.6f, 0.3f};
    const TriangleMesh shells = ref::makeNestedShells({0, 0, 0}, radii, 4);
    EXPECT_LE(errorShare(voted(shells, transform).bits, ref::inside(shells, transform).value()),
              1e-5);
}

TEST_F(SolidRulesGlTest, CrossingsAreCountedBeyondParityAndBeyondTheGrid) {
    // Nested and all outward: windings up to 15 inside, a grid that shows the middle alone.
    TriangleMesh mesh;
    for (int i = 0; i < 15; ++i)
        mesh = ref::merged(
            mesh, ref::makeCube({0.01f, 0.02f, 0.03f}, 1.9f - 0.1f * static_cast<float>(i)));
    for (const double half : {1.0, 0.6, 0.2}) {
        const GridTransform transform =
            GridTransform::box({glm::dvec3(-half), glm::dvec3(half)}, {70, 60, 50}).value();
        const Solid solid = voted(mesh, transform);
        EXPECT_TRUE(
            compare(solid.bits,
                    ref::inside(ref::makeCube({0.01f, 0.02f, 0.03f}, 1.9f), transform).value())
                ->equal());
        EXPECT_EQ(solid.report.doubtfulVoxels, 0u);
    }
}

TEST_F(SolidRulesGlTest, ClosedColumnsDoNotMakeAClosedMesh) {
    // Lid and floor of a box: every line along z goes in and out, parity fills what lies between,
    // and only the other rays see that it is open.
    const GridTransform transform =
        GridTransform::box({glm::dvec3(0), glm::dvec3(40)}, glm::uvec3(40)).value();
    TriangleMesh sheets = ref::makeBox({5.25f, 6.25f, 7.25f}, {33.25f, 30.25f, 28.25f});
    std::erase_if(sheets.triangles, [&](const glm::uvec3& t) {
        return sheets.positions[t.x].z != sheets.positions[t.y].z ||
               sheets.positions[t.x].z != sheets.positions[t.z].z;
    });
    ASSERT_EQ(sheets.triangles.size(), 4u);
    expectVotes(sheets, transform, "lid and floor");
    const BitGrid byParity = voxelizeSolid(device(), sheets, transform, SolidRule::Parity).bits;
    EXPECT_GT(errorShare(voted(sheets, transform).bits, byParity), 0.1);
}

TEST_F(SolidRulesGlTest, CallsLeaveNothingBehind) {
    // One voxelizer for grids of several shapes, and for meshes that end its work after parity,
    // after one axis, after three, and after the diagonals: each as by a voxelizer of its own.
    const TriangleMesh knot = makeKnotAndBall();
    const TriangleMesh overlapping = ref::merged(knot, ref::makeCube({0.1f, 0.0f, 0.1f}, 0.7f));
    auto voxelizer =
        Voxelizer::create(device(), {.coverage = Coverage::Solid, .solidRule = SolidRule::Voted})
            .value();
    auto grid = VoxelGrid::create(device()).value();
    for (const glm::uvec3 size :
         {glm::uvec3{70, 61, 140}, glm::uvec3{40, 30, 33}, glm::uvec3{90, 50, 129}}) {
        const GridTransform transform = GridTransform::box(kUnitBox, size).value();
        for (const TriangleMesh& mesh :
             {withMissing(knot, 0.02), knot, withMissing(overlapping, 0.02), overlapping,
              ref::makePlane({0, 0, 0}, {0.3f, 0.2f, 1.0f}, 1.6f, 7), ref::flipped(knot)}) {
            auto buffers = MeshBuffers::upload(device(), mesh).value();
            const GeometrySource source = buffers.view();
            ASSERT_TRUE(voxelizer->voxelize({&source, 1}, transform, grid));
            const Solid expected = voted(mesh, transform);
            EXPECT_TRUE(compare(grid.download().value(), expected.bits)->equal());
            EXPECT_TRUE(
                compare(voxelizer->downloadDoubtfulVoxels().value(), expected.doubtful)->equal());
            EXPECT_EQ(voxelizer->downloadSolidReport()->doubtfulVoxels,
                      expected.report.doubtfulVoxels);
        }
    }
}

TEST_F(SolidRulesGlTest, DamageIsOutvoted) {
    // A ray meets few triangles, so few rays of a voxel meet a bad one; seven must to make it
    // wrong. Of voxels at the holes themselves that is asked too much, which is the 5 in 10,000
    // allowed for.
    const TriangleMesh whole = makeKnotAndBall();
    const GridTransform transform = GridTransform::box(kUnitBox, glm::uvec3(128)).value();
    const BitGrid expected = ref::inside(whole, transform).value();
    struct Damage {
        const char* name;
        TriangleMesh mesh;
        double most;            ///< Share of wrong voxels.
        std::uint64_t doubtful; ///< At least.
    };
    for (const Damage& damage :
         {Damage{"1 % missing", withMissing(whole, 0.01), 0.0005, 50},
          Damage{"1 % flipped", withFlipped(whole, 0.01), 0.0001, 0},
          Damage{"10 % flipped", withFlipped(whole, 0.1), 0.0001, 1},
          Damage{"half flipped", withFlipped(whole, 0.5), 0.0005, 50},
          Damage{"1 % doubled", withDoubled(whole, 0.01), 0.0001, 20},
          Damage{"all of it", withDoubled(withFlipped(withMissing(whole, 0.01), 0.01), 0.01),
                 0.0005, 50}}) {
        const Solid solid = voted(damage.mesh, transform);
        const double share = errorShare(solid.bits, expected);
        EXPECT_LE(share, damage.most) << damage.name;
        EXPECT_GE(solid.report.doubtfulVoxels, damage.doubtful) << damage.name;
        RecordProperty(damage.name, std::to_string(share));
    }
}

TEST_F(SolidRulesGlTest, InnerWallsAndOpenBoxes) {
    const GridTransform transform =
        GridTransform::box({glm::dvec3(0), glm::dvec3(40)}, glm::uvec3(40)).value();
    const TriangleMesh box = ref::makeBox({5.25f, 6.25f, 7.25f}, {33.25f, 30.25f, 28.25f});
    const BitGrid whole = ref::inside(box, transform).value();
    // A sheet across the inside: edges of three triangles.
    TriangleMesh wall = box;
    const glm::vec3 corners[] = {{19.6f, 6.25f, 7.25f},
                                 {19.6f, 30.25f, 7.25f},
                                 {19.6f, 30.25f, 28.25f},
                                 {19.6f, 6.25f, 28.25f}};
    const auto first = static_cast<std::uint32_t>(wall.positions.size());
    wall.positions.insert(wall.positions.end(), std::begin(corners), std::end(corners));
    wall.triangles.insert(wall.triangles.end(), {glm::uvec3(first, first + 1, first + 2),
                                                 glm::uvec3(first, first + 2, first + 3)});
    EXPECT_TRUE(compare(voted(wall, transform).bits, whole)->equal());
    EXPECT_TRUE(compare(flooded(wall, transform).bits, flooded(box, transform).bits)->equal());

    // Without its lid: rays upward get lost, the others see five faces.
    TriangleMesh open = box;
    std::erase_if(open.triangles, [&](const glm::uvec3& t) {
        return open.positions[t.x].z > 28.0f && open.positions[t.y].z > 28.0f &&
               open.positions[t.z].z > 28.0f;
    });
    ASSERT_EQ(open.triangles.size(), 10u);
    const Solid solid = voted(open, transform);
    EXPECT_LE(errorShare(solid.bits, whole), 0.05);
    const Solid flood = flooded(open, transform);
    EXPECT_EQ(flood.report.enclosedVoxels, 0u);
    EXPECT_EQ(flood.report.doubtfulVoxels, flood.bits.count());
}

TEST_F(SolidRulesGlTest, TheOpenBunnyIsItsWindingNumber) {
    for (const NamedMesh& mesh : test::readRealMeshes({"bunny.ply"})) {
        const GridTransform transform = cubicGrid(mesh.mesh.bounds(), 256);
        const BitGrid expected = ref::insideByWinding(mesh.mesh, transform).value();
        const Solid solid = voted(mesh.mesh, transform);
        const double share = errorShare(solid.bits, expected);
        EXPECT_GT(expected.count(), 3'300'000u) << mesh.name;
        EXPECT_LE(share, 0.003) << mesh.name;
        RecordProperty(mesh.name, std::to_string(share));
        if (ref::isWatertight(mesh.mesh)) {
            EXPECT_EQ(solid.report.doubtfulVoxels, 0u) << mesh.name;
            EXPECT_LE(share, 1e-5) << mesh.name;
        }
        // Damage on top.
        const Solid torn = voted(withMissing(mesh.mesh, 0.01), transform);
        EXPECT_LE(errorShare(torn.bits, expected), 0.003) << mesh.name;
        RecordProperty(mesh.name + " torn", std::to_string(errorShare(torn.bits, expected)));
    }
}

TEST_F(SolidRulesGlTest, PartsAndBatchesMakeNoDifference) {
    const TriangleMesh mesh = withMissing(makeKnotAndBall(), 0.02);
    const GridTransform transform = GridTransform::box(kUnitBox, {70, 61, 300}).value();
    const Solid expected = voted(mesh, transform);
    const Solid flood = flooded(mesh, transform);
    const std::uint64_t limit = device().state()->limits.maxStorageBlockBytes;
    // One layer of 128 slices and 35 rows of cells, or a third of a layer and 13 rows.
    for (const std::uint64_t bytes : {std::uint64_t{75} * 1024, std::uint64_t{30} * 1024}) {
        device().state()->limits.maxStorageBlockBytes = bytes;
        const Solid solid = voted(mesh, transform);
        EXPECT_TRUE(compare(solid.bits, expected.bits)->equal()) << bytes;
        EXPECT_TRUE(compare(solid.doubtful, expected.doubtful)->equal()) << bytes;
        EXPECT_EQ(solid.report.doubtfulVoxels, expected.report.doubtfulVoxels) << bytes;
    }
    device().state()->limits.maxStorageBlockBytes = 75 * 1024;
    const Solid layered = flooded(mesh, transform);
    EXPECT_TRUE(compare(layered.bits, flood.bits)->equal());
    EXPECT_EQ(layered.report.enclosedVoxels, flood.report.enclosedVoxels);
    device().state()->limits.maxStorageBlockBytes = limit;
}

TEST_F(SolidRulesGlTest, AFloodReachesWhatTheHostReaches) {
    for (const NamedMesh& shape : test::makeShapes())
        for (const glm::uvec3 size : {glm::uvec3{61, 30, 31}, glm::uvec3{17, 65, 33},
                                      glm::uvec3{5, 9, 161}, glm::uvec3{1, 2, 3}}) {
            const GridTransform transform = GridTransform::box(kUnitBox, size).value();
            const BitGrid surface = test::voxelize(device(), {.coverage = Coverage::Conservative},
                                                   shape.mesh, transform);
            const BitGrid expected = ref::unreached(surface).value();
            const Solid solid = flooded(shape.mesh, transform);
            EXPECT_TRUE(compare(solid.bits, expected)->equal()) << shape.name;
            EXPECT_EQ(solid.report.doubtfulVoxels, surface.count()) << shape.name;
            EXPECT_EQ(solid.report.enclosedVoxels, expected.count() - surface.count())
                << shape.name;
            EXPECT_TRUE(solid.report.isFloodComplete) << shape.name;
        }
}

/// Sheets across the grid of unit voxels in turn from either side: a passage with a turn a sheet.
TriangleMesh makeBaffles(std::uint32_t count) {
    TriangleMesh mesh =
        ref::makeBox({0.5f, 0.5f, 0.5f}, {31.5f, 31.5f, 0.5f + static_cast<float>(2 * count + 1)});
    // Open at the near end.
    std::erase_if(mesh.triangles, [&](const glm::uvec3& t) {
        return mesh.positions[t.x].z < 1.0f && mesh.positions[t.y].z < 1.0f &&
               mesh.positions[t.z].z < 1.0f;
    });
    for (std::uint32_t i = 0; i < count; ++i) {
        const float z = 0.5f + static_cast<float>(2 * i + 1);
        const float low = i % 2 == 0 ? 0.5f : 3.5f;
        const float high = i % 2 == 0 ? 28.5f : 31.5f;
        const auto first = static_cast<std::uint32_t>(mesh.positions.size());
        for (const glm::vec2 corner : {glm::vec2(low, 0.5f), glm::vec2(high, 0.5f),
                                       glm::vec2(high, 31.5f), glm::vec2(low, 31.5f)})
            mesh.positions.emplace_back(corner, z);
        mesh.triangles.emplace_back(first, first + 1, first + 2);
        mesh.triangles.emplace_back(first, first + 2, first + 3);
    }
    return mesh;
}

TEST_F(SolidRulesGlTest, AFloodFollowsPassagesAndSaysWhenItGivesUp) {
    for (const std::uint32_t turns : {100u, 600u}) {
        const TriangleMesh mesh = makeBaffles(turns);
        const glm::uvec3 size(32, 32, 2 * turns + 3);
        const GridTransform transform =
            GridTransform::box({glm::dvec3(0), glm::dvec3(size)}, size).value();
        const BitGrid surface =
            test::voxelize(device(), {.coverage = Coverage::Conservative}, mesh, transform);
        const Solid solid = flooded(mesh, transform);
        EXPECT_EQ(solid.report.isFloodComplete, turns == 100u);
        EXPECT_EQ(solid.report.enclosedVoxels > 0, turns == 600u);
        EXPECT_EQ(compare(solid.bits, surface)->onlySecond, 0u);
        if (turns == 100u) {
            EXPECT_TRUE(compare(solid.bits, ref::unreached(surface).value())->equal());
        }
    }
}

TEST_F(SolidRulesGlTest, NothingGivesNothing) {
    for (const SolidRule rule : {SolidRule::Voted, SolidRule::FloodFill}) {
        auto voxelizer =
            Voxelizer::create(device(), {.coverage = Coverage::Solid, .solidRule = rule}).value();
        EXPECT_THAT(voxelizer->downloadSolidReport().error().text, HasSubstr("voxelize first"));
        auto grid = VoxelGrid::create(device()).value();
        const GridTransform transform = GridTransform::box(kUnitBox, {8, 9, 10}).value();
        ASSERT_TRUE(voxelizer->voxelize({}, transform, grid));
        EXPECT_EQ(grid.download()->count(), 0u);
        EXPECT_EQ(voxelizer->downloadSolidReport()->doubtfulVoxels, 0u);
        EXPECT_EQ(voxelizer->downloadSolidReport()->enclosedVoxels, 0u);
        if (rule == SolidRule::Voted) {
            EXPECT_EQ(voxelizer->downloadDoubtfulVoxels()->count(), 0u);
        } else {
            EXPECT_THAT(voxelizer->downloadDoubtfulVoxels().error().text,
                        HasSubstr("SolidRule::Voted"));
        }
    }
}

TEST_F(SolidRulesGlTest, OverlapServesTheRulesAndSlicemapParityAlone) {
    for (const SolidRule rule : {SolidRule::Voted, SolidRule::FloodFill}) {
        VoxelizerDesc desc{.coverage = Coverage::Solid, .solidRule = rule};
        const auto chosen = Voxelizer::create(device(), desc).value();
        EXPECT_EQ(chosen->backend(), Backend::Overlap);
        EXPECT_THAT(chosen->reason(), HasSubstr(std::string(name(rule))));
        desc.backend = Backend::Slicemap;
        const auto refused = Voxelizer::create(device(), desc);
        ASSERT_FALSE(refused);
        EXPECT_EQ(refused.error().code, ErrorCode::Unsupported);
        EXPECT_THAT(refused.error().text, HasSubstr("SolidRule::Parity"));
    }
}

TEST_F(SolidRulesGlTest, LimitsAreClearErrors) {
    const TriangleMesh ball = ref::makeIcosphere({0, 0, 0}, 0.9f, 1);
    auto buffers = MeshBuffers::upload(device(), ball).value();
    const GeometrySource source = buffers.view();
    for (const SolidRule rule : {SolidRule::Voted, SolidRule::FloodFill}) {
        auto voxelizer =
            Voxelizer::create(device(), {.coverage = Coverage::Solid, .solidRule = rule}).value();
        auto grid = VoxelGrid::create(device()).value();
        const GridTransform small = GridTransform::box(kUnitBox, {16, 16, 16}).value();
        ASSERT_TRUE(voxelizer->voxelize({&source, 1}, small, grid));
        const BitGrid before = grid.download().value();

        const auto expectError = [&](const glm::uvec3& size, ErrorCode code, const char* text) {
            const auto failed =
                voxelizer->voxelize({&source, 1}, GridTransform::box(kUnitBox, size).value(), grid);
            ASSERT_FALSE(failed);
            EXPECT_EQ(failed.error().code, code);
            EXPECT_THAT(failed.error().text, HasSubstr(text));
            EXPECT_TRUE(compare(grid.download().value(), before)->equal());
        };
        expectError({16385, 1, 1}, ErrorCode::DeviceLimit, "16384 voxels along an axis");
        const std::uint64_t limit = device().state()->limits.maxStorageBlockBytes;
        device().state()->limits.maxStorageBlockBytes = 4096;
        expectError({128, 128, 128}, ErrorCode::DeviceLimit,
                    rule == SolidRule::Voted ? "a plane of voxels" : "columns");
        device().state()->limits.maxStorageBlockBytes = limit;
        device().setMemoryBudget(device().allocatedBytes() + 300'000);
        expectError({128, 128, 128}, ErrorCode::OutOfMemory, "solid");
        device().setMemoryBudget(0);
        ASSERT_TRUE(voxelizer->voxelize({&source, 1}, small, grid));
        EXPECT_TRUE(compare(grid.download().value(), before)->equal());
    }
}

} // namespace
} // namespace lamina
