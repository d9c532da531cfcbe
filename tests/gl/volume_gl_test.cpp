// Volumes against the double-precision reference, and what VolumeGrid and VolumeVoxelizer promise.

#include "gl/support/gl_test.hpp"
#include "gl/support/grids.hpp"
#include "gl/support/test_meshes.hpp"

#include <lamina/voxelize/volume_voxelizer.hpp>
#include <lamina/voxelize/voxelizer.hpp>

#include <reference/shapes.hpp>
#include <reference/volume.hpp>

#include <glm/geometric.hpp>
#include <glm/gtc/matrix_transform.hpp>

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>

namespace lamina {
namespace {

namespace ref = reference;

using test::cameraGrid;
using test::makeShapes;
using test::NamedMesh;
using test::shapesGrid;

class VolumeGlTest : public test::GlTest {
protected:
    VolumeData voxelize(std::span<const GeometrySource> sources, const GridTransform& transform,
                        const VolumeLayout& layout = {}, const VolumeVoxelizerDesc& desc = {},
                        std::span<const Material> materials = {}) {
        auto voxelizer = VolumeVoxelizer::create(device(), desc).value();
        auto volume = VolumeGrid::create(device(), layout).value();
        const auto stats = voxelizer.voxelize(sources, materials, transform, volume);
        EXPECT_TRUE(stats) << stats.error().text;
        return volume.download().value();
    }
    VolumeData voxelize(const TriangleMesh& mesh, const GridTransform& transform,
                        const VolumeLayout& layout = {}, const VolumeVoxelizerDesc& desc = {}) {
        auto buffers = MeshBuffers::upload(device(), mesh).value();
        const GeometrySource source = buffers.view();
        return voxelize({&source, 1}, transform, layout, desc);
    }
};

/// Counts equal the reference's on all but one voxel in 10,000 of those with hits.
void expectCounts(const std::vector<std::uint32_t>& found, const ref::Volume& expected,
                  const std::string& name) {
    ASSERT_EQ(found.size(), expected.counts.size());
    std::uint64_t differing = 0;
    std::uint64_t hit = 0;
    for (std::size_t i = 0; i < found.size(); ++i) {
        differing += found[i] != expected.counts[i] ? 1 : 0;
        hit += found[i] != 0 || expected.counts[i] != 0 ? 1 : 0;
    }
    EXPECT_LE(differing * 10000, hit) << name << ": " << differing << " of " << hit;
}

TEST_F(VolumeGlTest, CountsAreExactOnVerticesAtPowerOfTwoFractions) {
    for (const NamedMesh& shape : makeShapes())
        for (const Axis axis : {Axis::X, Axis::Y, Axis::Z}) {
            const GridTransform transform =
                ref::makeDyadicGrid({{-1, -1, -1}, {1, 1, 1}}, {64, 48, 57}, axis);
            const TriangleMesh mesh = ref::snapped(shape.mesh, transform);
            EXPECT_EQ(voxelize(mesh, transform).counts, ref::volume(mesh, transform).counts)
                << shape.name << " along axis " << static_cast<int>(axis);
        }
}

TEST_F(VolumeGlTest, CountsAgreeWithTheReferenceOnAllShapesAndSizes) {
    for (const NamedMesh& shape : makeShapes())
        for (const glm::uvec3& size :
             {glm::uvec3{101, 83, 128}, {1, 1, 1}, {33, 200, 7}, {64, 64, 8}, {20, 30, 600}}) {
            const GridTransform transform = shapesGrid(size);
            const ref::Volume expected = ref::volume(shape.mesh, transform);
            expectCounts(voxelize(shape.mesh, transform).counts, expected,
                         shape.name + ", " + transform.describe());
            if (size.x == 101) {
                EXPECT_GT(std::ranges::max(expected.counts), 0u) << shape.name;
            }
        }
}

TEST_F(VolumeGlTest, CameraGridsAndSliceDistributionsAgreeWithTheReference) {
    for (const GridTransform& transform : test::makeCameraGrids({90, 71, 100}))
        for (const NamedMesh& shape : makeShapes())
            expectCounts(voxelize(shape.mesh, transform).counts, ref::volume(shape.mesh, transform),
                         shape.name + ", " + transform.describe());
}

TEST_F(VolumeGlTest, TrianglesAroundTheEyeAgreeWithTheReference) {
    const GridTransform transform = test::eyeGrid({80, 80, 96});
    for (const NamedMesh& shape : makeShapes()) {
        const ref::Volume expected = ref::volume(shape.mesh, transform);
        if (std::ranges::count(expected.counts, 0u) != std::ssize(expected.counts))
            expectCounts(voxelize(shape.mesh, transform).counts, expected, shape.name);
    }
}

TEST_F(VolumeGlTest, VoxelsWithHitsAreTheSlicemapsSampledOnes) {
    const TriangleMesh mesh = ref::makeTorusKnot({0, 0, 0}, 0.55f, 0.2f, 2, 3, 200, 24);
    const GridTransform transform = cameraGrid(Projection::Perspective, {120, 90, 150});
    const VolumeData volume = voxelize(mesh, transform);
    auto buffers = MeshBuffers::upload(device(), mesh).value();
    auto grid = VoxelGrid::create(device()).value();
    const GeometrySource source = buffers.view();
    auto slicemap = Voxelizer::create(device(), {Backend::Slicemap, Coverage::Sampled}).value();
    ASSERT_TRUE(slicemap->voxelize({&source, 1}, transform, grid));
    const BitGrid bits = grid.download().value();
    std::uint64_t set = 0;
    for (std::size_t i = 0; i < volume.counts.size(); ++i)
        set += volume.counts[i] != 0 ? 1 : 0;
    std::uint64_t both = 0;
    bits.forEachSet(
        [&](const glm::uvec3& voxel) { both += volume.counts[volume.index(voxel)] != 0; });
    EXPECT_GT(set, 5000u);
    EXPECT_LE((set - both) * 10000, set);
    EXPECT_LE((bits.count() - both) * 10000, set);
}

/// Angle between directions in degrees.
double degreesBetween(const glm::dvec3& a, const glm::dvec3& b) {
    return glm::degrees(std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b)));
}

