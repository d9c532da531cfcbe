// Rays marched through volumes of voxels against exact paths through the same bodies.

#include "gl/support/gl_test.hpp"

#include <lamina/gl/shaders.hpp>
#include <lamina/refraction/refraction.hpp>

#include <reference/shapes.hpp>

#include <support/glass_reference.hpp>

#include <glm/geometric.hpp>
#include <glm/gtc/matrix_transform.hpp>
#include <glm/trigonometric.hpp>

#include <algorithm>
#include <cmath>

namespace lamina {
namespace {

namespace ref = reference;
using Bodies = std::vector<std::unique_ptr<example::GlassBody>>;

constexpr double kIndex = 1.5;
constexpr const char* kProgram = R"(
layout(local_size_x = 64) in;
struct Ray { vec4 point; vec4 normal; vec4 direction; };
layout(std430, binding = 0) buffer Rays { Ray rays[]; };
layout(std430, binding = 1) buffer Paths { vec4 paths[]; };
void main() {
    uint i = gl_GlobalInvocationID.x;
    if (i >= rays.length())
        return;
    LaminaRefracted path = laminaRefract(rays[i].point.xyz, rays[i].normal.xyz, rays[i].direction.xyz, vec2(0.0));
    paths[2u * i] = vec4(path.direction, path.inside);
    paths[2u * i + 1u] = vec4(path.exit, float(path.events));
}
)";

struct Ray {
    glm::vec4 point, normal, direction;
};

/// What a path of the device misses its exact one by.
struct Errors {
    std::vector<double> degrees; ///< Sorted.
    std::size_t reflected = 0;   ///< Rays with a total internal reflection.

    [[nodiscard]] double at(double share) const {
        return degrees[static_cast<std::size_t>(share * static_cast<double>(degrees.size() - 1))];
    }
    [[nodiscard]] double shareBelow(double angle) const {
        return static_cast<double>(std::ranges::lower_bound(degrees, angle) - degrees.begin()) /
               static_cast<double>(degrees.size());
    }
};

class RefractionPathGlTest : public test::GlTest {
protected:
    /// Rays from a camera that meet the bodies at the pixels of a 256 x 256 picture.
    struct Seen {
        std::vector<Ray> rays;
        std::vector<example::GlassPath> paths;
    };

    static Seen look(const Bodies& bodies, const glm::dvec3& eye, int maxEvents) {
        constexpr int kPixels = 256;
        const glm::dmat4 camera =
            glm::inverse(glm::lookAt(eye, glm::dvec3(0.0), glm::dvec3(0.0, 1.0, 0.0)));
        const double window = 1.6 / glm::length(eye);
        Seen seen;
        for (int y = 0; y < kPixels; ++y)
            for (int x = 0; x < kPixels; ++x) {
                const glm::dvec2 at = (glm::dvec2(x, y) + 0.5) / double{kPixels} * 2.0 - 1.0;
                const glm::dvec3 direction =
                    glm::normalize(glm::dvec3(camera * glm::dvec4(at * window, -1.0, 0.0)));
                const auto hit = example::hitGlass(bodies, eye, direction);
                if (!hit)
                    continue;
                const glm::dvec3 point = eye + hit->distance * direction;
                seen.rays.push_back({glm::vec4(point, 1.0), glm::vec4(hit->normal, 0.0),
                                     glm::vec4(direction, 0.0)});
                seen.paths.push_back(
                    example::traceGlass(bodies, point, *hit, direction, maxEvents));
            }
        return seen;
    }

