// The parity test against exact rays, a million points a shape.

#include "gl/support/gl_test.hpp"
#include "gl/support/parity.hpp"
#include "gl/support/test_meshes.hpp"

#include <reference/mesh_measures.hpp>
#include <reference/point_parity.hpp>
#include <reference/shapes.hpp>

#include <cstdio>

namespace lamina {
namespace {

namespace ref = reference;
using test::BuiltSprite;
using test::NamedMesh;

const std::vector<glm::dvec3> kAxes = {{0, 0, 1}, {1, 0, 0}, {0, 1, 0}};

class ParityAccuracyGlTest : public test::GlTest {};

/// Closed, concave, nested and dense: what parity is for.
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

TEST_F(ParityAccuracyGlTest, AMillionPointsAgreeWithExactRays) {
    constexpr std::size_t kPoints = 1000000;
    for (const NamedMesh& mesh : accuracyMeshes()) {
        const Box3 box = mesh.mesh.bounds();
        const auto points = test::randomPoints(box, kPoints, 11);
        // Rays along x: neither the first sprite's direction nor its columns.
        const std::vector<char> expected = ref::pointParity(mesh.mesh, points, Axis::X);
        std::printf("%-14s", mesh.name.c_str());
        for (const auto& [columns, mostWrong] : {std::pair(128u, 0.01), std::pair(1024u, 0.001)}) {
            std::vector<BuiltSprite> built;
            std::vector<const DepthSprite*> sprites;
            built.reserve(kAxes.size());
            for (const glm::dvec3& axis : kAxes) {
                const auto transform = fitSprite(box, axis, columns).value();
                built.emplace_back(device(), mesh.mesh, transform);
                sprites.push_back(&built.back().sprite);
            }
            const auto plain =
                test::wrongOnes(test::classify(device(), {&sprites[0], 1}, points), expected);
            const auto refined = test::wrongOnes(
                test::classify(device(), sprites, points, {.directions = 3}), expected);
            std::printf("  %4u: %.4f %% wrong, by three directions %.4f %%", columns,
                        1e2 * static_cast<double>(plain.size()) / kPoints,
                        1e2 * static_cast<double>(refined.size()) / kPoints);
            const double diagonal = test::diagonalOf(*sprites[0]->transform());
            EXPECT_LE(refined.size(), mostWrong * kPoints) << mesh.name << " " << columns;
            // Walls parallel to the axis are the sponge's trouble: a quarter of a column's width
            // of each is wrong on average.
            EXPECT_LE(plain.size(),
                      (mesh.name == "menger sponge" ? 4.0 : 1.5) * mostWrong * kPoints)
                << mesh.name << " " << columns;
            if (ref::isWatertight(mesh.mesh)) {
                EXPECT_EQ(built[0].report.oddColumns, 0u) << mesh.name;
            }
            if (columns == 1024) {
                for (const std::size_t i : plain)
                    ASSERT_TRUE(ref::surfaceWithin(mesh.mesh, points[i], diagonal)) << i;
            }
        }
        std::printf("\n");
    }
}

} // namespace
} // namespace lamina
