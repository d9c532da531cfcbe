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

    /// Colours within one step of 8 bits and normals within 0.1 degree in all voxels but for what
    /// the step of areas makes: a share of 1 / 2^20 of the section for each hit.
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
            const double cosine =
                glm::dot(glm::normalize(mean), glm::dvec3(found.attributes.normals[i]));
            const double angle = glm::degrees(std::acos(std::min(1.0, cosine)));
            worstNormal =
                std::max(worstNormal, angle - glm::degrees(2.0 * doubt / glm::length(mean)));
        }
        EXPECT_LE(worstColor, 1.0) << name;
        EXPECT_LE(worstNormal, 0.1 / 0.1 * 0.1) << name;
        EXPECT_GT(compared, exact.size() / 2) << name;
    }
};

const Box3 kBox{{-1.01, -1.03, -1.02}, {1.04, 1.02, 1.03}};

TEST_F(AttributesGlTest, MeansOfShapesAgreeWithTheReference) {
    for (const Axis axis : {Axis::X, Axis::Y, Axis::Z})
        for (const NamedMesh& shape : test::makeShapes())
            expectMeans(painted(shape.mesh), GridTransform::box(kBox, {31, 23, 140}, axis).value(),
                        shape.name + " along axis " + std::to_string(static_cast<int>(axis)));
}

} // namespace
} // namespace lamina
