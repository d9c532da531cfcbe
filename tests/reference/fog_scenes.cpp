#include <reference/fog_scenes.hpp>

#include <reference/epipolar_agreement.hpp>
#include <reference/epipolar_rays.hpp>
#include <reference/shapes.hpp>

#include <glm/geometric.hpp>

#include <cmath>
#include <numbers>
#include <random>

namespace lamina::reference {
namespace {

void addTriangle(TriangleMesh& mesh, const glm::vec3& a, const glm::vec3& b, const glm::vec3& c) {
    const auto first = static_cast<std::uint32_t>(mesh.positions.size());
    mesh.positions.insert(mesh.positions.end(), {a, b, c});
    mesh.triangles.emplace_back(first, first + 1, first + 2);
}

/// A round column without ends.
void addColumn(TriangleMesh& mesh, const glm::vec3& foot, float radius, float height) {
    constexpr int kSides = 32;
    const auto rim = [&](int side, float y) {
        const float angle = 2.0f * std::numbers::pi_v<float> * static_cast<float>(side) / kSides;
        return foot + glm::vec3(radius * std::cos(angle), y, radius * std::sin(angle));
    };
    for (int side = 0; side < kSides; ++side) {
        addTriangle(mesh, rim(side, 0.0f), rim(side, height), rim(side + 1, 0.0f));
        addTriangle(mesh, rim(side + 1, 0.0f), rim(side, height), rim(side + 1, height));
    }
}

TriangleMesh makeGround() {
    return makePlane({0.0f, 0.0f, 0.0f}, {0.0f, 1.0f, 0.0f}, 8.0f);
}

TriangleMesh makeColumns() {
    TriangleMesh mesh = makeGround();
    for (int i = 0; i < 6; ++i)
        addColumn(
            mesh,
            {-2.2f + 0.9f * static_cast<float>(i), 0.0f, -1.2f + 0.25f * static_cast<float>(i % 2)},
            0.16f, 2.4f);
    return merged(mesh, makeBox({-2.6f, 2.4f, -1.5f}, {2.8f, 2.6f, -0.6f}));
}

TriangleMesh makeFoliage() {
    TriangleMesh mesh =
        merged(makeGround(), makeBox({-0.06f, 0.0f, -0.56f}, {0.06f, 1.1f, -0.44f}));
    constexpr int kLeaves = 2500;
    constexpr float kLength = 0.13f;
    std::mt19937 random(5);
    std::normal_distribution<float> normal;
    std::uniform_real_distribution<float> unit(0.0f, 1.0f);
    const auto direction = [&] {
        return glm::normalize(glm::vec3(normal(random), normal(random), normal(random)));
    };
    for (int leaf = 0; leaf < kLeaves; ++leaf) {
        const glm::vec3 place = glm::vec3(0.0f, 1.5f, -0.5f) + glm::vec3(1.2f, 0.65f, 1.0f) *
                                                                   std::cbrt(unit(random)) *
                                                                   direction();
        const glm::vec3 along = kLength * direction();
        const glm::vec3 across = 0.3f * kLength * glm::normalize(glm::cross(along, direction()));
        addTriangle(mesh, place - along, place + across, place + along);
        addTriangle(mesh, place - along, place + along, place - across);
    }
    return mesh;
}

RectangleLight rectangle(const glm::dvec3& corner, const glm::dvec3& u, const glm::dvec3& v) {
    RectangleLight light;
    light.corner = corner;
    light.edgeU = u;
    light.edgeV = v;
    light.emission.radiance = glm::vec3(2.0f);
    return light;
}

} // namespace

std::vector<FogStudy> makeFogStudies() {
    std::vector<FogStudy> studies;
    studies.push_back({"fence",
                       makeFenceScene(),
                       frontEye(),
                       rectangle({-1.6, 2.6, -3.0}, {3.2, 0.0, 0.0}, {0.0, 1.2, 0.5}),
                       {0.12f, glm::vec3(0.9f), 0.2f}});
    studies.push_back({"columns",
                       makeColumns(),
                       makeEye({0.6, 1.5, 5.2}, {0.0, 1.0, 0.0}),
                       rectangle({-5.2, 1.2, -1.8}, {0.2, 0.0, -1.4}, {0.0, 1.6, 0.0}),
                       {0.15f, glm::vec3(0.9f), 0.0f}});
    studies.push_back({"foliage",
                       makeFoliage(),
                       makeEye({-0.4, 1.3, 4.6}, {0.0, 1.1, 0.0}),
                       rectangle({-1.2, 3.8, -1.8}, {2.4, 0.0, 0.0}, {0.0, 0.0, 1.6}),
                       {0.2f, glm::vec3(0.9f), 0.4f}});
    return studies;
}

} // namespace lamina::reference
