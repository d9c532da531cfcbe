// The overlap backend against the double-precision separating-axis references.

#include "gl/support/gl_test.hpp"
#include "gl/support/test_meshes.hpp"

#include <lamina/voxelize/voxelizer.hpp>

#include <reference/overlap.hpp>
#include <reference/shapes.hpp>

#include <glm/gtc/matrix_transform.hpp>

#include <gmock/gmock.h>

namespace lamina {
namespace {

namespace ref = reference;
using test::NamedMesh;
using testing::AllOf;
using testing::HasSubstr;

class OverlapGlTest : public test::GlTest {
protected:
    BitGrid voxelize(Coverage coverage, std::span<const GeometrySource> sources,
                     const GridTransform& transform) {
        auto voxelizer = Voxelizer::create(device(), {Backend::Overlap, coverage}).value();
        auto grid = VoxelGrid::create(device()).value();
        const auto stats = voxelizer->voxelize(sources, transform, grid);
        EXPECT_TRUE(stats) << stats.error().text;
        return grid.download().value();
    }

    BitGrid voxelize(Coverage coverage, const TriangleMesh& mesh, const GridTransform& transform,
                     const glm::mat4& model = glm::mat4(1.0f)) {
        auto buffers = MeshBuffers::upload(device(), mesh).value();
        const GeometrySource source = buffers.view(model);
        return voxelize(coverage, {&source, 1}, transform);
    }

    /// Both thin coverages: nothing missing, nothing that a voxel grown by 1e-4 would not touch.
    void expectOverlap(const TriangleMesh& mesh, const GridTransform& transform,
                       const std::string& name, const glm::mat4& model = glm::mat4(1.0f)) {
        for (const Coverage coverage : {Coverage::Conservative, Coverage::Separating6}) {
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

TEST_F(OverlapGlTest, ShapesAgreeWithTheReference) {
    const GridTransform transform =
        GridTransform::box({{-1.01, -1.03, -1.02}, {1.04, 1.02, 1.03}}, {101, 83, 128}).value();
    for (const NamedMesh& shape : test::makeShapes())
        expectOverlap(shape.mesh, transform, shape.name);
}

TEST_F(OverlapGlTest, RealMeshesAgreeWithTheReference) {
    for (const NamedMesh& mesh : test::readRealMeshes({"bunny.ply", "armadillo.ply", "dragon.ply"}))
        for (const std::uint32_t size : {256u, 512u})
            expectOverlap(mesh.mesh, GridTransform::box(mesh.mesh.bounds(), glm::uvec3(size)).value(),
                          mesh.name + " " + std::to_string(size));
}

} // namespace
} // namespace lamina