/// Each mean normal within a degree and each mean colour within `colorTolerance` of the reference,
/// where device and reference count the same hits; `isWithin` decides which counts are looked at.
template<class IsWithin>
void expectMeans(const VolumeData& found, const ref::Volume& expected, double colorTolerance,
                 const std::string& name, IsWithin&& isWithin) {
    double worstAngle = 0.0;
    double worstColor = 0.0;
    std::uint64_t checked = 0;
    for (std::size_t i = 0; i < expected.counts.size(); ++i) {
        const double count = expected.counts[i];
        if (found.counts[i] != expected.counts[i] || !isWithin(expected.counts[i]))
            continue;
        // Where normals nearly cancel out, the mean's direction is rounding.
        if (glm::length(expected.normalSums[i]) > 0.2 * count)
            worstAngle = std::max(
                worstAngle, degreesBetween(glm::dvec3(found.normals[i]), expected.normalSums[i]));
        const glm::dvec3 difference = glm::dvec3(found.colors[i]) - expected.colorSums[i] / count;
        for (int channel = 0; channel < 3; ++channel)
            worstColor = std::max(worstColor, std::abs(difference[channel]));
        ++checked;
    }
    EXPECT_GT(checked, 100u) << name;
    EXPECT_LT(worstAngle, 1.0) << name;
    EXPECT_LT(worstColor, colorTolerance) << name;
}

constexpr VolumeLayout kFloats{VolumeFormat::R32UI, VolumeFormat::R32F, VolumeFormat::RGBA32F,
                               VolumeFormat::RGBA32F, VolumeFormat::RGBA32F};
constexpr VolumeLayout kHalves{VolumeFormat::R32UI, VolumeFormat::R16F, VolumeFormat::RGBA16F,
                               VolumeFormat::RGBA16F, VolumeFormat::RGBA16F};
constexpr VolumeLayout kBytes{VolumeFormat::R8, VolumeFormat::R8, VolumeFormat::RGBA8,
                              VolumeFormat::RGBA8, VolumeFormat::RGBA8};

