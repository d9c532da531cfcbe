// Rays marched through volumes of voxels against exact paths through the same bodies.

#include "gl/support/gl_test.hpp"

#include <lamina/gl/shaders.hpp>
#include <lamina/refraction/refraction.hpp>

#include <reference/shapes.hpp>

#include <support/glass_reference.hpp>
#include <support/sky.hpp>
#include <support/vase.hpp>

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/gtc/matrix_transform.hpp>
#include <glm/trigonometric.hpp>

#include <algorithm>
#include <array>
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

    /// Marches the rays: directions and lengths inside, then exits and events, by turns.
    std::vector<glm::vec4> march(const std::vector<Ray>& rays, std::span<const TriangleMesh> meshes,
                                 RefractionModel model, std::span<const Material> materials) {
        auto refraction = Refraction::create(device(), {.model = model, .voxels = 256}).value();
        RefractionSettings settings;
        settings.maxEvents = 20;
        EXPECT_TRUE(refraction.setSettings(settings));
        auto environment = Environment::create(device(), {.size = 1}).value();
        refraction.setEnvironment(environment);
        std::vector<MeshBuffers> buffers;
        std::vector<GeometrySource> sources;
        RefractionObject object;
        for (const TriangleMesh& mesh : meshes) {
            buffers.push_back(MeshBuffers::upload(device(), mesh).value());
            MeshView source = buffers.back().view();
            source.materialId = static_cast<std::uint32_t>(sources.size());
            sources.push_back(source);
            object.bounds.extend(mesh.bounds().min);
            object.bounds.extend(mesh.bounds().max);
        }
        object.sources = sources;
        object.materials = materials;
        View view;
        view.size = {8, 8};
        const auto prepared = refraction.prepare(object, view);
        EXPECT_TRUE(prepared) << prepared.error().text;
        const GLuint program = buildProgram(
            {{GL_COMPUTE_SHADER, "#version 450 core\n" + refraction.shaderDefines(2, 3) +
                                     shaderSource("lamina/refraction.glsl").value() + kProgram}});
        refraction.bind(2, 3);
        std::vector<glm::vec4> found(2 * rays.size());
        runCompute(program, std::as_bytes(std::span(rays)),
                   std::as_writable_bytes(std::span(found)),
                   static_cast<std::uint32_t>(rays.size()));
        gl().DeleteProgram(program);
        return found;
    }

    Errors measure(const char* name, const Bodies& bodies, std::span<const TriangleMesh> meshes,
                   RefractionModel model, int maxExactEvents,
                   std::vector<Material> materials = {}) {
        if (materials.empty())
            materials = {glass(kIndex)};
        const Seen seen = look(bodies, {1.2, 0.9, 3.0}, 20);
        return compare(name, seen, march(seen.rays, meshes, model, materials), maxExactEvents);
    }

    /// By rays that pass the ball of this radius about the origin within 5 % of it, inside or
    /// beside, once they are in the glass.
    static Seen grazing(const Seen& seen, double radius) {
        Seen taken;
        for (std::size_t i = 0; i < seen.rays.size(); ++i) {
            const glm::dvec3 point(seen.rays[i].point), normal(seen.rays[i].normal);
            const glm::dvec3 bent = glm::refract(glm::normalize(glm::dvec3(seen.rays[i].direction)),
                                                 glm::normalize(normal), 1.0 / kIndex);
            if (std::abs(glm::length(glm::cross(point, bent)) - radius) > 0.05 * radius)
                continue;
            taken.rays.push_back(seen.rays[i]);
            taken.paths.push_back(seen.paths[i]);
        }
        return taken;
    }

    static Errors compare(const char* name, const Seen& seen, const std::vector<glm::vec4>& found,
                          int maxExactEvents) {
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

    static Material glass(double index) {
        Material material;
        material.refractiveIndex = static_cast<float>(index);
        return material;
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
                std::array{ball({0, 0, 0}, 1.0f)}, RefractionModel::TwoSurfaces, 1);
    EXPECT_GE(sphere.shareBelow(2.0), 0.99);
    // A slab, seen through its large faces.
    const auto slab = measure(
        "two surfaces, slab", one(example::makeGlassBox({-1, -1, -0.15}, {1, 1, 0.15}, kIndex)),
        std::array{ref::makeBox({-1, -1, -0.15f}, {1, 1, 0.15f})}, RefractionModel::TwoSurfaces, 1);
    EXPECT_GE(slab.shareBelow(2.0), 0.97);
}

TEST_F(RefractionPathGlTest, ManySurfacesOfASphere) {
    const auto errors =
        measure("many surfaces, sphere", one(example::makeGlassBall({0, 0, 0}, 1.0, kIndex)),
                std::array{ball({0, 0, 0}, 1.0f)}, RefractionModel::ManySurfaces, 4);
    EXPECT_GE(errors.shareBelow(3.0), 0.99);
}

