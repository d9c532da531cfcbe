// Triangles up to ten million times as large as the grid: the raster backends lose none of their
// columns.

#include "gl/support/gl_test.hpp"
#include "gl/support/voxelize.hpp"

#include <reference/filled.hpp>
#include <reference/sampled.hpp>

#include <array>
#include <cmath>
#include <string>

namespace lamina {
namespace {

namespace ref = reference;

/// In halves of the grid's side: below, at and far beyond where rasterizers begin to lose columns.
constexpr std::array kSizes{200.0, 1e5, 2e7};

/// Of coordinates in double precision: what either side may decide either way, in voxels.
constexpr double kTolerance = 1e-4;

constexpr glm::uvec3 kVoxels{256, 240, 24};

GridTransform boxGrid() {
    return GridTransform::box({glm::dvec3(-1), glm::dvec3(1)}, kVoxels).value();
}

/// A triangle of the plane z = 0.1 + 0.2 x - 0.3 y: `size` from corner to middle, turned by
/// `angle`, its middle at `middle`.
TriangleMesh tilted(double size, double angle, const glm::dvec2& middle) {
    TriangleMesh mesh;
    for (int i = 0; i < 3; ++i) {
        const double turned = angle + 2.0943951 * i;
        const glm::dvec2 p = middle + size * glm::dvec2(std::cos(turned), std::sin(turned));
        mesh.positions.emplace_back(p.x, p.y, 0.1 + 0.2 * p.x - 0.3 * p.y);
    }
    mesh.triangles = {{0, 1, 2}};
    return mesh;
}

/// Around the grid, with an edge through it, and beside it.
std::vector<TriangleMesh> trianglesOf(double size) {
    std::vector<TriangleMesh> meshes;
    for (const double angle : {0.3, 2.0}) {
        meshes.push_back(tilted(size, angle, {0.1, -0.2}));
        // The edge opposite to corner 0 passes at half the size from the middle.
        const glm::dvec2 toCorner(std::cos(angle), std::sin(angle));
        meshes.push_back(tilted(size, angle, 0.5 * size * toCorner));
        meshes.push_back(tilted(size, angle, (0.5 * size + 3.0) * toCorner));
    }
    return meshes;
}

class LargeTriangleGlTest : public test::GlTest {
protected:
    BitGrid voxelize(const VoxelizerDesc& desc, const TriangleMesh& mesh,
                     const GridTransform& transform) {
        return test::voxelize(device(), desc, mesh, transform);
    }

    /// Sampled: the reference's voxels, but for depths that rounding takes across a slice's
    /// boundary.
    void expectSampled(const TriangleMesh& mesh, const GridTransform& transform,
                       const std::string& name) {
        const BitGrid expected = ref::sampled(mesh, transform).value();
        for (const Backend backend : {Backend::Slicemap, Backend::Volume}) {
            const auto found = compare(expected, voxelize({.backend = backend}, mesh, transform));
            EXPECT_LE(found->onlyFirst, 4u) << name << lamina::name(backend) << ": missing";
            EXPECT_LE(found->onlySecond, 4u) << name << lamina::name(backend) << ": superfluous";
        }
    }

