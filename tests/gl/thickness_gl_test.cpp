// Thickness maps against exact ray casting, on known shapes and real meshes.

#include "gl/support/closed_holes.hpp"
#include "gl/support/gl_state.hpp"
#include "gl/support/gl_test.hpp"
#include "gl/support/test_meshes.hpp"

#include <lamina/refraction/thickness_map.hpp>

#include <reference/mesh_measures.hpp>
#include <reference/shapes.hpp>
#include <reference/volume_integral.hpp>

#define GLM_ENABLE_EXPERIMENTAL
#include <glm/gtc/matrix_transform.hpp>
#include <glm/gtx/component_wise.hpp>
#include <gmock/gmock.h>

#include <cmath>

namespace lamina {
namespace {

namespace ref = reference;

/// A view of the box, and the same camera as a grid by its own words.
struct TestView {
    View view;
    GridTransform grid;
};

TestView lookAtBox(const Box3& bounds, const glm::uvec2& size, bool isPerspective) {
    const double radius = 0.5 * glm::length(bounds.size());
    const glm::dvec3 eye = bounds.center() + radius * glm::dvec3(1.3, 1.1, 2.2);
    const glm::dmat4 camera = glm::lookAt(eye, bounds.center(), glm::dvec3(0.1, 1.0, 0.0));
    const double distance = glm::length(eye - bounds.center());
    TestView made{{}, GridTransform::box(bounds, glm::uvec3(1)).value()};
    made.view.size = size;
    const double aspect = static_cast<double>(size.x) / size.y;
    GridCamera gridCamera;
    gridCamera.worldToEye = camera;
    gridCamera.near = distance - 1.01 * radius;
    gridCamera.far = distance + 1.01 * radius;
    if (isPerspective) {
        const double angle = 2.0 * std::asin(radius / distance);
        made.view.worldToClip =
            glm::perspective(angle, aspect, 0.01 * radius, 10.0 * radius) * camera;
        gridCamera =
            GridCamera::perspective(camera, angle, aspect, gridCamera.near, gridCamera.far);
    } else {
        made.view.worldToClip =
            glm::ortho(-radius * aspect, radius * aspect, -radius, radius, 0.0, 10.0 * radius) *
            camera;
        gridCamera.left = -radius * aspect;
        gridCamera.right = radius * aspect;
        gridCamera.bottom = -radius;
        gridCamera.top = radius;
    }
    made.grid = GridTransform::camera(gridCamera, {size.x, size.y, 1}).value();
    return made;
}

struct Agreement {
    std::size_t covered = 0, equal = 0, open = 0;
    double worst = 0.0;     ///< Slices a crossing by which a count differs from the ideal.
    double meanError = 0.0; ///< Against the exact inside length, world units.
    double meanPlain = 0.0; ///< Of the difference of nearest and farthest depth.
    /// Unambiguous columns more than a slice a crossing from the exact length.
    std::size_t inexact = 0;
};

class ThicknessGlTest : public test::GlTest {
protected:
    std::vector<float> read(const ThicknessMap& map) {
        std::vector<float> texels(std::size_t{map.size().x} * map.size().y);
        gl().GetTextureImage(map.texture(), 0, GL_RED, GL_FLOAT,
                             static_cast<GLsizei>(texels.size() * sizeof(float)), texels.data());
        return texels;
    }

    Agreement compare(const std::vector<float>& thickness, const ref::ColumnCrossings& crossings,
                      const TestView& at, unsigned slices) {
        Agreement result;
        const glm::uvec2 size = at.view.size;
        for (unsigned y = 0; y < size.y; ++y)
            for (unsigned x = 0; x < size.x; ++x) {
                const auto column = crossings.at({x, y});
                const double found = thickness[std::size_t{y} * size.x + x];
                if (column.empty()) {
                    EXPECT_EQ(found, 0.0);
                    continue;
                }
                ++result.covered;
                const double near = column.front().depth;
                const double far = column.back().depth;
                const double perDepth = ref::rayLengthPerDepth(at.grid, {x, y});
                const double slice = (far - near) / slices * perDepth;
                const auto voxels = ref::quantised(column, near, far, slices);
                result.open += ref::looksClosed(voxels) ? 0 : 1;
                const double ideal = ref::countInner(voxels) * slice;
                const double exact = ref::depthInside(column, near, far) * perDepth;
                // Counts are whole; near and far are rounded outwards to floats.
                const double rounding = 4e-7 * far * perDepth;
                const double apart =
                    std::max(std::abs(found - ideal) - rounding, 0.0) / std::max(slice, rounding);
                const bool equal = apart < 0.25;
                result.equal += equal ? 1 : 0;
                if (!equal)
                    result.worst =
                        std::max(result.worst, apart / static_cast<double>(column.size()));
                result.meanError += std::abs(found - exact);
                result.meanPlain += std::abs((far - near) * perDepth - exact);
                const bool isAmbiguous =
                    std::ranges::find(voxels, ref::Facing::Both) != voxels.end();
                const double allowed = slice * static_cast<double>(column.size()) + rounding;
                result.inexact += !isAmbiguous && std::abs(found - exact) > allowed ? 1 : 0;
            }
        result.meanError /= static_cast<double>(result.covered);
        result.meanPlain /= static_cast<double>(result.covered);
        return result;
    }