/// With smooth colours, and normals where asked for.
TriangleMesh decorated(TriangleMesh mesh, bool withNormals) {
    for (const glm::vec3& position : mesh.positions) {
        mesh.colors.emplace_back(glm::clamp(position * 0.5f + 0.5f, 0.0f, 1.0f), 1.0f);
        if (withNormals)
            mesh.normals.push_back(position * 3.0f + glm::vec3(0.0f, 0.0f, 0.2f));
    }
    return mesh;
}

TEST_F(VolumeGlTest, NormalsAndColoursAreTheReferencesMeansInEveryFormat) {
    const GridTransform grids[] = {shapesGrid({60, 50, 64}, Axis::X),
                                   cameraGrid(Projection::Perspective, {70, 60, 64})};
    for (const NamedMesh& shape : makeShapes())
        for (const GridTransform& transform : grids)
            for (const bool withNormals : {false, true}) {
                if (shape.name == "steep plane")
                    continue;
                const TriangleMesh mesh = decorated(shape.mesh, withNormals);
                const ref::Volume expected = ref::volume(mesh, transform);
                const std::string name = shape.name + ", " + transform.describe();
                const auto isOne = [](std::uint32_t count) { return count == 1; };
                const auto isAny = [](std::uint32_t count) { return count > 0; };
                expectMeans(voxelize(mesh, transform, kFloats), expected, 1e-4, name, isAny);
                expectMeans(voxelize(mesh, transform, kHalves), expected, 2e-3, name, isOne);
                expectMeans(voxelize(mesh, transform, kBytes), expected, 4e-3, name, isOne);
            }
}

TEST_F(VolumeGlTest, ASphereHasItsRadialNormals) {
    TriangleMesh mesh = ref::makeIcosphere({0, 0, 0}, 0.9f, 5);
    mesh.normals = mesh.positions;
    const GridTransform transform = shapesGrid({64, 64, 64});
    for (const VolumeLayout& layout : {kFloats, kHalves, kBytes}) {
        const VolumeData volume = voxelize(mesh, transform, layout);
        std::uint64_t checked = 0;
        for (std::uint32_t z = 0; z < 64; ++z)
            for (std::uint32_t y = 0; y < 64; ++y)
                for (std::uint32_t x = 0; x < 64; ++x) {
                    const std::size_t i = volume.index({x, y, z});
                    if (volume.counts[i] != 1)
                        continue;
                    const glm::dvec3 center = transform.voxelCenter({x, y, z});
                    const double height =
                        std::sqrt(std::max(0.81 - center.x * center.x - center.y * center.y, 0.0));
                    const glm::dvec3 radial(center.x, center.y, center.z < 0 ? -height : height);
                    EXPECT_LT(degreesBetween(glm::dvec3(volume.normals[i]), radial), 1.0);
                    ++checked;
                }
        EXPECT_GT(checked, 4000u);
    }
}

TEST_F(VolumeGlTest, MirroredAndSkewedModelsTurnNormalsAsTheReferenceDoes) {
    const glm::mat4 models[] = {
        glm::scale(glm::mat4(1.0f), {-0.8f, 0.5f, 0.9f}),
        glm::rotate(glm::scale(glm::mat4(1.0f), {0.3f, 0.9f, 0.6f}), 0.7f, glm::vec3(1, 2, 3))};
    const GridTransform transform = shapesGrid({60, 50, 64});
    for (const glm::mat4& model : models)
        for (const bool withNormals : {false, true}) {
            const TriangleMesh mesh =
                decorated(ref::makeTorusKnot({0, 0, 0}, 0.55f, 0.2f, 2, 3, 80, 12), withNormals);
            auto buffers = MeshBuffers::upload(device(), mesh).value();
            const GeometrySource source = buffers.view(model);
            expectMeans(voxelize({&source, 1}, transform, kFloats),
                        ref::volume(mesh, transform, {.model = glm::dmat4(model)}), 1e-4,
                        "mirrored or skewed", [](std::uint32_t count) { return count > 0; });
        }
}

