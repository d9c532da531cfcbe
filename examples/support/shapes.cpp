#include "shapes.hpp"

#include <glm/geometric.hpp>
#include <glm/gtc/constants.hpp>

#include <cmath>

namespace example {
namespace {

using lamina::TriangleMesh;

constexpr float kTurn = glm::two_pi<float>();

std::uint32_t addVertex(TriangleMesh& mesh, const glm::vec3& position) {
    mesh.positions.push_back(position);
    return static_cast<std::uint32_t>(mesh.positions.size() - 1);
}

/// Joins two rings of `count` consecutive vertices; `shift` turns the second one.
void joinRings(TriangleMesh& mesh, std::uint32_t lower, std::uint32_t upper, unsigned count,
               unsigned shift = 0) {
    for (unsigned i = 0; i < count; ++i) {
        const unsigned next = (i + 1) % count;
        const std::uint32_t a = lower + i;
        const std::uint32_t b = lower + next;
        const std::uint32_t c = upper + (i + shift) % count;
        const std::uint32_t d = upper + (next + shift) % count;
        mesh.triangles.push_back({a, c, b});
        mesh.triangles.push_back({b, c, d});
    }
}

/// Joins a ring to a point below or above it.
void joinPole(TriangleMesh& mesh, std::uint32_t ring, std::uint32_t pole, unsigned count,
              bool poleIsAbove) {
    for (unsigned i = 0; i < count; ++i) {
        const std::uint32_t a = ring + i;
        const std::uint32_t b = ring + (i + 1) % count;
        mesh.triangles.push_back(poleIsAbove ? glm::uvec3(a, pole, b) : glm::uvec3(a, b, pole));
    }
}

/// A direction at right angles to the path, carried along it without turning about it.
struct PathFrame {
    glm::vec3 tangent;
    glm::vec3 side;

