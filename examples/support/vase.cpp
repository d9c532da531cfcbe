#include "vase.hpp"

#include "shapes.hpp"

#include <glm/geometric.hpp>
#include <glm/gtc/constants.hpp>

#include <algorithm>
#include <cmath>

namespace example {
namespace {

/// The last surface that a ray meets.
std::optional<GlassHit> farthest(std::span<const std::unique_ptr<GlassBody>> bodies,
                                 const glm::dvec3& origin, const glm::dvec3& direction) {
    std::optional<GlassHit> last;
    while (const auto next =
               hitGlass(bodies, origin, direction, last ? last->distance + 1e-7 : 1e-7))
        last = next;
    return last;
}

glm::dvec3 bend(const glm::dvec3& direction, const glm::dvec3& normal, double eta) {
    const double cosine = glm::dot(direction, normal);
    const double root = 1.0 - eta * eta * (1.0 - cosine * cosine);
    if (root < 0.0)
        return glm::reflect(direction, normal);
    return glm::normalize(eta * direction - (eta * cosine + std::sqrt(root)) * normal);
}

} // namespace

std::vector<glm::vec2> vaseProfile() {
    constexpr int kSteps = 48;
    constexpr float kWall = 0.09f;
    const auto outer = [](float t) {
        return 0.42f + 0.26f * std::sin(4.4f * t + 0.3f) * std::exp(-0.5f * t) + 0.16f * t * t * t;
    };
    std::vector<glm::vec2> profile = {{0.0f, -1.0f}, {0.40f, -1.0f}};
    for (int i = 0; i <= kSteps; ++i) {
        const float t = static_cast<float>(i) / kSteps;
        profile.push_back({outer(t), -0.96f + 1.93f * t});
    }
    const float rim = outer(1.0f);
    for (int i = 1; i < 8; ++i) {
        const float angle = glm::pi<float>() * static_cast<float>(i) / 8.0f;
        profile.push_back({rim - 0.5f * kWall * (1.0f - std::cos(angle)),
                           0.97f + 0.5f * kWall * std::sin(angle)});
    }
    constexpr float kFloor = 0.14f; // Of the height: the thick foot.
    for (int i = kSteps; i >= 0; --i) {
        const float t = kFloor + (1.0f - kFloor) * static_cast<float>(i) / kSteps;
        profile.push_back({outer(t) - kWall, -0.96f + 1.93f * t});
    }
    const float bottom = profile.back().y;
    const float width = profile.back().x;
    for (int i = 1; i < 8; ++i) {
        const float angle = glm::half_pi<float>() * static_cast<float>(i) / 8.0f;
        profile.push_back({width * std::cos(angle), bottom - 0.08f * std::sin(angle)});
    }
    profile.push_back({0.0f, bottom - 0.08f});
    return profile;
}

lamina::TriangleMesh makeRevolvedMesh(std::span<const glm::vec2> profile, unsigned segments) {
    lamina::TriangleMesh mesh;
    addRevolved(mesh, profile, segments, [](const glm::vec3& p) { return p; });
    const std::vector<glm::dvec2> normals = profileNormals(profile);
    // A pole, the rings, and the other pole.
    const auto add = [&](const glm::dvec2& normal, const glm::vec3& position) {
        const glm::vec2 around =
            glm::vec2(position.x, position.z) / std::max(std::hypot(position.x, position.z), 1e-9f);
        const glm::vec2 n(normal);
        mesh.normals.push_back({n.x * around.x, n.y, n.x * around.y});
    };
    add(normals.front(), mesh.positions.front());
    for (std::size_t i = 1; i + 1 < profile.size(); ++i)
        for (unsigned s = 0; s < segments; ++s)
            add(normals[i], mesh.positions[mesh.normals.size()]);
    add(normals.back(), mesh.positions.back());
    return mesh;
}

GlassPath traceByImages(std::span<const std::unique_ptr<GlassBody>> bodies, const glm::dvec3& eye,
                        const glm::dvec3& point, const GlassHit& first,
                        const glm::dvec3& direction) {
    const glm::dvec3 bent = bend(direction, first.normal, 1.0 / first.index);
    const auto along = farthest(bodies, point, direction);
    const auto across = farthest(bodies, point, -first.normal);
    const double straight = along ? along->distance : 0.0;
    const double thickness = across ? across->distance : straight;
    const double incident = std::acos(std::clamp(-glm::dot(direction, first.normal), 0.0, 1.0));
    const double refracted = std::acos(std::clamp(-glm::dot(bent, first.normal), 0.0, 1.0));
    const double share = incident > 1e-6 ? refracted / incident : 1.0;
    const double distance = share * straight + (1.0 - share) * thickness;
    GlassPath path{point + distance * bent, bent, distance, 1};
    // The normal that the map of the farthest surfaces holds where the second point is seen.
    const glm::dvec3 towards = glm::normalize(path.exit - eye);
    const auto second = farthest(bodies, eye, towards);
    if (second && glm::dot(bent, second->normal) > 0.0)
        path.direction = bend(bent, -second->normal, second->index);
    return path;
}

} // namespace example