TEST_F(VolumeGlTest, RealMeshesAgreeWithTheReference) {
    const auto files = {"bunny.ply", "armadillo.ply", "sponza.ply", "tree.ply"};
    for (const NamedMesh& real : test::readRealMeshes({files.begin(), files.end()})) {
        const GridTransform transform =
            GridTransform::box(real.mesh.bounds(), glm::uvec3(256), Axis::X).value();
        TriangleMesh mesh = real.mesh;
        mesh.normals.clear();
        const VolumeLayout layout{.normal = VolumeFormat::RGBA16F, .color = VolumeFormat::RGBA16F};
        const VolumeData found = voxelize(mesh, transform, layout);
        const ref::Volume expected = ref::volume(mesh, transform);
        expectCounts(found.counts, expected, real.name);
        expectMeans(found, expected, 2e-3, real.name,
                    [](std::uint32_t count) { return count == 1; });
    }
}

TEST_F(VolumeGlTest, SlabOverlapHitsNeighboursAsTheReferenceDoes) {
    const GridTransform grids[] = {shapesGrid({61, 53, 40}),
                                   cameraGrid(Projection::Perspective, {70, 60, 33})};
    for (const NamedMesh& shape : makeShapes())
        for (const GridTransform& transform : grids)
            for (const float overlap : {0.1f, 0.5f, 1.0f})
                expectCounts(voxelize(shape.mesh, transform, {}, {.slabOverlap = overlap}).counts,
                             ref::volume(shape.mesh, transform, {.slabOverlap = double(overlap)}),
                             shape.name + ", overlap " + std::to_string(overlap));
}

TEST_F(VolumeGlTest, TrianglesThatSpanMoreLayersThanOnePassDrawsLoseNothing) {
    // One steep quad through all layers, its depth running along x; each column hits one layer.
    const auto wall = [](float slope) {
        TriangleMesh mesh;
        mesh.positions = {{0, 0, 0}, {1, 0, slope}, {1, 1, slope}, {0, 1, 0}};
        mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
        return mesh;
    };
    for (const std::uint32_t slices : {7u, 8u, 231u, 232u, 1024u, 1500u, 2048u}) {
        const GridTransform transform =
            GridTransform::box({{0, 0, 0}, {1, 1, 1}}, {slices, 3, slices}).value();
        const VolumeData volume = voxelize(wall(1.0f), transform);
        std::uint64_t wrong = 0;
        for (std::uint32_t x = 0; x < slices; ++x)
            for (std::uint32_t z = 0; z < slices; ++z)
                for (std::uint32_t y = 0; y < 3; ++y)
                    wrong += volume.counts[volume.index({x, y, z})] != (x == z ? 1u : 0u);
        EXPECT_EQ(wrong, 0u) << slices;
    }
    // A soup of large triangles, with more layers than columns.
    const TriangleMesh soup = ref::makeTriangleSoup({{-1, -1, -1}, {1, 1, 1}}, 60, 3.0f, 9);
    for (const GridTransform& transform :
         {shapesGrid({40, 30, 1300}), cameraGrid(Projection::Perspective, {30, 40, 1200})})
        expectCounts(voxelize(soup, transform).counts, ref::volume(soup, transform), "soup");
}

TEST_F(VolumeGlTest, ADrawSourceOfTallTrianglesLosesNothingAndKnowsColours) {
    // The triangle's corners come from gl_VertexID; it is drawn once a pass.
    TriangleMesh mesh;
    mesh.positions = {{-1, -1, -1}, {1, -1, 0.5f}, {0, 1, 1}};
    mesh.triangles = {{0, 1, 2}};
    mesh.colors = {{1, 0, 0, 1}, {0, 1, 0, 1}, {0, 0, 1, 1}};
    GLuint vertexArray = 0;
    gl().CreateVertexArrays(1, &vertexArray);
    std::vector<std::uint32_t> passes;
    DrawSource source;
    source.vertexShader = R"(
        LaminaVertex laminaVertex() {
            vec3 corners[3] = vec3[](vec3(-1.0), vec3(1.0, -1.0, 0.5), vec3(0.0, 1.0, 1.0));
            laminaVertexColor = vec4(float(gl_VertexID == 0), float(gl_VertexID == 1),
                                     float(gl_VertexID == 2), 1.0);
            return LaminaVertex(corners[gl_VertexID], vec3(0.0), 1u);
        })";
    source.draw = [&](const DrawContext& draw) {
        passes.push_back(draw.pass);
        gl().BindVertexArray(vertexArray);
        gl().DrawArrays(GL_TRIANGLES, 0, 3);
    };
    const GeometrySource sources[] = {source};
    Material materials[2];
    materials[1].color = {1.0f, 0.5f, 0.25f, 1.0f};
    const GridTransform transform = shapesGrid({50, 60, 300});
    const VolumeData volume = voxelize(sources, transform, kFloats, {}, materials);
    EXPECT_THAT(passes, testing::ElementsAre(0u, 1u, 2u));
    ref::Volume expected = ref::volume(mesh, transform);
    for (glm::dvec3& sum : expected.colorSums)
        sum *= glm::dvec3(1.0, 0.5, 0.25);
    expectCounts(volume.counts, expected, "triangle");
    expectMeans(volume, expected, 1e-4, "triangle", [](std::uint32_t count) { return count > 0; });
    gl().DeleteVertexArrays(1, &vertexArray);
}

