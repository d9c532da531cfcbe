// Attributes of set voxels against the double-precision reference that clips triangles to voxels.

#include "gl/support/gl_test.hpp"
#include "gl/support/test_meshes.hpp"

#include <lamina/grid/attribute_grid.hpp>
#include <lamina/voxelize/attribute_voxelizer.hpp>
#include <lamina/voxelize/voxelizer.hpp>

#include <reference/attributes.hpp>
#include <reference/shapes.hpp>

#include <glm/geometric.hpp>
#include <glm/gtc/matrix_transform.hpp>

#include <cmath>
#include <random>

namespace lamina {
namespace {

namespace ref = reference;
using test::NamedMesh;

/// By how much the device enlarges voxels (LAMINA_OVERLAP_ALLOWANCE).
constexpr double kGrow = 4e-5;
/// Parts of the largest section of a voxel in which areas are counted (LAMINA_WEIGHT_ONE).
constexpr double kAreaSteps = 1048576.0;

/// Colours of all channels and normals that vary from vertex to vertex.
TriangleMesh painted(TriangleMesh mesh, bool withNormals = true) {
    std::mt19937 random(5);
    std::uniform_real_distribution<float> unit(0.0f, 1.0f);
    mesh.colors.clear();
    mesh.normals.clear();
    for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
        mesh.colors.emplace_back(unit(random), unit(random), unit(random), unit(random));
        if (withNormals)
            mesh.normals.push_back(glm::normalize(
                glm::vec3(unit(random), unit(random), unit(random)) - glm::vec3(0.4f)));
    }
    return mesh;
}

/// Length of the vector of a voxel's three faces, world units squared: no section is larger.
double largestSection(const GridTransform& transform) {
    const auto edge = [&](const glm::dvec3& step) {
        return transform.gridToWorld(step) - transform.gridToWorld(glm::dvec3(0.0));
    };
    const glm::dvec3 x = edge({1, 0, 0}), y = edge({0, 1, 0}), z = edge({0, 0, 1});
    return glm::length(glm::dvec3(glm::length(glm::cross(x, y)), glm::length(glm::cross(y, z)),
                                  glm::length(glm::cross(z, x))));
}

class AttributesGlTest : public test::GlTest {
protected:
    struct Result {
        BitGrid bits;
        AttributeGrid attributes;
        AttributeStats stats;
    };

    Result voxelize(std::span<const GeometrySource> sources, const GridTransform& transform,
                    Coverage coverage = Coverage::Conservative,
                    std::span<const Material> materials = {}) {
        auto voxelizer = Voxelizer::create(device(), {.coverage = coverage}).value();
        auto grid = VoxelGrid::create(device()).value();
        EXPECT_TRUE(voxelizer->voxelize(sources, transform, grid));
        auto attributeVoxelizer = AttributeVoxelizer::create(device());
        EXPECT_TRUE(attributeVoxelizer) << attributeVoxelizer.error().text;
        auto attributes = VoxelAttributes::create(device()).value();
        const auto stats = attributeVoxelizer->voxelize(sources, materials, grid, attributes);
        EXPECT_TRUE(stats) << stats.error().text;
        auto data = attributes.download();
        EXPECT_TRUE(data) << data.error().text;
        return {grid.download().value(), std::move(*data), *stats};
    }

    Result voxelize(const TriangleMesh& mesh, const GridTransform& transform,
                    Coverage coverage = Coverage::Conservative,
                    const glm::mat4& model = glm::mat4(1.0f)) {
        auto buffers = MeshBuffers::upload(device(), mesh).value();
        const GeometrySource source = buffers.view(model);
        return voxelize({&source, 1}, transform, coverage);
    }

    void expectMeans(const TriangleMesh& mesh, const GridTransform& transform,
                     const std::string& name, Coverage coverage = Coverage::Conservative,
                     const glm::mat4& model = glm::mat4(1.0f)) {
        const Result found = voxelize(mesh, transform, coverage, model);
        expectMeans(found, mesh, transform, name, model);
    }

