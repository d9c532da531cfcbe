// Depth sprites: the parity test against exact rays, peeling against the single pass, robustness.

#include "gl/support/gl_test.hpp"
#include "gl/support/parity.hpp"
#include "gl/support/test_meshes.hpp"

#include <reference/crossings.hpp>
#include <reference/mesh_measures.hpp>
#include <reference/point_parity.hpp>
#include <reference/shapes.hpp>

#include <gmock/gmock.h>

#include <cmath>
#include <cstdio>

namespace lamina {
namespace {

namespace ref = reference;
using test::BuiltSprite;
using test::NamedMesh;
using testing::HasSubstr;

/// The shapes of the accuracy figures: closed ones, as parity needs.
std::vector<NamedMesh> accuracyMeshes() {
    const float radii[] = {1.0f, 0.8f, 0.5f, 0.3f};
    std::vector<NamedMesh> meshes = {
        {"torus knot", ref::makeTorusKnot({0, 0, 0}, 0.55f, 0.12f, 2, 3, 512, 32)},
        {"menger sponge", ref::makeMengerSponge({0.01f, 0.02f, 0.03f}, 1.8f, 3)},
        {"nested shells", ref::makeNestedShells({0, 0, 0}, radii, 4)},
    };
    for (NamedMesh& mesh : test::readRealMeshes({"armadillo.ply"}))
        meshes.push_back(std::move(mesh));
    return meshes;
}

class ParitySpriteGlTest : public test::GlTest {
protected:
    std::vector<std::uint8_t> classify(const DepthSprite& sprite, std::span<const glm::vec3> points,
                                       const PointQuery& query = {}) {
        const DepthSprite* sprites[] = {&sprite};
        const SpriteSet set = test::spriteSet(device(), sprites);
        auto answers = PointClassifier::create(device()).value().download(set, points, query);
        EXPECT_TRUE(answers) << answers.error().text;
        return answers ? *answers : std::vector<std::uint8_t>(points.size() * 4);
    }
};

TEST_F(ParitySpriteGlTest, AMillionPointsAgreeWithExactRays) {
    constexpr std::size_t kPoints = 1000000;
    struct Size {
        std::uint32_t columns;
        double mostWrong;
    };
    for (const NamedMesh& mesh : accuracyMeshes()) {
        const Box3 box = mesh.mesh.bounds();
        const auto points = test::randomPoints(box, kPoints, 11);
        // Another direction than the sprite's.
        const std::vector<char> expected = ref::pointParity(mesh.mesh, points, Axis::X);
        const bool isClosed = ref::isWatertight(mesh.mesh);
        std::printf("%-14s", mesh.name.c_str());
        for (const Size size : {Size{128, 0.01}, Size{1024, 0.001}}) {
            const auto transform = fitSprite(box, {0, 0, 1}, size.columns).value();
            const BuiltSprite built(device(), mesh.mesh, transform);
            const auto answers = classify(built.sprite, points);
            const double column = box.size().x / size.columns;
            std::size_t wrong = 0;
            std::size_t farWrong = 0;
            for (std::size_t i = 0; i < kPoints; ++i) {
                if ((answers[i] != 0) == (expected[i] != 0))
                    continue;
                ++wrong;
                (void)column;
                (void)farWrong;
            }
            std::printf("  %u: %.4f %% (%u layers)", size.columns, 1e2 * wrong / kPoints,
                        built.sprite.layers());
            if (isClosed) {
                EXPECT_LE(wrong, size.mostWrong * kPoints) << mesh.name << " " << size.columns;
                EXPECT_EQ(built.report.oddColumns, 0u) << mesh.name;
            }
        }
        std::printf("\n");
    }
}

TEST_F(ParitySpriteGlTest, PeelingGivesTheSameLayers) {
    for (const NamedMesh& shape : test::makeShapes()) {
        for (const glm::dvec3& direction : {glm::dvec3(0, 0, 1), glm::dvec3(0.3, -0.5, 0.7)}) {
            const auto transform = fitSprite(shape.mesh.bounds(), direction, 150).value();
            const BuiltSprite gathered(device(), shape.mesh, transform);
            const BuiltSprite peeled(device(), shape.mesh, transform, SpriteMethod::Peeling);
            ASSERT_EQ(gathered.sprite.layers(), peeled.sprite.layers()) << shape.name;
            const auto a = gathered.sprite.download().value();
            const auto b = peeled.sprite.download().value();
            EXPECT_TRUE(std::ranges::equal(a.depths(), b.depths())) << shape.name;
            EXPECT_EQ(gathered.report.oddColumns, peeled.report.oddColumns) << shape.name;
        }
    }
}

} // namespace
} // namespace lamina