TEST_F(VolumeGlTest, MaterialsGiveAbsorptionAndOpticsPerHit) {
    // Three sheets in slice 2, two of them glass; one sheet in slice 5.
    const GridTransform transform =
        GridTransform::box({{0, 0, 0}, {8, 8, 8}}, glm::uvec3(8)).value();
    auto glass = MeshBuffers::upload(device(), ref::makeParallelQuads({4, 4, 2.25f}, 8, 2, 0.25f));
    auto leaf =
        MeshBuffers::upload(device(), ref::merged(ref::makePlane({4, 4, 2.9f}, {0, 0, 1}, 8),
                                                  ref::makePlane({4, 4, 5.5f}, {0, 0, -1}, 8)));
    Material materials[2];
    materials[0] = {{1, 1, 1, 1}, 0.125f, 0, 1.5f, 0.9f, OrientationRule::TwoSided};
    materials[1] = {{0, 1, 0, 1}, 0.25f, 1, 1.0f, 0.3f, OrientationRule::TwoSided};
    MeshView views[2] = {glass->view(), leaf->view()};
    views[1].materialId = 1;
    const GeometrySource sources[] = {views[0], views[1]};
    for (const VolumeLayout& layout : {kFloats, kHalves, kBytes}) {
        const double tolerance = layout == kBytes ? 1.1 / 255.0 : 1e-3;
        const VolumeData volume = voxelize(sources, transform, layout, {}, materials);
        const std::size_t mixed = volume.index({3, 4, 2});
        EXPECT_EQ(volume.counts[mixed], 3u);
        EXPECT_NEAR(volume.absorption[mixed], 0.5, tolerance);
        EXPECT_NEAR(volume.optics[mixed].x, 4.0 / 3.0, 3.0 * tolerance);
        EXPECT_NEAR(volume.optics[mixed].y, 0.7, tolerance);
        EXPECT_NEAR(volume.colors[mixed].x, 2.0 / 3.0, tolerance);
        EXPECT_NEAR(volume.colors[mixed].y, 1.0, tolerance);
        EXPECT_LT(degreesBetween(glm::dvec3(volume.normals[mixed]), {0, 0, 1}), 0.5);
        const std::size_t single = volume.index({0, 7, 5});
        EXPECT_EQ(volume.counts[single], 1u);
        EXPECT_NEAR(volume.absorption[single], 0.25, tolerance);
        EXPECT_LT(degreesBetween(glm::dvec3(volume.normals[single]), {0, 0, -1}), 0.5);
        const std::size_t empty = volume.index({3, 4, 3});
        EXPECT_EQ(volume.counts[empty], 0u);
        EXPECT_EQ(volume.absorption[empty], 0.0f);
        EXPECT_EQ(volume.optics[empty], glm::vec2(1.0f));
        EXPECT_EQ(volume.normals[empty], glm::vec3(0.0f));
    }
}

