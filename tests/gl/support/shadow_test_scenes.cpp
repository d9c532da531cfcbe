#include "gl/support/shadow_test_scenes.hpp"

#include <reference/shapes.hpp>

#include <glm/geometric.hpp>

#include <cmath>
#include <optional>
#include <string>

namespace lamina::test {
namespace {

struct TestScene {
    const char* name;
    std::vector<ScenePart> parts;
};

/// A number in [0,1) of a seed, the same everywhere.
float chance(std::uint32_t& seed) {
    seed = seed * 1664525u + 1013904223u;
    return static_cast<float>(seed >> 8) / 16777216.0f;
}

std::vector<ScenePart> scattered(std::uint32_t seed, unsigned count,
                                 const std::function<TriangleMesh(const glm::vec3&, float)>& make) {
    std::vector<ScenePart> parts{floorPart()};
    for (unsigned i = 0; i < count; ++i) {
        const float size = 0.15f + 0.35f * chance(seed);
        const float x = 7.0f * (chance(seed) - 0.5f), z = 7.0f * (chance(seed) - 0.5f);
        parts.push_back({make({x, size + 2.0f * chance(seed), z}, size)});
    }
    return parts;
}

/// Does a triangle of the parts that cast lie between a point and the light?
bool isShadowed(const std::vector<ScenePart>& parts, const glm::dvec3& point,
                const glm::dvec4& light) {
    const glm::dvec3 along =
        light.w == 0.0 ? 1e3 * glm::normalize(glm::dvec3(light)) : glm::dvec3(light) - point;
    for (const ScenePart& part : parts)
        for (const glm::uvec3& t : part.mesh.triangles) {
            if (!part.casts)
                break;
            const glm::dvec3 a(part.mesh.positions[t.x]);
            const glm::dvec3 p = glm::dvec3(part.mesh.positions[t.y]) - a;
            const glm::dvec3 q = glm::dvec3(part.mesh.positions[t.z]) - a;
            const glm::dvec3 across = glm::cross(along, q);
            const double determinant = glm::dot(p, across);
            const double u = glm::dot(point - a, across) / determinant;
            const glm::dvec3 other = glm::cross(point - a, p);
            const double v = glm::dot(along, other) / determinant;
            const double at = glm::dot(q, other) / determinant;
            if (u > 0.0 && v > 0.0 && u + v < 1.0 && at > 0.0 && at < 1.0)
                return true;
        }
    return false;
}

std::vector<TestScene> makeScenes() {
    std::vector<TestScene> scenes;
    scenes.push_back({"boxes", scattered(1, 14, [](const glm::vec3& at, float size) {
                          return reference::makeCube(at, 2.0f * size);
                      })});
    scenes.push_back({"spheres", scattered(2, 14, [](const glm::vec3& at, float size) {
                          return reference::makeIcosphere(at, size, 2);
                      })});
    scenes.push_back({"tori", scattered(3, 8, [](const glm::vec3& at, float size) {
                          return reference::makeTorus(at, size, 0.3f * size, 20, 8);
                      })});
    scenes.push_back({"plates", scattered(4, 12, [](const glm::vec3& at, float size) {
                          return reference::makePlane(at, at - glm::vec3(0.3f), 2.0f * size);
                      })});
    scenes.push_back({"knots", scattered(5, 4, [](const glm::vec3& at, float size) {
                          return reference::makeTorusKnot(at, size, 0.2f * size, 2, 3, 48, 6);
                      })});
    std::vector<ScenePart> wall{floorPart()};
    wall.push_back({reference::makeBox({-3.0f, 0.0f, -0.1f}, {3.0f, 3.0f, 0.1f})});
    for (int i = 0; i < 6; ++i)
        wall.push_back(
            {reference::makeCube({-2.0f + 0.8f * static_cast<float>(i), 0.5f, -1.5f}, 0.5f)});
    scenes.push_back({"behind a wall", wall});
    std::vector<ScenePart> tower{floorPart()};
    for (int i = 0; i < 8; ++i)
        tower.push_back({reference::makeBox({-0.4f, 0.5f * static_cast<float>(i), -0.4f},
                                            {0.4f, 0.5f * static_cast<float>(i) + 0.3f, 0.4f})});
    scenes.push_back({"tower", tower});
    std::vector<ScenePart> fence{floorPart()};
    for (int i = 0; i < 20; ++i) {
        const float x = -3.0f + 0.3f * static_cast<float>(i);
        fence.push_back({reference::makeBox({x, 0.0f, 0.0f}, {x + 0.04f, 1.5f, 0.04f})});
    }
    scenes.push_back({"fence", fence});
    scenes.push_back(
        {"sponge", {floorPart(), {reference::makeMengerSponge({0.0f, 1.6f, 0.0f}, 3.0f, 2)}}});
    std::vector<ScenePart> nested{floorPart()};
    const float radii[] = {1.4f, 1.2f};
    nested.push_back({reference::makeNestedShells({0.0f, 1.6f, 0.0f}, radii, 2)});
    nested.push_back({reference::makeIcosphere({0.0f, 1.6f, 0.0f}, 0.6f, 2)});
    nested.push_back({reference::makeTriangleSoup({{-3, 0.3, -3}, {3, 2, 3}}, 40, 0.8f, 9)});
    scenes.push_back({"nested and soup", nested});
    return scenes;
}

View viewAt(unsigned step, const glm::uvec2& size) {
    const double angle = 0.7 + 1.9 * step;
    return lookAt({6.5 * std::sin(angle), 2.2 + 0.9 * step, 6.5 * std::cos(angle)}, {0, 0.8, 0},
                  size);
}

glm::dvec4 lightAt(unsigned step, bool isSun) {
    const double angle = 2.3 + 1.1 * step;
    if (isSun)
        return {std::sin(angle), 0.8 + 0.3 * step, std::cos(angle), 0.0};
    return {3.0 * std::sin(angle), 4.0 - step, 3.0 * std::cos(angle), 1.0};
}

/// A view from a place in the casters' shadow; none if there is hardly any.
std::optional<View> shadowedView(const std::vector<ScenePart>& parts, const glm::dvec4& light,
                                 const glm::uvec2& size, double near) {
    std::uint32_t seed = 3;
    constexpr int kTries = 5000;
    for (int i = 0; i < kTries; ++i) {
        const glm::dvec3 eye(5.0 * (chance(seed) - 0.5), 0.12 + chance(seed),
                             5.0 * (chance(seed) - 0.5));
        if (isShadowed(parts, eye, light))
            return lookAt(eye, glm::dvec3(0.0, 0.5, 0.0) - 0.1 * eye, size, near);
    }
    return {};
}

} // namespace

ScenePart floorPart() {
    return {reference::makePlane({0, 0, 0}, {0, 1, 0}, 30.0f, 8), false};
}

ShadowScene ShadowScenesGlTest::sceneOf(SceneHost& host, const View& view,
                                        const glm::dvec4& light) {
    ShadowScene scene;
    scene.view = view;
    scene.depthTexture = host.drawDepth(view);
    scene.light = light;
    scene.casters = host.casters();
    scene.receivers = host.sources();
    return scene;
}

std::size_t ShadowScenesGlTest::differences(const std::vector<float>& a,
                                            const std::vector<float>& b) {
    std::size_t count = 0;
    for (std::size_t i = 0; i < a.size(); ++i)
        count += a[i] != b[i] ? 1 : 0;
    return count;
}

void ShadowScenesGlTest::forAll(unsigned steps, const Check& check, std::size_t everyScene) {
    const std::vector<TestScene> scenes = makeScenes();
    for (std::size_t i = 0; i < scenes.size(); i += everyScene) {
        SceneHost host(device(), scenes[i].parts);
        for (unsigned step = 0; step < steps; ++step)
            for (const bool isSun : {true, false}) {
                SCOPED_TRACE(std::string(scenes[i].name) + (isSun ? ", sun " : ", lamp ") +
                             std::to_string(step));
                check(sceneOf(host, viewAt(step, kSize), lightAt(step, isSun)));
            }
    }
}

unsigned ShadowScenesGlTest::forAllInShadow(const Check& check) {
    unsigned views = 0;
    for (const TestScene& scene : makeScenes()) {
        SceneHost host(device(), scene.parts);
        for (const bool isSun : {true, false})
            for (const double near : {0.02, 0.8}) {
                const glm::dvec4 light = lightAt(isSun ? 0 : 1, isSun);
                const auto view = shadowedView(scene.parts, light, kSize, near);
                if (!view)
                    continue;
                SCOPED_TRACE(std::string(scene.name) + (isSun ? ", sun, near " : ", lamp, near ") +
                             std::to_string(near));
                ++views;
                check(sceneOf(host, *view, light));
            }
    }
    return views;
}

} // namespace lamina::test