TEST_F(RefractionPathGlTest, ManySurfacesOfAHollowSphere) {
    Bodies bodies;
    bodies.push_back(example::makeGlassBall({0, 0, 0}, 1.0, kIndex));
    bodies.push_back(example::makeGlassBall({0, 0, 0}, 0.7, kIndex, true));
    TriangleMesh hole = ref::flipped(ball({0, 0, 0}, 0.7f));
    for (glm::vec3& normal : hole.normals)
        normal = -normal;
    const auto errors =
        measure("many surfaces, hollow sphere", bodies, std::array{ball({0, 0, 0}, 1.0f), hole},
                RefractionModel::ManySurfaces, 4, {glass(kIndex), glass(kIndex)});
    EXPECT_GE(errors.shareBelow(3.0), 0.98);
    EXPECT_GT(errors.reflected, 500u);
}

TEST_F(RefractionPathGlTest, ManySurfacesOfACube) {
    const auto errors =
        measure("many surfaces, cube",
                one(example::makeGlassBox({-0.7, -0.7, -0.7}, {0.7, 0.7, 0.7}, kIndex)),
                std::array{ref::makeCube({0, 0, 0}, 1.4f)}, RefractionModel::ManySurfaces, 4);
    // Beside edges the planes of two faces mix.
    EXPECT_GE(errors.shareBelow(3.0), 0.96);
    EXPECT_GT(errors.reflected, 5000u);
}

/// Glass of another index inside a ball of glass: denser, and thinner, where rays that graze it are
/// totally reflected. Such rays tell whether a ray passes beside or through: in one voxel's width
/// the exact directions part by tens of degrees.
TEST_F(RefractionPathGlTest, ManySurfacesOfNestedMaterials) {
    constexpr double kRadius = 0.55;
    const std::array meshes{ball({0, 0, 0}, 1.0f), ball({0, 0, 0}, static_cast<float>(kRadius))};
    for (const double inner : {1.9, 1.15}) {
        Bodies bodies;
        bodies.push_back(example::makeGlassBall({0, 0, 0}, 1.0, kIndex));
        bodies.push_back(example::makeGlassBall({0, 0, 0}, kRadius, inner));
        const std::array materials{glass(kIndex), glass(inner)};
        const Seen seen = look(bodies, {1.2, 0.9, 3.0}, 20);
        const auto all =
            compare("many surfaces, nested spheres", seen,
                    march(seen.rays, meshes, RefractionModel::ManySurfaces, materials), 4);
        EXPECT_GE(all.shareBelow(3.0), 0.98);
        const Seen edge = grazing(seen, kRadius);
        const auto grazed =
            compare("  rays that graze the inner one", edge,
                    march(edge.rays, meshes, RefractionModel::ManySurfaces, materials), 4);
        EXPECT_GT(grazed.degrees.size(), 500u);
        EXPECT_GE(grazed.shareBelow(3.0), 0.97);
    }
}

/// What is seen through a vase: by images of the farthest surfaces, by voxels and two surfaces, by
/// voxels and all surfaces, each against the exact paths. Like with like: all follow the refracted
/// light alone, or the totally reflected; no share is split off at inner surfaces.
TEST_F(RefractionPathGlTest, VaseFallsInError) {
    const auto profile = example::vaseProfile();
    const Bodies bodies = one(example::makeRevolvedGlass(profile, kIndex));
    const std::array meshes{example::makeRevolvedMesh(profile, 256)};
    const std::array materials{glass(kIndex)};
    const glm::dvec3 eye(0.6, 0.7, 3.4);
    const Seen seen = look(bodies, eye, 20);
    const auto two = march(seen.rays, meshes, RefractionModel::TwoSurfaces, materials);
    const auto many = march(seen.rays, meshes, RefractionModel::ManySurfaces, materials);
    // Bright spots weigh no more than white.
    const auto shown = [](const glm::dvec3& direction) {
        return glm::min(example::sky(direction), glm::vec3(1.0f));
    };
    double images = 0.0, twoSurfaces = 0.0, manySurfaces = 0.0;
    for (std::size_t i = 0; i < seen.rays.size(); ++i) {
        const glm::dvec3 point(seen.rays[i].point), direction(seen.rays[i].direction);
        const example::GlassHit first{0.0, glm::normalize(glm::dvec3(seen.rays[i].normal)), kIndex};
        const auto byImages =
            example::traceByImages(bodies, eye, point, first, glm::normalize(direction));
        const glm::vec3 exact = shown(seen.paths[i].direction);
        const auto add = [&](double& sum, const glm::dvec3& found) {
            const glm::vec3 apart = shown(found) - exact;
            sum += glm::dot(apart, apart) / 3.0;
        };
        add(images, byImages.direction);
        add(twoSurfaces, glm::dvec3(two[2 * i]));
        add(manySurfaces, glm::dvec3(many[2 * i]));
    }
    const auto rmse = [&](double sum) {
        return std::sqrt(sum / static_cast<double>(seen.rays.size()));
    };
    std::printf("vase, %zu rays: RMSE by images %.4f, two surfaces %.4f, many surfaces %.4f\n",
                seen.rays.size(), rmse(images), rmse(twoSurfaces), rmse(manySurfaces));
    EXPECT_LT(rmse(twoSurfaces), rmse(images));
    EXPECT_LT(rmse(manySurfaces), 0.5 * rmse(twoSurfaces));
}

} // namespace
} // namespace lamina