TEST_F(VolumeGlTest, OrientationRulesLeaveTrianglesOutByHowTheyFaceTheCamera) {
    // An outward sphere: its front faces are the half nearer the camera.
    const TriangleMesh mesh = ref::makeIcosphere({0, 0, 0}, 0.8f, 3);
    for (const GridTransform& transform :
         {shapesGrid(glm::uvec3(40)), shapesGrid(glm::uvec3(40), Axis::Y),
          cameraGrid(Projection::Orthographic, {60, 60, 60}),
          cameraGrid(Projection::Perspective, {60, 60, 60})}) {
        auto buffers = MeshBuffers::upload(device(), mesh).value();
        const GeometrySource source = buffers.view();
        const auto counted = [&](OrientationRule rule) {
            Material material;
            material.orientation = rule;
            return voxelize({&source, 1}, transform, {}, {}, {&material, 1}).counts;
        };
        const auto both = counted(OrientationRule::TwoSided);
        const auto front = counted(OrientationRule::FrontFaces);
        const auto back = counted(OrientationRule::BackFaces);
        const glm::uvec3 size = transform.size();
        std::uint64_t wrong = 0;
        std::uint64_t columns = 0;
        for (std::size_t column = 0; column < std::size_t{size.x} * size.y; ++column) {
            std::int64_t firstFront = -1;
            std::int64_t firstBack = -1;
            for (std::size_t z = 0; z < size.z; ++z) {
                const std::size_t i = z * size.x * size.y + column;
                wrong += both[i] != front[i] + back[i] ? 1 : 0;
                if (front[i] != 0 && firstFront < 0)
                    firstFront = static_cast<std::int64_t>(z);
                if (back[i] != 0 && firstBack < 0)
                    firstBack = static_cast<std::int64_t>(z);
            }
            wrong += (firstFront < 0) != (firstBack < 0) || firstFront > firstBack ? 1 : 0;
            columns += firstFront >= 0 ? 1 : 0;
        }
        EXPECT_EQ(wrong, 0u) << transform.describe();
        EXPECT_GT(columns, 400u);
    }
}

TEST_F(VolumeGlTest, CeilingsAreReported) {
    const GridTransform transform =
        GridTransform::box({{0, 0, 0}, {4, 4, 4}}, glm::uvec3(4)).value();
    const auto stack = [&](unsigned count, const VolumeLayout& layout) {
        auto buffers = MeshBuffers::upload(
            device(), ref::makeParallelQuads({2, 2, 1.125f}, 4, count, 1.0f / 8192.0f));
        auto voxelizer = VolumeVoxelizer::create(device()).value();
        auto volume = VolumeGrid::create(device(), layout).value();
        const GeometrySource source = buffers->view();
        const VolumeStats stats = voxelizer.voxelize({&source, 1}, {}, transform, volume).value();
        return std::pair(stats.mayReachCeiling, volume.download().value());
    };
    const auto saturated = [](const VolumeData& data, VolumePayload payload) {
        return data.saturatedVoxels[static_cast<std::size_t>(payload)];
    };
    const VolumeLayout bytes{.count = VolumeFormat::R8};
    const auto [mayFew, few] = stack(100, bytes);
    EXPECT_FALSE(mayFew);
    EXPECT_EQ(few.counts[few.index({1, 1, 1})], 100u);
    EXPECT_EQ(saturated(few, VolumePayload::Count), 0u);
    const auto [mayMany, many] = stack(300, bytes);
    EXPECT_TRUE(mayMany);
    EXPECT_EQ(many.counts[many.index({1, 1, 1})], 255u);
    EXPECT_EQ(saturated(many, VolumePayload::Count), 16u);
    const auto [mayHalves, halves] =
        stack(3000, {.count = VolumeFormat::R32UI, .normal = VolumeFormat::RGBA16F});
    EXPECT_TRUE(mayHalves);
    EXPECT_EQ(halves.counts[halves.index({1, 1, 1})], 3000u);
    EXPECT_EQ(saturated(halves, VolumePayload::Count), 0u);
    EXPECT_EQ(saturated(halves, VolumePayload::Normal), 16u);
    EXPECT_LT(degreesBetween(glm::dvec3(halves.normals[halves.index({1, 1, 1})]), {0, 0, 1}), 0.5);
    const auto [mayAbsorb, absorption] =
        stack(3, {.count = VolumeFormat::None, .absorption = VolumeFormat::R8});
    EXPECT_EQ(saturated(absorption, VolumePayload::Absorption), 16u);
    EXPECT_TRUE(absorption.counts.empty());
}

} // namespace
} // namespace lamina
