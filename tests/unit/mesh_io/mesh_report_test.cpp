#include "mesh_samples.hpp"

#include <lamina/mesh_io/mesh_report.hpp>

// OpenMesh's headers do not pass our warnings.
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wall"
#pragma GCC diagnostic ignored "-Wextra"
#pragma GCC diagnostic ignored "-Wpedantic"
#include <OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh>
#pragma GCC diagnostic pop

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <map>
#include <random>
#include <set>

namespace lamina {
namespace {

MeshReport inspected(const TriangleMesh& mesh) {
    const Result<MeshReport> report = inspect(mesh);
    EXPECT_TRUE(report);
    return report ? *report : MeshReport{};
}

TEST(MeshReport, Cube) {
    const MeshReport report = inspected(samples::cube());
    EXPECT_EQ(report.triangles, 12u);
    EXPECT_EQ(report.vertices, 8u);
    EXPECT_EQ(report.distinctPositions, 8u);
    EXPECT_EQ(report.degenerateTriangles, 0u);
    EXPECT_EQ(report.openEdges, 0u);
    EXPECT_EQ(report.openLoops, 0u);
    EXPECT_EQ(report.components, 1u);
    EXPECT_TRUE(report.watertight());
    EXPECT_DOUBLE_EQ(report.signedVolume, 1.0);
    EXPECT_EQ(report.bounds.min, glm::dvec3(0));
    EXPECT_EQ(report.bounds.max, glm::dvec3(1));
}

TEST(MeshReport, UnweldedAndInsideOutCube) {
    TriangleMesh soup;
    for (const glm::uvec3& t : samples::cubeTriangles()) {
        const auto first = static_cast<unsigned>(soup.positions.size());
        for (const int corner : {0, 2, 1})
            soup.positions.push_back(samples::cubePositions()[t[corner]] * glm::vec3(1, -0.0f, 1) +
                                     glm::vec3(0, samples::cubePositions()[t[corner]].y, 0));
        soup.triangles.emplace_back(first, first + 1, first + 2);
    }
    const MeshReport report = inspected(soup);
    EXPECT_EQ(report.vertices, 36u);
    EXPECT_EQ(report.distinctPositions, 8u);
    EXPECT_TRUE(report.watertight());
    EXPECT_DOUBLE_EQ(report.signedVolume, -1.0);
}

TEST(MeshReport, HolesAreLoopsOfOpenEdges) {
    TriangleMesh mesh = samples::cube();
    mesh.triangles.erase(mesh.triangles.begin() + 4); // half of one face
    MeshReport report = inspected(mesh);
    EXPECT_EQ(report.openEdges, 3u);
    EXPECT_EQ(report.openLoops, 1u);
    EXPECT_FALSE(report.watertight());
    EXPECT_TRUE(report.consistentOrientation());

    // Bottom and top opened: two loops of four edges.
    mesh = samples::cube();
    mesh.triangles.erase(mesh.triangles.begin(), mesh.triangles.begin() + 4);
    report = inspected(mesh);
    EXPECT_EQ(report.openEdges, 8u);
    EXPECT_EQ(report.openLoops, 2u);
    EXPECT_EQ(report.components, 1u);

    // Two triangles that touch in a vertex: two loops that touch there, one component.
    report = inspected({{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {-1, 0, 0}, {0, -1, 0}},
                        {},
                        {},
                        {{0, 1, 2}, {0, 3, 4}}});
    EXPECT_EQ(report.openEdges, 6u);
    EXPECT_EQ(report.openLoops, 2u);
    EXPECT_EQ(report.components, 1u);
}

TEST(MeshReport, NonManifoldAndFlipped) {
    TriangleMesh book{{{0, 0, 0}, {0, 0, 1}, {1, 0, 0}, {0, 1, 0}, {-1, 0, 0}},
                      {},
                      {},
                      {{0, 1, 2}, {0, 1, 3}, {1, 0, 4}}};
    MeshReport report = inspected(book);
    EXPECT_EQ(report.nonManifoldEdges, 1u);
    EXPECT_EQ(report.openEdges, 6u);
    EXPECT_EQ(report.openLoops, 3u);
    EXPECT_FALSE(report.consistentOrientation());

    TriangleMesh flipped = samples::cube();
    std::swap(flipped.triangles[0].x, flipped.triangles[0].y);
    report = inspected(flipped);
    EXPECT_EQ(report.flippedEdges, 3u);
    EXPECT_EQ(report.openEdges, 0u);
    EXPECT_FALSE(report.watertight());

    // Two cubes that share an edge: each watertight, together four triangles at that edge.
    TriangleMesh cubes = samples::cube();
    for (const glm::vec3& p : samples::cubePositions())
        cubes.positions.push_back(p + glm::vec3(1, 1, 0));
    for (const glm::uvec3& t : samples::cubeTriangles())
        cubes.triangles.push_back(t + 8u);
    report = inspected(cubes);
    EXPECT_EQ(report.nonManifoldEdges, 1u);
    EXPECT_EQ(report.distinctPositions, 14u);
    EXPECT_EQ(report.components, 1u);
    EXPECT_FALSE(report.watertight());
}

TEST(MeshReport, DegenerateEmptyAndNonFinite) {
    const float nan = std::numeric_limits<float>::quiet_NaN();
    const float inf = std::numeric_limits<float>::infinity();
    TriangleMesh mesh = samples::cube();
    mesh.positions.insert(mesh.positions.end(),
                          {{nan, 0, 0}, {0, inf, 0}, {0.5f, 0.5f, 0.5f}, {2, 2, 2}, {3, 3, 3}});
    mesh.triangles.insert(mesh.triangles.end(), {{0, 0, 1}, {3, 3, 3}, {10, 11, 12}, {8, 9, 10}});
    const MeshReport report = inspected(mesh);
    EXPECT_EQ(report.nonFiniteVertices, 2u);
    EXPECT_EQ(report.degenerateTriangles, 3u);
    EXPECT_EQ(report.openEdges, 6u);
    EXPECT_DOUBLE_EQ(report.signedVolume, 1.0);
    EXPECT_EQ(report.bounds.max, glm::dvec3(3));

    const MeshReport empty = inspected({});
    EXPECT_EQ(empty.components, 0u);
    EXPECT_FALSE(empty.watertight());
    EXPECT_TRUE(empty.bounds.isEmpty());
}

TEST(MeshReport, IndexOutOfRange) {
    TriangleMesh mesh = samples::cube();
    mesh.triangles[5].y = 8;
    const Result<MeshReport> report = inspect(mesh);
    ASSERT_FALSE(report);
    EXPECT_EQ(report.error().code, ErrorCode::InvalidMesh);
    EXPECT_THAT(report.error().text,
                testing::HasSubstr("vertex indices below 8, found 8 in triangle 5"));
}

/// A torus of n x n quads, some of them left out.
TriangleMesh torusWithHoles(unsigned n, unsigned seed) {
    TriangleMesh mesh;
    for (unsigned i = 0; i < n * n; ++i) {
        const double u = 6.283185307 * (i % n) / n;
        const double v = 6.283185307 * (i / n) / n;
        mesh.positions.emplace_back((2 + std::cos(v)) * std::cos(u),
                                    (2 + std::cos(v)) * std::sin(u), std::sin(v));
    }
    std::mt19937 random(seed);
    for (unsigned i = 0; i < n * n; ++i) {
        const auto at = [n](unsigned x, unsigned y) { return y % n * n + x % n; };
        const unsigned x = i % n, y = i / n;
        if (random() % 8 != 0)
            mesh.triangles.emplace_back(at(x, y), at(x + 1, y), at(x + 1, y + 1));
        if (random() % 8 != 0)
            mesh.triangles.emplace_back(at(x, y), at(x + 1, y + 1), at(x, y + 1));
    }
    return mesh;
}

/// Walks each hole's rim, turning around every vertex through its triangles.
std::uint64_t loopsByWalking(const TriangleMesh& mesh) {
    std::map<std::pair<unsigned, unsigned>, unsigned> third; // by directed edge
    for (const glm::uvec3& t : mesh.triangles)
        for (int corner = 0; corner < 3; ++corner)
            third[{t[corner], t[(corner + 1) % 3]}] = t[(corner + 2) % 3];
    const auto isOpen = [&](unsigned from, unsigned to) { return !third.contains({to, from}); };
    std::set<std::pair<unsigned, unsigned>> seen;
    std::uint64_t loops = 0;
    for (const auto& [edge, ignored] : third) {
        if (!isOpen(edge.first, edge.second) || seen.contains(edge))
            continue;
        ++loops;
        for (auto [from, to] = edge; seen.insert({from, to}).second;) {
            unsigned next = third.at({from, to});
            while (!isOpen(to, next))
                next = third.at({next, to});
            from = to;
            to = next;
        }
    }
    return loops;
}

TEST(MeshReport, AgreesWithOpenMeshAndAWalk) {
    for (unsigned seed = 0; seed < 20; ++seed) {
        const TriangleMesh mesh = torusWithHoles(6 + seed, seed);
        OpenMesh::TriMesh_ArrayKernelT<> oracle;
        for (const glm::vec3& p : mesh.positions)
            oracle.add_vertex({p.x, p.y, p.z});
        for (const glm::uvec3& t : mesh.triangles)
            oracle.add_face(oracle.vertex_handle(t.x), oracle.vertex_handle(t.y),
                            oracle.vertex_handle(t.z));
        std::uint64_t openEdges = 0;
        for (const auto edge : oracle.edges())
            openEdges += oracle.is_boundary(edge);
        const MeshReport report = inspected(mesh);
        EXPECT_EQ(report.openEdges, openEdges) << seed;
        EXPECT_EQ(report.openLoops, loopsByWalking(mesh)) << seed;
        EXPECT_EQ(report.nonManifoldEdges + report.flippedEdges, 0u) << seed;
    }
}

} // namespace
} // namespace lamina
