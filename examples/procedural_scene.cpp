// Writes a made-up scene as a PLY file: a round temple on a hill, for scripts/demo. Every part is a
// closed surface, and nothing stands upright exactly: walls lean a little, as walls of old do.
//
//   procedural_scene OUT.ply

#include "support/shapes.hpp"

#include <glm/geometric.hpp>
#include <glm/gtc/constants.hpp>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <vector>

namespace {

using namespace example;
using lamina::TriangleMesh;

constexpr float kPi = glm::pi<float>();
constexpr float kHillTop = 2.6f;
constexpr float kPlateau = 4.4f;

glm::vec3 onCircle(float radius, float angle, float height) {
    return {radius * std::cos(angle), height, radius * std::sin(angle)};
}

/// Height of the hill's surface at a distance from its axis, before its bumps.
float hillHeight(float radius) {
    const float t = std::clamp((radius - kPlateau) / 4.6f, 0.0f, 1.0f);
    const float smooth = t * t * (3.0f - 2.0f * t);
    return kHillTop * (1.0f - smooth) + 0.35f * smooth;
}

glm::vec3 bumpy(const glm::vec3& p) {
    const float radius = std::hypot(p.x, p.z);
    const float wild = std::clamp((radius - kPlateau) / 2.5f, 0.0f, 1.0f);
    return p + glm::vec3(0.0f, 0.9f * wild * noise(0.55f * p), 0.0f);
}

void addHill(TriangleMesh& mesh) {
    constexpr float kRim = 9.8f;
    constexpr unsigned kRings = 90;
    std::vector<glm::vec2> profile{{0.0f, -0.9f}, {0.55f * kRim, -0.88f}, {0.9f * kRim, -0.75f}};
    for (unsigned i = 0; i < kRings; ++i) {
        const float radius = kRim * static_cast<float>(kRings - i) / kRings;
        profile.push_back({radius, hillHeight(radius)});
    }
    profile.push_back({0.0f, hillHeight(0.0f)});
    addRevolved(mesh, profile, 240, [](const glm::vec3& p) {
        const glm::vec3 shore =
            (1.0f + 0.05f * noise(0.5f * glm::vec3(p.x, 0.0f, p.z))) * glm::vec3(p.x, 0.0f, p.z);
        return bumpy({shore.x, p.y, shore.z});
    });
}

Placement at(const glm::vec3& where) {
    return [where](const glm::vec3& p) { return where + p; };
}

void addColumn(TriangleMesh& mesh, const glm::vec3& foot, float height) {
    const std::vector<glm::vec2> profile{
        {0.0f, -0.05f},          {0.58f, -0.04f},         {0.50f, 0.12f},
        {0.40f, 0.20f},          {0.36f, 0.33f * height}, {0.29f, 0.66f * height},
        {0.20f, height - 0.34f}, {0.30f, height - 0.24f}, {0.44f, height - 0.1f},
        {0.54f, height + 0.02f}, {0.0f, height + 0.03f}};
    constexpr unsigned kFlutes = 12;
    addRevolved(mesh, profile, 4 * kFlutes, [&](const glm::vec3& p) {
        const bool isShaft = p.y > 0.15f && p.y < height - 0.3f;
        const float angle = std::atan2(p.z, p.x);
        const float flute =
            isShaft ? 1.0f - 0.09f * std::pow(std::cos(0.5f * kFlutes * angle), 2.0f) : 1.0f;
        return foot + glm::vec3(p.x * flute, p.y, p.z * flute);
    });
}

void addKnot(TriangleMesh& mesh, const glm::vec3& center, float size) {
    constexpr unsigned kSteps = 360;
    std::vector<glm::vec3> path;
    for (unsigned i = 0; i < kSteps; ++i) {
        const float t = 2.0f * kPi * static_cast<float>(i) / kSteps;
        const float ring = 1.0f + 0.42f * std::cos(3.0f * t);
        path.push_back(center + size * glm::vec3(ring * std::cos(2.0f * t),
                                                 ring * std::sin(2.0f * t),
                                                 0.55f * std::sin(3.0f * t)));
    }
    addClosedTube(mesh, path, 0.22f * size, 28);
}

void addTemple(TriangleMesh& mesh) {
    std::vector<glm::vec2> steps{{0.0f, kHillTop - 0.3f}, {4.15f, kHillTop - 0.25f}};
    for (int i = 0; i < 3; ++i) {
        const float outer = 4.05f - 0.32f * static_cast<float>(i);
        const float height = kHillTop + 0.22f * static_cast<float>(i + 1);
        steps.push_back({outer, height - 0.02f});
        steps.push_back({outer - 0.24f, height});
    }
    const float floor = kHillTop + 0.66f;
    steps.push_back({0.0f, floor + 0.01f});
    addRevolved(mesh, steps, 120, at({}));

    constexpr unsigned kColumns = 10;
    constexpr float kColumnHeight = 3.7f;
    for (unsigned i = 0; i < kColumns; ++i) {
        const float angle = 2.0f * kPi * (static_cast<float>(i) + 0.5f) / kColumns;
        addColumn(mesh, onCircle(2.75f, angle, floor), kColumnHeight);
    }

    // A ring-shaped beam with a dome on it, hollow, open below for the light.
    const float beam = floor + kColumnHeight;
    std::vector<glm::vec2> roof{{0.0f, beam + 2.15f}};
    for (int i = 1; i <= 12; ++i) {
        const float angle = 0.5f * kPi * static_cast<float>(i) / 12.0f;
        roof.push_back({2.3f * std::sin(angle), beam + 0.35f + 1.8f * std::cos(angle)});
    }
    roof.insert(roof.end(), {{2.36f, beam - 0.02f},
                             {3.15f, beam - 0.04f},
                             {3.32f, beam + 0.24f},
                             {3.62f, beam + 0.36f},
                             {3.44f, beam + 0.60f}});
    for (int i = 1; i <= 16; ++i) {
        const float angle = 0.5f * kPi * static_cast<float>(i) / 16.0f;
        roof.push_back({0.16f + 2.90f * std::cos(angle), beam + 0.62f + 2.0f * std::sin(angle)});
    }
    roof.insert(
        roof.end(),
        {{0.16f, beam + 2.78f}, {0.32f, beam + 3.02f}, {0.18f, beam + 3.3f}, {0.0f, beam + 3.6f}});
    addRevolved(mesh, roof, 144, at({}));

    addRevolved(mesh,
                std::vector<glm::vec2>{{0.0f, floor - 0.1f},
                                       {0.95f, floor - 0.1f},
                                       {0.80f, floor + 0.25f},
                                       {0.62f, floor + 0.35f},
                                       {0.52f, floor + 0.95f},
                                       {0.72f, floor + 1.08f},
                                       {0.0f, floor + 1.1f}},
                48, at({}));
    addKnot(mesh, {0.0f, floor + 2.1f, 0.0f}, 0.66f);
}

/// A block with leaning sides, its top at `height`, between two angles and two radii.
void addStep(TriangleMesh& mesh, float angle, float height) {
    constexpr float kInner = 4.05f, kOuter = 5.9f, kHalfWidth = 0.115f, kLean = 0.10f;
    const auto first = static_cast<std::uint32_t>(mesh.positions.size());
    const auto corner = [&](float side, float radius, float y, float lean) {
        const float shift = side * (kHalfWidth + lean / radius);
        mesh.positions.push_back(onCircle(radius, angle + shift, y));
    };
    const float foot = height - 1.5f;
    for (const float y : {foot, height}) {
        const float lean = y == foot ? kLean : 0.0f;
        corner(-1.0f, kInner - lean, y, lean);
        corner(-1.0f, kOuter + lean, y, lean);
        corner(1.0f, kOuter + lean, y, lean);
        corner(1.0f, kInner - lean, y, lean);
    }
    constexpr glm::uvec3 kFaces[] = {{0, 1, 2}, {0, 2, 3}, {4, 6, 5}, {4, 7, 6},
                                     {0, 5, 1}, {0, 4, 5}, {1, 6, 2}, {1, 5, 6},
                                     {2, 7, 3}, {2, 6, 7}, {3, 4, 0}, {3, 7, 4}};
    for (const glm::uvec3& face : kFaces)
        mesh.triangles.push_back(face + first);
}

/// Steps that climb around the hill to the temple.
void addStairs(TriangleMesh& mesh) {
    constexpr int kSteps = 22;
    for (int i = 0; i < kSteps; ++i) {
        const float t = static_cast<float>(i) / (kSteps - 1);
        const float out = 1.9f * (1.0f - t);
        const std::size_t first = mesh.positions.size();
        addStep(mesh, 2.15f - 0.21f * static_cast<float>(i) * 0.5f, 0.75f + 2.1f * t);
        for (std::size_t v = first; v < mesh.positions.size(); ++v) {
            glm::vec3& p = mesh.positions[v];
            const float radius = std::hypot(p.x, p.z);
            p *= glm::vec3((radius + out) / radius, 1.0f, (radius + out) / radius);
        }
    }
}

glm::vec3 onHill(float radius, float angle) {
    return bumpy(onCircle(radius, angle, hillHeight(radius)));
}

void addCypress(TriangleMesh& mesh, const glm::vec3& foot, float height, Random& random) {
    std::vector<glm::vec2> profile{{0.0f, -0.3f}, {0.14f, -0.3f}, {0.10f, 0.35f}};
    constexpr int kRings = 14;
    for (int i = 0; i < kRings; ++i) {
        const float t = static_cast<float>(i) / kRings;
        profile.push_back(
            {0.23f * height * std::pow(std::sin(kPi * std::pow(0.05f + 0.95f * t, 0.5f)), 0.9f) +
                 0.02f,
             0.4f + (height - 0.4f) * t});
    }
    profile.push_back({0.0f, height});
    const float seed = random(0.0f, 100.0f);
    addRevolved(mesh, profile, 26, [&](const glm::vec3& p) {
        const float amount = p.y > 0.4f ? 0.30f : 0.0f;
        const float swell = 1.0f + amount * noise(3.2f * p + seed);
        return foot + glm::vec3(p.x * swell, p.y, p.z * swell);
    });
}

void addRoundTree(TriangleMesh& mesh, const glm::vec3& foot, float height, Random& random) {
    const glm::vec3 lean{random(-0.3f, 0.3f), 0.0f, random(-0.3f, 0.3f)};
    const std::vector<glm::vec3> trunk{foot - glm::vec3(0.0f, 0.3f, 0.0f),
                                       foot + glm::vec3(0.0f, 0.3f * height, 0.0f) + 0.3f * lean,
                                       foot + glm::vec3(0.0f, 0.7f * height, 0.0f) + lean};
    addTube(mesh, trunk, std::vector<float>{0.20f, 0.13f, 0.09f}, 14);
    const auto ball = ballProfile(1.0f, 14);
    for (int i = 0; i < 5; ++i) {
        const float angle = 2.0f * kPi * static_cast<float>(i) / 4.0f + random(-0.4f, 0.4f);
        const float spread = i == 4 ? 0.0f : random(0.22f, 0.3f) * height;
        const float size = (i == 4 ? 0.34f : random(0.22f, 0.29f)) * height;
        const glm::vec3 center =
            foot + lean + onCircle(spread, angle, i == 4 ? 0.88f * height : 0.66f * height);
        const float seed = random(0.0f, 100.0f);
        addRevolved(mesh, ball, 26, [&](const glm::vec3& p) {
            return center + size * (1.0f + 0.30f * noise(2.6f * p + seed)) * p *
                                glm::vec3(1.0f, 0.82f, 1.0f);
        });
    }
}

void addBoulder(TriangleMesh& mesh, const glm::vec3& center, float size, Random& random) {
    const float seed = random(0.0f, 100.0f);
    const glm::vec3 shape(random(0.8f, 1.3f), random(0.5f, 0.8f), random(0.8f, 1.3f));
    addRevolved(mesh, ballProfile(1.0f, 16), 28, [&](const glm::vec3& p) {
        return center + size * shape * (1.0f + 0.45f * noise(1.4f * p + seed)) * p;
    });
}

void addGarden(TriangleMesh& mesh) {
    Random random(7);
    for (int i = 0; i < 7; ++i)
        addCypress(mesh, onHill(5.9f, 2.85f + 0.42f * static_cast<float>(i)), random(3.2f, 4.3f),
                   random);
    for (const float angle : {-0.75f, -0.1f, 0.35f, 2.5f, 3.3f, 4.3f, 5.0f})
        addRoundTree(mesh, onHill(random(7.0f, 8.0f), angle), random(2.2f, 3.1f), random);
    for (int i = 0; i < 16; ++i)
        addBoulder(mesh, onHill(random(6.6f, 9.0f), random(0.0f, 2.0f * kPi)), random(0.22f, 0.6f),
                   random);
}

TriangleMesh makeScene() {
    TriangleMesh mesh;
    addHill(mesh);
    addTemple(mesh);
    addStairs(mesh);
    addGarden(mesh);
    return mesh;
}

/// Binary PLY in this machine's byte order, which must be little-endian.
bool writePly(const char* file, const TriangleMesh& mesh) {
    std::ofstream out(file, std::ios::binary);
    out << "ply\nformat binary_little_endian 1.0\nelement vertex " << mesh.positions.size()
        << "\nproperty float x\nproperty float y\nproperty float z\nelement face "
        << mesh.triangles.size() << "\nproperty list uchar uint vertex_indices\nend_header\n";
    out.write(reinterpret_cast<const char*>(mesh.positions.data()),
              static_cast<std::streamsize>(mesh.positions.size() * sizeof(glm::vec3)));
    for (const glm::uvec3& triangle : mesh.triangles) {
        out.put(3);
        out.write(reinterpret_cast<const char*>(&triangle), sizeof triangle);
    }
    out.close();
    return out.good();
}

} // namespace

int main(int argc, char** argv) {
    if (argc != 2) {
        std::fprintf(stderr, "usage: procedural_scene OUT.ply\n");
        return 2;
    }
    const TriangleMesh scene = makeScene();
    if (!writePly(argv[1], scene)) {
        std::fprintf(stderr, "procedural_scene: cannot write %s\n", argv[1]);
        return 1;
    }
    std::printf("%s: %zu triangles\n", argv[1], scene.triangles.size());
    return 0;
}