    void expectThickness(const std::string& name, const TriangleMesh& mesh, unsigned pixels,
                         std::initializer_list<unsigned> sliceCounts, bool isPerspective = true,
                         double inexactShare = 0.0) {
        const Box3 bounds = mesh.bounds();
        const TestView at = lookAtBox(bounds, {pixels, pixels}, isPerspective);
        const ref::ColumnCrossings crossings(mesh, at.grid);
        auto buffers = MeshBuffers::upload(device(), mesh).value();
        const GeometrySource source = buffers.view();
        for (const unsigned slices : sliceCounts) {
            SCOPED_TRACE(name + ", " + std::to_string(slices) + " slices");
            auto map = ThicknessMap::create(device(), {.slices = slices}).value();
            const auto built = map.build({&source, 1}, at.view, bounds);
            ASSERT_TRUE(built) << built.error().text;
            EXPECT_EQ(built->passes, slices <= 512 ? 2u : 3u);
            const auto found = read(map);
            const Agreement agreement = compare(found, crossings, at, slices);
            const double scale = 1.0 / glm::compMax(bounds.size());
            std::printf("%-14s %4u slices: ideal in %.3f %% of %zu pixels; mean error %.5f, "
                        "nearest/farthest %.5f of the size (%.0f times)\n",
                        name.c_str(), slices, 100.0 * agreement.equal / agreement.covered,
                        agreement.covered, agreement.meanError * scale, agreement.meanPlain * scale,
                        agreement.meanPlain / agreement.meanError);
            EXPECT_GE(agreement.equal, 0.99 * agreement.covered);
            // A crossing on a boundary between slices may fall to either side.
            EXPECT_LE(agreement.worst, 1.0);
            EXPECT_LE(agreement.inexact, inexactShare * agreement.covered);
            EXPECT_LE(agreement.open, inexactShare * agreement.covered);
            const auto report = map.downloadReport().value();
            EXPECT_NEAR(static_cast<double>(report.openColumns),
                        static_cast<double>(agreement.open), 1e-3 * agreement.covered);
            if (slices == 128) {
                auto table =
                    ThicknessMap::create(device(), {slices, IntegralMethod::Table}).value();
                ASSERT_TRUE(table.build({&source, 1}, at.view, bounds));
                EXPECT_EQ(read(table), found) << "table and arithmetic";
                EXPECT_EQ(table.downloadReport()->openColumns, report.openColumns);
                EXPECT_EQ(table.downloadReport()->ambiguousColumns, report.ambiguousColumns);
            }
        }
    }
};

TEST_F(ThicknessGlTest, KnownShapes) {
    const float radii[] = {1.0f, 0.8f, 0.5f, 0.3f};
    // Turned so that rays cross one arm, the notch and the other arm.
    const TriangleMesh block =
        ref::transformed(ref::makeLBlock({0, 0, 0}, 2.0f),
                         glm::rotate(glm::dmat4(1.0), -0.5 * 3.141592653589793, {0, 0, 1}));
    for (const bool isPerspective : {false, true}) {
        expectThickness("cube", ref::makeCube({0, 0, 0}, 1.5f), 128, {33, 128}, isPerspective);
        expectThickness("sphere", ref::makeIcosphere({0.1f, 0, 0}, 1.0f, 4), 128, {128},
                        isPerspective);
        expectThickness("L-block", block, 128, {1, 32, 128}, isPerspective);
        expectThickness("nested shells", ref::makeNestedShells({0, 0, 0}, radii, 4), 128, {32, 128},
                        isPerspective);
    }
}

constexpr auto kSliceCounts = {32u, 128u, 512u, 1024u};

TEST_F(ThicknessGlTest, TorusKnotFrom32To1024Slices) {
    const TriangleMesh mesh = ref::makeTorusKnot({0, 0, 0}, 0.6f, 0.16f, 2, 3, 512, 32);
    expectThickness("torus knot", mesh, 512, kSliceCounts);
    expectThickness("torus knot", mesh, 128, {100, 1000});
}

TEST_F(ThicknessGlTest, NestedShellsFrom32To1024Slices) {
    const float radii[] = {1.0f, 0.8f, 0.5f, 0.3f};
    expectThickness("nested shells", ref::makeNestedShells({0, 0, 0}, radii, 5), 512, kSliceCounts);
}

TEST_F(ThicknessGlTest, RealMeshesFrom32To1024Slices) {
    for (const auto& [name, mesh] : test::readRealMeshes({"armadillo.ply", "bunny.ply"})) {
        // The scanned bunny has holes. Scans and fans cross themselves in places, where facings do
        // not alternate along a ray.
        const TriangleMesh closed = test::withHolesClosed(mesh);
        ASSERT_TRUE(ref::isWatertight(closed)) << name;
        expectThickness(name, closed, 512, kSliceCounts, true, 1e-3);
    }
}

/// 2 (r^2 - b^2)^(1/2) for rays at distance b from a sphere's centre: known without any reference.
TEST_F(ThicknessGlTest, SphereByFormula) {
    const TriangleMesh mesh = ref::makeIcosphere({0, 0, 0}, 1.0f, 6);
    const TestView at = lookAtBox({{-1, -1, -1}, {1, 1, 1}}, {96, 64}, true);
    auto buffers = MeshBuffers::upload(device(), mesh).value();
    const GeometrySource source = buffers.view();
    auto map = ThicknessMap::create(device(), {.slices = 1024}).value();
    ASSERT_TRUE(map.build({&source, 1}, at.view, mesh.bounds()));
    const auto found = read(map);
    const glm::dmat4 inverse = glm::inverse(at.view.worldToClip);
    const auto unproject = [&](double x, double y, double z) {
        const glm::dvec4 point =
            inverse * glm::dvec4(2.0 * x / 96.0 - 1.0, 2.0 * y / 64.0 - 1.0, z, 1.0);
        return glm::dvec3(point) / point.w;
    };
    for (unsigned y = 0; y < 64; ++y)
        for (unsigned x = 0; x < 96; ++x) {
            const glm::dvec3 from = unproject(x + 0.5, y + 0.5, -1.0);
            const glm::dvec3 ray = glm::normalize(unproject(x + 0.5, y + 0.5, 1.0) - from);
            const double b = glm::length(glm::cross(from, ray));
            const double exact = b < 1.0 ? 2.0 * std::sqrt(1.0 - b * b) : 0.0;
            // Facets lie up to 4e-4 below the sphere; near the rim that is a long chord.
            if (b < 0.98 || b > 1.01) {
                EXPECT_NEAR(found[y * 96 + x], exact, 0.007) << x << ' ' << y;
            }
        }
}

TEST_F(ThicknessGlTest, OpenMeshesAreReportedAndBounded) {
    // A sphere without its back half: every ray enters and never leaves.
    TriangleMesh mesh = ref::makeIcosphere({0, 0, 0}, 1.0f, 4);
    const TestView at = lookAtBox(mesh.bounds(), {64, 64}, true);
    const glm::vec3 towards(glm::normalize(glm::dvec3(1.3, 1.1, 2.2)));
    std::erase_if(mesh.triangles, [&](const glm::uvec3& triangle) {
        return glm::dot(mesh.positions[triangle.x], towards) < 0.0f;
    });
    auto buffers = MeshBuffers::upload(device(), mesh).value();
    const GeometrySource source = buffers.view();
    for (const auto method : {IntegralMethod::Arithmetic, IntegralMethod::Table}) {
        auto map = ThicknessMap::create(device(), {.slices = 64, .method = method}).value();
        ASSERT_TRUE(map.build({&source, 1}, at.view, {{-1, -1, -1}, {1, 1, 1}}));
        std::size_t covered = 0;
        for (const float value : read(map)) {
            ASSERT_TRUE(std::isfinite(value));
            ASSERT_GE(value, 0.0f);
            ASSERT_LE(value, 2.0f);
        }
        covered = map.downloadReport()->openColumns;
        EXPECT_GT(covered, 800u);
    }
}

TEST_F(ThicknessGlTest, AnyProjectionOfTheView) {
    const TriangleMesh mesh = ref::makeLBlock({0, 0, 0}, 2.0f);
    auto buffers = MeshBuffers::upload(device(), mesh).value();
    const GeometrySource source = buffers.view();
    TestView at = lookAtBox(mesh.bounds(), {80, 60}, true);
    auto map = ThicknessMap::create(device(), {.slices = 64}).value();
    ASSERT_TRUE(map.build({&source, 1}, at.view, mesh.bounds()));
    const auto expected = read(map);
    EXPECT_GT(*std::ranges::max_element(expected), 1.0f);
    // Reversed, infinite, scaled clip space: the same window.
    View view = at.view;
    for (int column = 0; column < 4; ++column)
        view.worldToClip[column][2] = column == 3 ? 0.1 : 0.0;
    view.worldToClip *= 3.0;
    view.clipDepth = ClipDepth::ZeroToOne;
    view.backgroundDepth = 0.0f;
    ASSERT_TRUE(map.build({&source, 1}, view, mesh.bounds()));
    const auto same = read(map);
    for (std::size_t i = 0; i < expected.size(); ++i)
        ASSERT_NEAR(same[i], expected[i], 0.05f);
    // Upside down.
    view = at.view;
    for (int column = 0; column < 4; ++column)
        view.worldToClip[column][1] = -view.worldToClip[column][1];
    ASSERT_TRUE(map.build({&source, 1}, view, mesh.bounds()));
    const auto flipped = read(map);
    EXPECT_EQ(map.downloadReport()->openColumns, 0u) << "fronts stay fronts";
    std::size_t apart = 0;
    for (unsigned y = 0; y < 60; ++y)
        for (unsigned x = 0; x < 80; ++x)
            apart += std::abs(flipped[(59 - y) * 80 + x] - expected[y * 80 + x]) > 0.05f ? 1 : 0;
    EXPECT_LE(apart, 10u);
}

TEST_F(ThicknessGlTest, LeavesOddStateAsItWas) {
    const TriangleMesh mesh = ref::makeLBlock({0, 0, 0}, 2.0f);
    auto buffers = MeshBuffers::upload(device(), mesh).value();
    const GeometrySource source = buffers.view();
    const TestView at = lookAtBox(mesh.bounds(), {40, 30}, true);
    auto plain = ThicknessMap::create(device(), {.slices = 200}).value();
    ASSERT_TRUE(plain.build({&source, 1}, at.view, mesh.bounds()));
    for (const auto method : {IntegralMethod::Arithmetic, IntegralMethod::Table}) {
        const test::OddGlState odd(gl());
        const auto before = test::readGlState(gl());
        auto map = ThicknessMap::create(device(), {.slices = 200, .method = method}).value();
        ASSERT_TRUE(map.build({&source, 1}, at.view, mesh.bounds()));
        EXPECT_TRUE(map.downloadReport());
        EXPECT_THAT(test::differences(before, test::readGlState(gl())), testing::IsEmpty());
        EXPECT_EQ(plain.downloadReport()->openColumns, map.downloadReport()->openColumns);
        EXPECT_GT(map.gpuBytes(), 0u);
    }
}

TEST_F(ThicknessGlTest, RefusesWhatItCannotMeasure) {
    EXPECT_EQ(ThicknessMap::create(device(), {.slices = 0}).error().code,
              ErrorCode::InvalidArgument);
    EXPECT_EQ(ThicknessMap::create(device(), {.slices = 1025}).error().text,
              "thickness: expected 1 to 1024 slices, found 1025");
    auto map = ThicknessMap::create(device()).value();
    EXPECT_EQ(map.downloadReport().error().code, ErrorCode::InvalidArgument);
    const TestView at = lookAtBox({{-1, -1, -1}, {1, 1, 1}}, {8, 8}, true);
    EXPECT_EQ(map.build({}, at.view, Box3{}).error().code, ErrorCode::InvalidArgument);
    View skewed = at.view;
    for (int column = 0; column < 4; ++column)
        skewed.worldToClip[column][0] += 0.5 * skewed.worldToClip[column][1];
    EXPECT_EQ(map.build({}, skewed, {{-1, -1, -1}, {1, 1, 1}}).error().code,
              ErrorCode::InvalidArgument);
    ASSERT_TRUE(map.build({}, at.view, {{-1, -1, -1}, {1, 1, 1}}));
    EXPECT_EQ(map.size(), glm::uvec2(8));
}

} // namespace
} // namespace lamina