    /// Filled and Conservative: nothing missing, nothing beyond the tolerance.
    void expectSpans(const TriangleMesh& mesh, const GridTransform& transform,
                     const std::string& name) {
        const auto expect = [&](const VoxelizerDesc& desc, auto&& reference) {
            const BitGrid found = voxelize(desc, mesh, transform);
            const BitGrid must =
                reference(mesh, transform, ref::Options{.grow = -kTolerance}).value();
            const BitGrid may =
                reference(mesh, transform, ref::Options{.grow = kTolerance}).value();
            EXPECT_EQ(compare(must, found)->onlyFirst, 0u)
                << name << lamina::name(desc.coverage) << ": missing of " << must.count();
            EXPECT_EQ(compare(found, may)->onlyFirst, 0u)
                << name << lamina::name(desc.coverage) << ": superfluous of " << found.count();
        };
        expect({Backend::MrtSlicemap, Coverage::Filled}, ref::filled);
        expect({Backend::Slicemap, Coverage::Conservative}, ref::touched);
    }
};

std::string caseName(int number, double size) {
    return "triangle " + std::to_string(number) + " of size " + std::to_string(size) + ", ";
}

TEST_F(LargeTriangleGlTest, BoxGridsLoseNoVoxel) {
    const GridTransform transform = boxGrid();
    for (const double size : kSizes) {
        int number = 0;
        for (const TriangleMesh& mesh : trianglesOf(size)) {
            expectSampled(mesh, transform, caseName(number, size));
            if (number < 3)
                expectSpans(mesh, transform, caseName(number, size));
            ++number;
        }
    }
}

TEST_F(LargeTriangleGlTest, LocalRangesEncloseThem) {
    const GridTransform transform = boxGrid();
    const TriangleMesh mesh = tilted(2e7, 0.3, {0.1, -0.2});
    const glm::dvec3 corner = mesh.positions[0];
    const glm::dvec3 normal =
        glm::cross(glm::dvec3(mesh.positions[1]) - corner, glm::dvec3(mesh.positions[2]) - corner);
    const BitGrid grid = voxelize({Backend::LocalSlicemap, Coverage::Filled}, mesh, transform);
    for (std::uint32_t y = 0; y < kVoxels.y; ++y)
        for (std::uint32_t x = 0; x < kVoxels.x; ++x) {
            const glm::dvec3 front = transform.gridToWorld({x + 0.5, y + 0.5, 0.0});
            const double depth = glm::dot(corner - front, normal) / normal.z;
            const ColumnRange range = grid.columnRange({x, y});
            // A column's own share of the slopes.
            ASSERT_NEAR(range.near, depth, 0.01) << x << ", " << y;
            ASSERT_NEAR(range.far, depth, 0.01) << x << ", " << y;
        }
}

TEST_F(LargeTriangleGlTest, PerspectiveGridsLoseNoVoxel) {
    // A floor from far behind the eye to far beyond the grid, and a wall before it.
    const GridTransform transform =
        GridTransform::camera(GridCamera::perspective(glm::dmat4(1.0), 0.9, 1.2, 0.1, 20.0),
                              {180, 150, 60})
            .value();
    for (const double size : {1e5, 1e7}) {
        const auto s = static_cast<float>(size);
        TriangleMesh floor;
        floor.positions = {{-s, -0.5f, 0.6f * s}, {s, -0.5f, 0.6f * s}, {0.1f * s, -0.5f, -s}};
        floor.triangles = {{0, 1, 2}};
        expectSampled(floor, transform, "floor of " + std::to_string(size) + ", ");
        TriangleMesh wall;
        wall.positions = {{-s, -s, -7.0f}, {s, -s, -7.5f}, {0, s, -6.5f}};
        wall.triangles = {{0, 1, 2}};
        expectSampled(wall, transform, "wall of " + std::to_string(size) + ", ");
    }
}

TEST_F(LargeTriangleGlTest, SolidsAreWhole) {
    // A tetrahedron whose lowest face passes through the grid.
    const GridTransform transform = boxGrid();
    for (const double size : kSizes) {
        TriangleMesh mesh = tilted(size, 0.3, {0.1, -0.2});
        mesh.positions.emplace_back(0.0f, 0.0f, static_cast<float>(size));
        mesh.triangles = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}};
        const std::array<glm::dvec3, 3> face{mesh.positions[0], mesh.positions[1],
                                             mesh.positions[2]};
        const glm::dvec3 normal = glm::normalize(glm::cross(face[1] - face[0], face[2] - face[0]));
        for (const Backend backend : {Backend::Slicemap, Backend::MrtSlicemap}) {
            const BitGrid found = voxelize({backend, Coverage::Solid}, mesh, transform);
            std::uint64_t wrong = 0;
            for (std::uint32_t z = 0; z < kVoxels.z; ++z)
                for (std::uint32_t y = 0; y < kVoxels.y; ++y)
                    for (std::uint32_t x = 0; x < kVoxels.x; ++x) {
                        const glm::uvec3 voxel(x, y, z);
                        const double above =
                            glm::dot(normal, transform.voxelCenter(voxel) - face[0]);
                        if (std::abs(above) > kTolerance && found.test(voxel) != (above > 0.0))
                            ++wrong;
                    }
            EXPECT_EQ(wrong, 0u) << lamina::name(backend) << ", size " << size;
        }
    }
}

} // namespace
} // namespace lamina