    Errors measure(const char* name, const Bodies& bodies, const TriangleMesh& mesh,
                   RefractionModel model, int maxExactEvents,
                   std::span<const Material> materials = {}) {
        const glm::dvec3 eye(1.2, 0.9, 3.0);
        const Seen seen = look(bodies, eye, 20);
        auto refraction = Refraction::create(device(), {.model = model, .voxels = 256}).value();
        RefractionSettings settings;
        settings.maxEvents = 20;
        EXPECT_TRUE(refraction.setSettings(settings));
        auto environment = Environment::create(device(), {.size = 1}).value();
        refraction.setEnvironment(environment);
        Material glass;
        glass.refractiveIndex = static_cast<float>(kIndex);
        auto buffers = MeshBuffers::upload(device(), mesh).value();
        const GeometrySource source = buffers.view();
        RefractionObject object;
        object.sources = {&source, 1};
        object.materials = materials.empty() ? std::span<const Material>(&glass, 1) : materials;
        object.bounds = mesh.bounds();
        View view;
        view.size = {8, 8};
        const auto prepared = refraction.prepare(object, view);
        EXPECT_TRUE(prepared) << prepared.error().text;
        const GLuint program = buildProgram(
            {{GL_COMPUTE_SHADER, "#version 450 core\n" + refraction.shaderDefines(2, 3) +
                                     shaderSource("lamina/refraction.glsl").value() + kProgram}});
        refraction.bind(2, 3);
        std::vector<glm::vec4> found(2 * seen.rays.size());
        runCompute(program, std::as_bytes(std::span(seen.rays)),
                   std::as_writable_bytes(std::span(found)),
                   static_cast<std::uint32_t>(seen.rays.size()));
        gl().DeleteProgram(program);

        Errors errors;
        std::size_t considered = 0;
        for (std::size_t i = 0; i < seen.paths.size(); ++i) {
            const glm::vec3 direction(found[2 * i]);
            EXPECT_NEAR(glm::length(direction), 1.0f, 1e-3f);
            const example::GlassPath& path = seen.paths[i];
            if (path.events > maxExactEvents)
                continue;
            ++considered;
            errors.reflected += path.reflections > 0 ? 1 : 0;
            const double cosine = glm::dot(glm::normalize(glm::dvec3(direction)), path.direction);
            errors.degrees.push_back(glm::degrees(std::acos(std::clamp(cosine, -1.0, 1.0))));
        }
        std::ranges::sort(errors.degrees);
        std::printf("%-30s %zu of %zu rays, %zu reflected; off by degrees: median %.2f, 90 %% "
                    "%.2f, 95 %% %.2f, 99 %% %.2f; within 2: %.1f %%, 3: %.1f %%\n",
                    name, considered, seen.paths.size(), errors.reflected, errors.at(0.5),
                    errors.at(0.9), errors.at(0.95), errors.at(0.99),
                    100.0 * errors.shareBelow(2.0), 100.0 * errors.shareBelow(3.0));
        return errors;
    }

    static Bodies one(std::unique_ptr<example::GlassBody> body) {
        Bodies bodies;
        bodies.push_back(std::move(body));
        return bodies;
    }

    /// An icosphere with the sphere's own normals.
    static TriangleMesh ball(const glm::vec3& center, float radius) {
        TriangleMesh mesh = ref::makeIcosphere(center, radius, 6);
        for (const glm::vec3& position : mesh.positions)
            mesh.normals.push_back(glm::normalize(position - center));
        return mesh;
    }
};

TEST_F(RefractionPathGlTest, TwoSurfacesOfASphereAndASlab) {
    const auto sphere =
        measure("two surfaces, sphere", one(example::makeGlassBall({0, 0, 0}, 1.0, kIndex)),
                ball({0, 0, 0}, 1.0f), RefractionModel::TwoSurfaces, 1);
    EXPECT_GE(sphere.shareBelow(2.0), 0.95);
    // A slab, seen through its large faces.
    const auto slab = measure(
        "two surfaces, slab", one(example::makeGlassBox({-1, -1, -0.15}, {1, 1, 0.15}, kIndex)),
        ref::makeBox({-1, -1, -0.15f}, {1, 1, 0.15f}), RefractionModel::TwoSurfaces, 1);
    EXPECT_GE(slab.shareBelow(2.0), 0.95);
}

TEST_F(RefractionPathGlTest, ManySurfacesOfASphere) {
    const auto errors =
        measure("many surfaces, sphere", one(example::makeGlassBall({0, 0, 0}, 1.0, kIndex)),
                ball({0, 0, 0}, 1.0f), RefractionModel::ManySurfaces, 4);
    EXPECT_GE(errors.shareBelow(3.0), 0.90);
}

TEST_F(RefractionPathGlTest, ManySurfacesOfAHollowSphere) {
    Bodies bodies;
    bodies.push_back(example::makeGlassBall({0, 0, 0}, 1.0, kIndex));
    bodies.push_back(example::makeGlassBall({0, 0, 0}, 0.7, kIndex, true));
    TriangleMesh hole = ref::flipped(ball({0, 0, 0}, 0.7f));
    for (glm::vec3& normal : hole.normals)
        normal = -normal;
    TriangleMesh mesh = ball({0, 0, 0}, 1.0f);
    const auto offset = static_cast<unsigned>(mesh.positions.size());
    mesh.positions.insert(mesh.positions.end(), hole.positions.begin(), hole.positions.end());
    mesh.normals.insert(mesh.normals.end(), hole.normals.begin(), hole.normals.end());
    for (const glm::uvec3& triangle : hole.triangles)
        mesh.triangles.push_back(triangle + offset);
    const auto errors =
        measure("many surfaces, hollow sphere", bodies, mesh, RefractionModel::ManySurfaces, 4);
    EXPECT_GE(errors.shareBelow(3.0), 0.90);
    EXPECT_GT(errors.reflected, 500u);
}

TEST_F(RefractionPathGlTest, ManySurfacesOfACube) {
    const auto errors =
        measure("many surfaces, cube",
                one(example::makeGlassBox({-0.7, -0.7, -0.7}, {0.7, 0.7, 0.7}, kIndex)),
                ref::makeCube({0, 0, 0}, 1.4f), RefractionModel::ManySurfaces, 4);
    EXPECT_GE(errors.shareBelow(3.0), 0.90);
    EXPECT_GT(errors.reflected, 5000u);
}

} // namespace
} // namespace lamina
