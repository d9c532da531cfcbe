#include "mesh_samples.hpp"

#include <lamina/mesh_io/mesh_normals.hpp>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include <cmath>

namespace lamina {
namespace {

TEST(MeshNormals, AngleWeightsIgnoreHowAFaceIsCut) {
    // A corner of a cube with one face cut through the corner: plain or area weights would lean.
    TriangleMesh mesh{{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 0, 1}},
                      {},
                      {},
                      {{0, 2, 1}, {0, 3, 2}, {0, 1, 4}, {0, 4, 3}}};
    computeNormals(mesh);
    ASSERT_EQ(mesh.normals.size(), 5u);
    for (int axis = 0; axis < 3; ++axis)
        EXPECT_NEAR(mesh.normals[0][axis], -1 / std::sqrt(3.0), 1e-6);
}

TEST(MeshNormals, AreUnitVectorsAtAnyScaleAndForDegenerateTriangles) {
    for (const float scale : {1e-38f, 1e-20f, 1.0f, 1e20f, 3e38f}) {
        TriangleMesh mesh = samples::cube();
        for (glm::vec3& p : mesh.positions)
            p *= scale;
        mesh.positions.emplace_back(0.0f);
        mesh.positions.emplace_back(scale);
        mesh.triangles.emplace_back(0, 0, 1);
        mesh.triangles.emplace_back(8, 8, 8);
        mesh.triangles.emplace_back(0, 9, 9);
        computeNormals(mesh);
        ASSERT_EQ(mesh.normals.size(), mesh.positions.size());
        for (const glm::vec3& normal : mesh.normals)
            EXPECT_NEAR(glm::length(normal), 1.0f, 1e-6f) << scale;
        for (int i = 0; i < 8; ++i)
            EXPECT_GT(glm::dot(normalize(samples::cubePositions()[static_cast<std::size_t>(i)] -
                                         glm::vec3(0.5f)),
                               mesh.normals[static_cast<std::size_t>(i)]),
                      0.999f)
                << scale;
        EXPECT_EQ(mesh.normals[8], glm::vec3(0, 0, 1));
    }
}

TEST(MeshNormals, OppositeTrianglesCancelToADefault) {
    TriangleMesh mesh{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {}, {}, {{0, 1, 2}, {0, 2, 1}}};
    computeNormals(mesh);
    for (const glm::vec3& normal : mesh.normals)
        EXPECT_EQ(normal, glm::vec3(0, 0, 1));
}

} // namespace
} // namespace lamina