    void follow(const glm::vec3& nextTangent) {
        const glm::vec3 sum = tangent + nextTangent;
        const float share = glm::dot(nextTangent, side) / (1.0f + glm::dot(tangent, nextTangent));
        side = glm::normalize(side - share * sum);
        tangent = nextTangent;
    }
};

PathFrame firstFrame(const glm::vec3& tangent) {
    const glm::vec3 helper = std::abs(tangent.y) < 0.9f ? glm::vec3(0, 1, 0) : glm::vec3(1, 0, 0);
    return {tangent, glm::normalize(glm::cross(helper, tangent))};
}

std::uint32_t addRing(TriangleMesh& mesh, const glm::vec3& center, const PathFrame& frame,
                      float radius, unsigned sides, float turn) {
    const glm::vec3 other = glm::cross(frame.side, frame.tangent);
    const auto first = static_cast<std::uint32_t>(mesh.positions.size());
    for (unsigned i = 0; i < sides; ++i) {
        const float angle = turn + kTurn * static_cast<float>(i) / static_cast<float>(sides);
        addVertex(mesh, center + radius * (std::cos(angle) * frame.side + std::sin(angle) * other));
    }
    return first;
}

} // namespace

void addRevolved(TriangleMesh& mesh, std::span<const glm::vec2> profile, unsigned segments,
                 const Placement& place) {
    const std::uint32_t bottom = addVertex(mesh, place({0.0f, profile.front().y, 0.0f}));
    std::uint32_t previous = 0;
    for (std::size_t i = 1; i + 1 < profile.size(); ++i) {
        const auto ring = static_cast<std::uint32_t>(mesh.positions.size());
        for (unsigned s = 0; s < segments; ++s) {
            const float angle = kTurn * static_cast<float>(s) / static_cast<float>(segments);
            addVertex(mesh, place({profile[i].x * std::cos(angle), profile[i].y,
                                   profile[i].x * std::sin(angle)}));
        }
        if (i == 1)
            joinPole(mesh, ring, bottom, segments, false);
        else
            joinRings(mesh, previous, ring, segments);
        previous = ring;
    }
    joinPole(mesh, previous, addVertex(mesh, place({0.0f, profile.back().y, 0.0f})), segments,
             true);
}

void addRevolvedLoop(TriangleMesh& mesh, std::span<const glm::vec2> loop, unsigned segments,
                     float from, float to, const Placement& place) {
    const auto count = static_cast<unsigned>(loop.size());
    const bool isClosed = to - from > kTurn - 1e-4f;
    const unsigned rings = isClosed ? segments : segments + 1;
    const auto at = [&](const glm::vec2& point, unsigned ring) {
        const float share = static_cast<float>(ring) / static_cast<float>(segments);
        const float angle = from + (to - from) * share;
        return place({point.x * std::cos(angle), point.y, point.x * std::sin(angle)});
    };
    const auto first = static_cast<std::uint32_t>(mesh.positions.size());
    glm::vec2 middle(0.0f);
    for (unsigned ring = 0; ring < rings; ++ring)
        for (const glm::vec2& point : loop) {
            addVertex(mesh, at(point, ring));
            middle += point / static_cast<float>(count * rings);
        }
    for (unsigned ring = 0; ring < segments; ++ring)
        joinRings(mesh, first + ring * count, first + (ring + 1) % rings * count, count);
    if (isClosed)
        return;
    joinPole(mesh, first, addVertex(mesh, at(middle, 0)), count, false);
    joinPole(mesh, first + segments * count, addVertex(mesh, at(middle, segments)), count, true);
}

void addTube(TriangleMesh& mesh, std::span<const glm::vec3> path, std::span<const float> radii,
             unsigned sides) {
    PathFrame frame = firstFrame(glm::normalize(path[1] - path[0]));
    std::uint32_t previous = 0;
    for (std::size_t i = 0; i < path.size(); ++i) {
        const glm::vec3 before = path[i > 0 ? i - 1 : 0];
        const glm::vec3 after = path[i + 1 < path.size() ? i + 1 : i];
        frame.follow(glm::normalize(after - before));
        const std::uint32_t ring = addRing(mesh, path[i], frame, radii[i], sides, 0.0f);
        if (i == 0)
            joinPole(mesh, ring, addVertex(mesh, path[0]), sides, false);
        else
            joinRings(mesh, previous, ring, sides);
        previous = ring;
    }
    joinPole(mesh, previous, addVertex(mesh, path.back()), sides, true);
}

void addClosedTube(TriangleMesh& mesh, std::span<const glm::vec3> path, float radius,
                   unsigned sides) {
    const std::size_t count = path.size();
    const auto tangentAt = [&](std::size_t i) {
        return glm::normalize(path[(i + 1) % count] - path[(i + count - 1) % count]);
    };
    // Once around, the side comes back turned by some angle; each ring takes its share of it.
    PathFrame frame = firstFrame(tangentAt(0));
    const PathFrame start = frame;
    for (std::size_t i = 1; i <= count; ++i)
        frame.follow(tangentAt(i % count));
    const glm::vec3 other = glm::cross(start.side, start.tangent);
    const float excess = std::atan2(glm::dot(frame.side, other), glm::dot(frame.side, start.side));

    frame = start;
    std::vector<std::uint32_t> rings;
    for (std::size_t i = 0; i < count; ++i) {
        frame.follow(tangentAt(i));
        const float share = static_cast<float>(i) / static_cast<float>(count);
        rings.push_back(addRing(mesh, path[i], frame, radius, sides, -excess * share));
    }
    for (std::size_t i = 0; i < count; ++i)
        joinRings(mesh, rings[i], rings[(i + 1) % count], sides);
}

void addTriangle(TriangleMesh& mesh, const glm::vec3& a, const glm::vec3& b, const glm::vec3& c) {
    const std::uint32_t first = addVertex(mesh, a);
    addVertex(mesh, b);
    addVertex(mesh, c);
    mesh.triangles.push_back({first, first + 1, first + 2});
}

std::vector<glm::vec2> ballProfile(float radius, unsigned rings) {
    std::vector<glm::vec2> profile{{0.0f, -radius}};
    for (unsigned i = 1; i < rings; ++i) {
        const float angle = glm::pi<float>() * static_cast<float>(i) / static_cast<float>(rings);
        profile.push_back(radius * glm::vec2(std::sin(angle), -std::cos(angle)));
    }
    profile.push_back({0.0f, radius});
    return profile;
}

float noise(const glm::vec3& point) {
    float sum = 0.0f;
    glm::vec3 p = point;
    for (float weight = 0.5f; weight > 0.1f; weight *= 0.5f) {
        sum += weight * std::sin(2.1f * p.x + 1.3f * std::sin(1.7f * p.z + 0.4f)) *
               std::cos(1.9f * p.z + 1.1f * std::sin(1.5f * p.y + 2.0f)) *
               std::cos(1.3f * p.y - 0.9f * std::sin(1.2f * p.x));
        p = 2.03f * glm::vec3(p.y + 0.3f, p.z - 1.1f, p.x + 2.7f);
    }
    return sum;
}

float Random::operator()(float low, float high) {
    mState ^= mState << 13u;
    mState ^= mState >> 17u;
    mState ^= mState << 5u;
    return low + (high - low) * static_cast<float>(mState >> 8u) * 0x1p-24f;
}

} // namespace example
