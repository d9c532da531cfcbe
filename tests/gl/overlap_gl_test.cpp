// The thin coverages of the overlap backend against the double-precision separating-axis
// references.

#include "gl/support/gl_test.hpp"
#include "gl/support/grids.hpp"
#include "gl/support/test_meshes.hpp"
#include "gl/support/voxelize.hpp"

#include <reference/crossings.hpp>
#include <reference/overlap.hpp>
#include <reference/shapes.hpp>

#include <array>
#include <cmath>
#include <deque>

namespace lamina {
namespace {

namespace ref = reference;
using test::NamedMesh;

constexpr std::array kThinCoverages = {Coverage::Conservative, Coverage::Separating6};
const Box3 kUnitBox{{-1, -1, -1}, {1, 1, 1}};

class OverlapGlTest : public test::GlTest {
protected:
    BitGrid voxelize(Coverage coverage, const TriangleMesh& mesh, const GridTransform& transform,
                     const glm::mat4& model = glm::mat4(1.0f)) {
        return test::voxelize(device(), {Backend::Overlap, coverage}, mesh, transform, model);
    }

    /// Nothing missing, nothing that a voxel grown by 1e-4 would not touch.
    void expectOverlap(const TriangleMesh& mesh, const GridTransform& transform,
                       const std::string& name, const glm::mat4& model = glm::mat4(1.0f)) {
        for (const Coverage coverage : kThinCoverages) {
            const BitGrid found = voxelize(coverage, mesh, transform, model);
            const auto reference = [&](double grow) {
                const ref::Options options{.model = glm::dmat4(model), .grow = grow};
                return coverage == Coverage::Conservative
                           ? ref::overlap(mesh, transform, options).value()
                           : ref::separating6(mesh, transform, options).value();
            };
            // Shrunk by what double rounding may decide either way.
            const BitGrid must = reference(-1e-9);
            const BitGrid may = reference(1e-4);
            const std::string what = name + ", " + std::string(lamina::name(coverage));
            EXPECT_EQ(compare(must, found)->onlyFirst, 0u) << what << ": missing voxels";
            EXPECT_EQ(compare(found, may)->onlyFirst, 0u) << what << ": superfluous voxels";
            EXPECT_GT(must.count(), 0u) << what;
        }
    }
};

TEST_F(OverlapGlTest, ShapesAgreeWithTheReferenceAlongEveryAxis) {
    for (const Axis axis : {Axis::X, Axis::Y, Axis::Z})
        for (const NamedMesh& shape : test::makeShapes())
            expectOverlap(shape.mesh, test::shapesGrid({101, 83, 128}, axis),
                          shape.name + " along axis " + std::to_string(static_cast<int>(axis)));
}

TEST_F(OverlapGlTest, ShapesOfLargeTrianglesAgreeWithTheReference) {
    // Triangles of hundreds of voxels, many of them partly outside.
    const GridTransform transform =
        GridTransform::box({{-0.6, -0.8, -0.9}, {0.8, 0.7, 0.95}}, {400, 333, 380}).value();
    for (const NamedMesh& shape : test::makeShapes())
        expectOverlap(shape.mesh, transform, shape.name);
}

TEST_F(OverlapGlTest, CameraGridsAgreeWithTheReference) {
    for (const NamedMesh& shape : test::makeShapes())
        expectOverlap(shape.mesh, test::cameraGrid(Projection::Orthographic, {90, 71, 100}),
                      shape.name);
}

TEST_F(OverlapGlTest, RealMeshesAgreeWithTheReference) {
    for (const NamedMesh& mesh : test::readRealMeshes(
             {"bunny.ply", "armadillo.ply", "dragon.ply", "sponza.ply", "teapot.ply"}))
        for (const std::uint32_t size : {256u, 512u})
            expectOverlap(mesh.mesh,
                          GridTransform::box(mesh.mesh.bounds(), glm::uvec3(size)).value(),
                          mesh.name + " " + std::to_string(size));
}

TEST_F(OverlapGlTest, VerticesOnPowerOfTwoFractionsAgreeWithTheReference) {
    // Contacts of faces, edges and corners with voxel boundaries everywhere.
    for (const NamedMesh& shape : test::makeShapes()) {
        const GridTransform transform = ref::makeDyadicGrid(kUnitBox, {64, 48, 57});
        expectOverlap(ref::snapped(shape.mesh, transform), transform, shape.name);
    }
}

TEST_F(OverlapGlTest, SizesAroundWordsGroupsAndBlocks) {
    const TriangleMesh mesh = ref::makeTorus({0.05f, 0.03f, 0}, 0.7f, 0.25f, 40, 20);
    for (const glm::uvec3 size : {glm::uvec3{1, 1, 1},
                                  {1, 1, 31},
                                  {7, 9, 32},
                                  {8, 8, 33},
                                  {9, 7, 127},
                                  {63, 65, 128},
                                  {64, 1, 129},
                                  {65, 63, 255},
                                  {2049, 5, 3},
                                  {5, 2049, 3},
                                  {3, 5, 1025}})
        expectOverlap(mesh, GridTransform::box({{-1, -1, -0.3}, {1, 1, 0.3}}, size).value(),
                      std::to_string(size.x) + " x " + std::to_string(size.y) + " x " +
                          std::to_string(size.z));
}

TEST_F(OverlapGlTest, ABoxAtAThousandCubedIsItsShell) {
    // Faces inside voxels [20, 1003], [5, 1018] and [64, 960].
    const glm::vec3 low(20.5f, 5.25f, 64.75f);
    const glm::vec3 high(1003.5f, 1018.5f, 960.25f);
    const TriangleMesh mesh = ref::makeBox(low, high);
    const GridTransform transform =
        GridTransform::box({glm::dvec3(0), glm::dvec3(1024)}, glm::uvec3(1024)).value();
    const glm::uvec3 first(20, 5, 64);
    const glm::uvec3 last(1003, 1018, 960);
    const auto cells = [&](unsigned inset) {
        const glm::u64vec3 size = glm::u64vec3(last - first) + std::uint64_t{1} - 2ul * inset;
        return size.x * size.y * size.z;
    };
    const BitGrid found = voxelize(Coverage::Conservative, mesh, transform);
    EXPECT_EQ(found.count(), cells(0) - cells(1));
    std::uint64_t outside = 0;
    found.forEachSet([&](const glm::uvec3& v) {
        const bool isShell = glm::any(glm::equal(v, first)) || glm::any(glm::equal(v, last));
        const bool isInBox =
            glm::all(glm::greaterThanEqual(v, first)) && glm::all(glm::lessThanEqual(v, last));
        outside += isShell && isInBox ? 0 : 1;
    });
    EXPECT_EQ(outside, 0u);
}

TEST_F(OverlapGlTest, AFaceOnAVoxelBoundarySetsBothSides) {
    const TriangleMesh mesh = ref::makePlane({4, 4, 4}, {0, 0, 1}, 2.0f);
    const GridTransform transform =
        GridTransform::box({glm::dvec3(0), glm::dvec3(8)}, glm::uvec3(8)).value();
    // The square [3,5] x [3,5] touches columns 2 to 5.
    const BitGrid found = voxelize(Coverage::Conservative, mesh, transform);
    EXPECT_EQ(found.count(), 2u * 16u);
    for (std::uint32_t y = 2; y <= 5; ++y)
        for (std::uint32_t x = 2; x <= 5; ++x)
            EXPECT_TRUE(found.test({x, y, 3}) && found.test({x, y, 4}));
}

TEST_F(OverlapGlTest, TrianglesThatReachFarBeyondTheGrid) {
    TriangleMesh mesh;
    mesh.positions = {{-3e5f, -2e5f, -1e5f}, {4e5f, -1e5f, 2e5f},  {-1e5f, 5e5f, -5e4f},
                      {-1e7f, 0.3f, 0.2f},   {1e7f, 0.35f, 0.25f}, {0.1f, 1e7f, 0.3f},
                      {0.1f, 0.2f, -1e6f},   {0.15f, 0.22f, 1e6f}, {0.3f, 0.2f, 1e6f}};
    mesh.triangles = {{0, 1, 2}, {3, 4, 5}, {6, 7, 8}};
    expectOverlap(mesh, GridTransform::box(kUnitBox, {70, 60, 130}).value(), "far");
    // Beyond every integer: dropped or clipped, never a stray voxel.
    mesh.positions = {{1e30f, 1e30f, 1e30f}, {2e30f, 1e30f, 1e30f}, {1e30f, 2e30f, 1e30f}};
    mesh.triangles = {{0, 1, 2}};
    EXPECT_EQ(
        voxelize(Coverage::Conservative, mesh, GridTransform::box(kUnitBox, {70, 60, 130}).value())
            .count(),
        0u);
}

TEST_F(OverlapGlTest, SegmentsAndPointsCountAndNonFiniteTrianglesDoNot) {
    const float nan = std::numeric_limits<float>::quiet_NaN();
    const float infinity = std::numeric_limits<float>::infinity();
    TriangleMesh degenerate;
    degenerate.positions = {{-0.8f, -0.7f, -0.9f}, {0.1f, 0.2f, 0.05f}, {0.4f, 0.5f, 0.3666667f},
                            {0.7f, -0.6f, 0.2f},   {0, 0, -1},          {0, 1, -1},
                            {0, 0.5f, 1}};
    degenerate.triangles = {{0, 1, 2}, {3, 3, 3}, {0, 0, 3}, {4, 5, 6}};
    expectOverlap(degenerate, GridTransform::box(kUnitBox, {60, 50, 70}).value(), "degenerate");

    const std::vector<glm::vec3> bad = {{nan, 0, 0}, {1, 0, 0},           {0, 1, 0},
                                        {0, 0, 0},   {infinity, 0, 0},    {0, 1, 0},
                                        {0, 0, 0},   {0, -infinity, nan}, {0, 1, 0}};
    GLuint buffer = 0;
    gl().CreateBuffers(1, &buffer);
    gl().NamedBufferData(buffer, static_cast<GLsizeiptr>(bad.size() * sizeof(glm::vec3)),
                         bad.data(), GL_STATIC_DRAW);
    MeshView view;
    view.vertexBuffer = buffer;
    view.vertexCount = 9;
    const GeometrySource source = view;
    for (const Coverage coverage : {Coverage::Conservative, Coverage::Separating6, Coverage::Solid})
        EXPECT_EQ(test::voxelize(device(), {Backend::Overlap, coverage}, {&source, 1},
                                 GridTransform::box(kUnitBox, {60, 50, 70}).value())
                      .count(),
                  0u);
    gl().DeleteBuffers(1, &buffer);
}

TEST_F(OverlapGlTest, MoreTrianglesThanADispatchTakes) {
    const TriangleMesh many = ref::makeTorusKnot({0, 0, 0}, 0.6f, 0.15f, 3, 5, 4096, 40);
    ASSERT_GT(many.triangles.size(), 262144u);
    expectOverlap(many, GridTransform::box(kUnitBox, {128, 120, 140}).value(), "small");
    // More large ones than one dimension of a dispatch takes: a segment in each row of 40 voxels.
    TriangleMesh rows;
    for (std::uint32_t i = 0; i < 70000; ++i) {
        const glm::vec3 center(0, static_cast<float>(i % 300) + 0.5f,
                               static_cast<float>(i / 300) + 0.5f);
        rows.positions.push_back(center + glm::vec3(0.5f, 0, 0));
        rows.positions.push_back(center + glm::vec3(39.5f, 0, 0));
        rows.triangles.emplace_back(i * 2, i * 2 + 1, i * 2 + 1);
    }
    const GridTransform grid =
        GridTransform::box({{0, 0, 0}, {40, 300, 300}}, {40, 300, 300}).value();
    EXPECT_EQ(voxelize(Coverage::Conservative, rows, grid).count(), 70000u * 40u);
}

TEST_F(OverlapGlTest, GridsOfManyPartsAgreeWithTheReference) {
    // As on a device whose storage bindings are small: layers, then rows, are bound one by one.
    const TriangleMesh mesh = ref::makeTorusKnot({0, 0, 0}, 0.55f, 0.12f, 2, 3, 64, 12);
    const GridTransform transform = GridTransform::box(kUnitBox, {101, 83, 700}).value();
    auto buffers = MeshBuffers::upload(device(), mesh).value();
    const GeometrySource source = buffers.view();
    for (const Coverage coverage : {Coverage::Conservative, Coverage::Solid}) {
        const BitGrid whole =
            test::voxelize(device(), {Backend::Overlap, coverage}, {&source, 1}, transform);
        const DeviceLimits limits = device().limits();
        // Two layers and a half, one, a third.
        for (const std::uint64_t rows : {207u, 84u, 27u}) {
            device().state()->limits.maxStorageBlockBytes = rows * 101 * 16 + 1024;
            device().state()->limits.storageBufferOffsetAlignment = 256;
            auto voxelizer = Voxelizer::create(device(), {Backend::Overlap, coverage}).value();
            auto grid = VoxelGrid::create(device()).value();
            const auto stats = voxelizer->voxelize({&source, 1}, transform, grid).value();
            EXPECT_GT(stats.passes, 2u);
            EXPECT_TRUE(compare(grid.download().value(), whole)->equal()) << rows;
            device().state()->limits = limits;
        }
    }
}

TEST_F(OverlapGlTest, MoreSlicesThanAPart) {
    const TriangleMesh mesh = ref::makeTorus({0, 0, 0}, 0.7f, 0.25f, 40, 20);
    expectOverlap(mesh, GridTransform::box(kUnitBox, {6, 5, 40000}).value(), "40000 slices");
}

/// Voxels that a 6-connected walk reaches from the grid's border without entering `wall`.
BitGrid flooded(const BitGrid& wall) {
    BitGrid reached = BitGrid::create(wall.transform()).value();
    const glm::ivec3 size(wall.size());
    std::deque<glm::ivec3> open;
    const auto enter = [&](const glm::ivec3& voxel) {
        const bool isInGrid = glm::all(glm::greaterThanEqual(voxel, glm::ivec3(0))) &&
                              glm::all(glm::lessThan(voxel, size));
        if (isInGrid && !wall.test(voxel) && !reached.test(voxel)) {
            reached.set(voxel);
            open.push_back(voxel);
        }
    };
    for (int z = 0; z < size.z; ++z)
        for (int y = 0; y < size.y; ++y)
            for (int x = 0; x < size.x; ++x)
                if (x == 0 || y == 0 || z == 0 || x == size.x - 1 || y == size.y - 1 ||
                    z == size.z - 1)
                    enter({x, y, z});
    for (; !open.empty(); open.pop_front())
        for (int axis = 0; axis < 3; ++axis)
            for (const int step : {-1, 1}) {
                glm::ivec3 next = open.front();
                next[axis] += step;
                enter(next);
            }
    return reached;
}

TEST_F(OverlapGlTest, NoSixConnectedPathCrossesAClosedSurface) {
    const GridTransform transform =
        GridTransform::box({{-1.1, -1.1, -1.1}, {1.1, 1.1, 1.1}}, {120, 110, 100}).value();
    for (const NamedMesh& shape : test::makeShapes()) {
        if (shape.name != "icosphere" && shape.name != "torus knot" &&
            shape.name != "tetrahedron" && shape.name != "menger sponge")
            continue;
        const BitGrid inside = ref::inside(shape.mesh, transform).value();
        std::uint64_t thin = 0;
        for (const Coverage coverage : {Coverage::Separating6, Coverage::Conservative}) {
            const BitGrid wall = voxelize(coverage, shape.mesh, transform);
            const BitGrid outside = flooded(wall);
            EXPECT_EQ(compare(inside, outside)->both, 0u) << shape.name << ": leaks";
            // The wall parts something from something.
            EXPECT_GT(compare(inside, wall)->onlyFirst, 0u) << shape.name;
            EXPECT_GT(outside.count(), 0u) << shape.name;
            // Axis-aligned faces set the same voxels either way.
            if (coverage == Coverage::Conservative && shape.name != "menger sponge") {
                EXPECT_LT(thin * 10, wall.count() * 9) << shape.name << ": not thin";
            }
            thin = wall.count();
        }
    }
}

} // namespace
} // namespace lamina