    /// Colours within one step of 8 bits and normals within 0.04 degree in all voxels but for what
    /// the step of areas makes, a share of 1 / 2^20 of the section for each hit, and where normals
    /// cancel out in part.
    void expectMeans(const Result& found, const TriangleMesh& mesh, const GridTransform& transform,
                     const std::string& name, const glm::mat4& model = glm::mat4(1.0f)) {
        const auto exact =
            ref::surfaces(mesh, found.bits, {.model = glm::dmat4(model), .grow = kGrow});
        const auto must =
            ref::surfaces(mesh, found.bits, {.model = glm::dmat4(model), .grow = -1e-9});
        const auto may =
            ref::surfaces(mesh, found.bits, {.model = glm::dmat4(model), .grow = 1e-4});
        ASSERT_EQ(found.attributes.colors.size(), exact.size()) << name;
        const double section = largestSection(transform);
        double worstColor = 0.0, worstNormal = 0.0;
        std::size_t compared = 0;
        for (std::size_t i = 0; i < exact.size(); ++i) {
            EXPECT_GE(found.attributes.hits[i], must[i].hits) << name << " voxel " << i;
            EXPECT_LE(found.attributes.hits[i], may[i].hits) << name << " voxel " << i;
            // What single precision (1e-6 of the section) and the step of areas may move, as a
            // share of the area there is.
            const double doubt =
                exact[i].hits * section * (1.0 / kAreaSteps + 1e-6) / exact[i].area;
            if (!(doubt < 0.01))
                continue;
            ++compared;
            const glm::dvec4 color = exact[i].color / exact[i].area;
            for (int channel = 0; channel < 4; ++channel) {
                const double off =
                    std::abs(found.attributes.colors[i][channel] - 255.0 * color[channel]);
                worstColor = std::max(worstColor, off - 255.0 * doubt);
            }
            const glm::dvec3 mean = exact[i].normal / exact[i].area;
            if (glm::length(mean) < 0.1)
                continue;
            // By the sine: the cosine of small angles says little. A missing normal is 90 degrees
            // off.
            const glm::dvec3 normal(found.attributes.normals[i]);
            const double sine = glm::length(glm::cross(glm::normalize(mean), normal));
            const double angle =
                glm::dot(mean, normal) > 0.0 ? glm::degrees(std::asin(std::min(1.0, sine))) : 90.0;
            // 12 bits of each hit's components, and what they and the areas may turn a mean shorter
            // than 1 by.
            const double turn = (std::sqrt(3.0) * 0.5 / 2047.0 + 2.0 * doubt) / glm::length(mean);
            worstNormal = std::max(worstNormal, angle - glm::degrees(turn));
        }
        EXPECT_LE(worstColor, 1.0) << name;
        EXPECT_LE(worstNormal, 0.01) << name; // of 16-bit octahedral pairs
        // Needles snapped to segments leave few voxels with an area.
        EXPECT_GT(compared, exact.size() / 5) << name;
    }
};

const Box3 kBox{{-1.01, -1.03, -1.02}, {1.04, 1.02, 1.03}};

TEST_F(AttributesGlTest, MeansOfShapesAgreeWithTheReference) {
    for (const Axis axis : {Axis::X, Axis::Y, Axis::Z})
        for (const NamedMesh& shape : test::makeShapes())
            expectMeans(painted(shape.mesh), GridTransform::box(kBox, {31, 23, 70}, axis).value(),
                        shape.name + " along axis " + std::to_string(static_cast<int>(axis)));
}

TEST_F(AttributesGlTest, MeansOfLargeTrianglesAgreeWithTheReference) {
    const GridTransform transform =
        GridTransform::box({{-0.6, -0.8, -0.9}, {0.8, 0.7, 0.95}}, {150, 133, 260}).value();
    TriangleMesh large = ref::makeBox({-0.55f, -0.7f, -0.8f}, {0.7f, 0.6f, 1.9f});
    TriangleMesh slanted;
    slanted.positions = {
        {-3, -1, -2}, {2, 2.5f, 0.5f}, {0.3f, -2, 3}, {0.2f, 0.21f, -1e4f}, {0.25f, 0.2f, 1e4f}};
    slanted.triangles = {{0, 1, 2}, {0, 3, 4}, {2, 3, 1}};
    expectMeans(painted(large), transform, "box");
    expectMeans(painted(slanted), transform, "slanted");
    // Every slice of a vertical plane falls to one invocation: no loop may run out.
    expectMeans(painted(ref::makePlane({0.01f, 0.02f, 0}, {1, 0, 0}, 1.9f)),
                GridTransform::box(kBox, {16, 256, 1024}).value(), "vertical");
}

TEST_F(AttributesGlTest, MeansOnPowerOfTwoFractionsAgreeWithTheReference) {
    // Faces, edges and corners on voxel boundaries everywhere: what lies between two voxels counts
    // in both, once.
    const Box3 unit{{-1, -1, -1}, {1, 1, 1}};
    for (const NamedMesh& shape : test::makeShapes()) {
        const GridTransform transform = ref::makeDyadicGrid(unit, {32, 24, 29});
        expectMeans(painted(ref::snapped(shape.mesh, transform, 2)), transform, shape.name);
    }
}

TEST_F(AttributesGlTest, MeansOfCoveragesGridsAndModelsAgreeWithTheReference) {
    const TriangleMesh knot = painted(ref::makeTorusKnot({0, 0, 0}, 0.5f, 0.2f, 2, 3, 64, 12));
    const GridTransform transform = GridTransform::box(kBox, {40, 50, 60}).value();
    // Sampled and Filled make grids in textures, the others in buffers.
    for (const Coverage coverage : {Coverage::Sampled, Coverage::Filled, Coverage::Separating6})
        expectMeans(knot, transform, std::string(name(coverage)), coverage);
    expectMeans(painted(ref::makeTorus({0, 0, 0}, 0.6f, 0.3f, 40, 20), false), transform,
                "face normals");

    GridCamera camera;
    camera.worldToEye =
        glm::lookAt(glm::dvec3(1.1, 1.7, 2.3), glm::dvec3(0.1, 0.0, -0.1), glm::dvec3(0.1, 1, 0));
    camera.left = -1.4;
    camera.right = 1.5;
    camera.bottom = -1.3;
    camera.top = 1.4;
    camera.near = 1.2;
    camera.far = 4.9;
    expectMeans(knot, GridTransform::camera(camera, {30, 51, 70}).value(), "camera");

    glm::mat4 model = glm::rotate(glm::mat4(1.0f), 0.7f, glm::vec3(0.3f, 1, 0.2f));
    model = glm::scale(model, glm::vec3(1.2f, -0.5f, 0.8f)); // mirrors
    expectMeans(knot, transform, "mirrored model", Coverage::Conservative, model);
}

TEST_F(AttributesGlTest, MeansOfRealMeshesAgreeWithTheReference) {
    for (const NamedMesh& mesh : test::readRealMeshes({"armadillo.ply"}))
        expectMeans(painted(mesh.mesh),
                    GridTransform::box(mesh.mesh.bounds(), glm::uvec3(96)).value(), mesh.name);
}

TEST_F(AttributesGlTest, AMillionTrianglesInOneVoxel) {
    // As many parts of whole sections as overflow 32 bits two thousand times over.
    constexpr std::size_t kCount = 1'000'000;
    TriangleMesh mesh;
    mesh.positions = {{-9, -9, 0.5f}, {9, -9, 0.5f}, {0, 9, 0.5f},
                      {-9, -9, 0.5f}, {9, -9, 0.5f}, {0, 9, 0.5f}};
    mesh.colors = {{1, 1, 1, 1}, {1, 1, 1, 1}, {1, 1, 1, 1},
                   {0, 1, 0, 1}, {0, 1, 0, 1}, {0, 1, 0, 1}};
    mesh.triangles.assign(kCount, {0, 1, 2});
    std::fill_n(mesh.triangles.begin(), kCount / 4, glm::uvec3(3, 5, 4)); // the other way round
    const Result found =
        voxelize(mesh, GridTransform::box({{0, 0, 0}, {1, 1, 1}}, {1, 1, 1}).value());
    ASSERT_EQ(found.bits.count(), 1u);
    EXPECT_EQ(found.attributes.hits[0], kCount);
    EXPECT_NEAR(found.attributes.colors[0].r, 0.75 * 255, 0.51);
    EXPECT_EQ(found.attributes.colors[0].g, 255);
    EXPECT_NEAR(found.attributes.normals[0].z, 1.0f, 1e-4f);
}

TEST_F(AttributesGlTest, TrianglesThatOnlyTouchOrHaveNoAreaWeighLeast) {
    TriangleMesh mesh;
    mesh.positions = {{0.2f, 0.2f, 0.5f},
                      {0.8f, 0.2f, 0.5f},
                      {0.5f, 0.8f, 0.5f},
                      {1.5f, 0.5f, 0.2f},
                      {1.5f, 0.5f, 0.8f}};
    mesh.colors = {{1, 0, 0, 1}, {1, 0, 0, 1}, {1, 0, 0, 1}, {0, 1, 0, 1}, {0, 0, 1, 1}};
    mesh.triangles = {{0, 1, 2}, {3, 4, 3}};
    const Result found =
        voxelize(mesh, GridTransform::box({{0, 0, 0}, {2, 1, 1}}, {2, 1, 1}).value());
    ASSERT_EQ(found.bits.count(), 2u);
    EXPECT_EQ(found.attributes.colors[0], glm::u8vec4(255, 0, 0, 255));
    // The segment has the mean of its corners and no normal.
    EXPECT_EQ(found.attributes.colors[1], glm::u8vec4(0, 170, 85, 255));
    EXPECT_EQ(found.attributes.normals[1], glm::vec3(0.0f));
    EXPECT_EQ(found.attributes.hits[1], 1u);
}

TEST_F(AttributesGlTest, NormalsThatCancelOutAreNone) {
    TriangleMesh mesh;
    mesh.positions = {{-9, -9, 0.5f}, {9, -9, 0.5f}, {0, 9, 0.5f}};
    mesh.triangles = {{0, 1, 2}, {0, 2, 1}};
    const Result found =
        voxelize(mesh, GridTransform::box({{0, 0, 0}, {1, 1, 1}}, {1, 1, 1}).value());
    EXPECT_EQ(found.attributes.normals[0], glm::vec3(0.0f));
    EXPECT_EQ(found.attributes.hits[0], 2u);
}

TEST_F(AttributesGlTest, TheInsideOfASolidHasNoHits) {
    const TriangleMesh cube = painted(ref::makeCube({0, 0, 0}, 1.5f));
    const Result found = voxelize(
        cube, GridTransform::box({{-1, -1, -1}, {1, 1, 1}}, {20, 20, 20}).value(), Coverage::Solid);
    std::size_t i = 0, inside = 0;
    found.bits.forEachSet([&](const glm::uvec3& voxel) {
        if (glm::all(glm::greaterThan(voxel, glm::uvec3(3))) &&
            glm::all(glm::lessThan(voxel, glm::uvec3(16)))) {
            ++inside;
            EXPECT_EQ(found.attributes.hits[i], 0u);
            EXPECT_EQ(found.attributes.colors[i], glm::u8vec4(0));
            EXPECT_EQ(found.attributes.normals[i], glm::vec3(0.0f));
        }
        ++i;
    });
    EXPECT_EQ(inside, 12u * 12u * 12u);
}

TEST_F(AttributesGlTest, BatchesOfVoxelsGiveTheSame) {
    const TriangleMesh knot = painted(ref::makeTorusKnot({0, 0, 0}, 0.5f, 0.2f, 2, 3, 64, 12));
    const GridTransform transform = GridTransform::box(kBox, {70, 80, 90}).value();
    const Result whole = voxelize(knot, transform);
    // Room for the sums of 4096 voxels in a binding.
    DeviceLimits& limits = device().state()->limits;
    const std::uint64_t before = std::exchange(limits.maxStorageBlockBytes, std::uint64_t{1} << 17);
    auto buffers = MeshBuffers::upload(device(), knot).value();
    const GeometrySource source = buffers.view();
    auto grid = VoxelGrid::create(device(), VoxelStore::Buffer).value();
    ASSERT_TRUE(grid.upload(whole.bits));
    auto attributes = VoxelAttributes::create(device()).value();
    const auto stats =
        AttributeVoxelizer::create(device())->voxelize({&source, 1}, {}, grid, attributes);
    limits.maxStorageBlockBytes = before;
    ASSERT_TRUE(stats) << stats.error().text;
    EXPECT_EQ(stats->passes, (whole.bits.count() + 4095) / 4096);
    EXPECT_GT(stats->passes, 3u);
    const AttributeGrid parts = attributes.download().value();
    EXPECT_EQ(parts.colors, whole.attributes.colors);
    EXPECT_EQ(parts.normals, whole.attributes.normals);
    EXPECT_EQ(parts.hits, whole.attributes.hits);
    EXPECT_EQ(parts.materials, whole.attributes.materials);
}

} // namespace
} // namespace lamina
