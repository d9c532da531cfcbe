// Airlight and surface light of shadowed lights in fog agree with ray casting; the ways to gather
// and to store volumes agree with each other.

#include "gl/support/fog_scene.hpp"
#include "gl/support/gl_test.hpp"

#include <lamina/gl/shaders.hpp>

#include <reference/epipolar_agreement.hpp>
#include <reference/fog_errors.hpp>
#include <reference/fog_voxels.hpp>

#include <glm/geometric.hpp>

#include <cmath>
#include <cstdio>

namespace lamina {
namespace {

using reference::FogRay;
using reference::relativeRmse;
using test::FogScene;

/// A television behind the fence, off the screen's upper edge, tilted down a little.
RectangleLight television() {
    RectangleLight light;
    light.corner = {-1.6, 2.6, -3.0};
    light.edgeU = {3.2, 0.0, 0.0};
    light.edgeV = {0.0, 1.2, 0.5};
    light.emission.radiance = glm::vec3(2.0f);
    return light;
}

Medium fog() {
    return {0.12f, glm::vec3(0.9f), 0.2f};
}

/// Does an eye ray pass a virtual light closer than its part of the source is large? There points
/// are no likeness of the source, and the gather bounds them.
bool passesLight(const FogScene& scene, std::size_t pixel, std::span<const VirtualLight> lights) {
    const glm::dvec3 along = glm::normalize(scene.point(pixel) - scene.eye());
    for (const VirtualLight& light : lights) {
        const glm::dvec3 offset = light.light.position - scene.eye();
        const double reached = glm::dot(offset, along);
        if (light.radius > 0.0 &&
            reached < glm::distance(scene.point(pixel), scene.eye()) + light.radius &&
            glm::length(offset - reached * along) < 1.5 * light.radius)
            return true;
    }
    return false;
}

/// Gathered airlight and its errors against ray casting.
struct Errors {
    double truth = 0.0;      ///< Relative RMSE against the integral.
    double factored = 0.0;   ///< Against mean visibility times unshadowed airlight.
    double strength = 0.0;   ///< Of the shadow, relative, mean where it is stronger than 2 %.
    std::size_t shadows = 0; ///< Pixels where it is.
};

class AreaLightGlTest : public test::GlTest {
protected:
    AreaLight lit(const AreaLightDesc& desc, const FogScene& scene, const LightSource& light,
                  const Medium& medium) {
        auto effect = AreaLight::create(device(), desc).value();
        const auto buffers = MeshBuffers::upload(device(), mMesh).value();
        const GeometrySource source = buffers.view();
        const auto stats = effect.prepare(scene.view(), light, medium, {&source, 1});
        EXPECT_TRUE(stats) << stats.error().text;
        const auto picture = effect.apply(scene.view(), scene.surfaces());
        EXPECT_TRUE(picture) << picture.error().text;
        return effect;
    }
    std::vector<FogRay> cast(const FogScene& scene, std::span<const VirtualLight> lights,
                             const Medium& medium, std::uint32_t steps) const {
        std::vector<FogRay> rays;
        for (std::size_t i = 0; i < scene.pixelCount(); ++i)
            rays.push_back(reference::marchFog(&scene.rays(), lights, medium, scene.eye(),
                                               scene.point(i), steps));
        return rays;
    }
    static Errors compare(const FogScene& scene, const AreaLight& effect, const Medium& medium,
                          std::span<const FogRay> rays) {
        const auto sums = scene.read(effect.sums()[0]);
        const double scattering = static_cast<double>(medium.albedo.x * medium.extinction);
        std::vector<double> found, truth, factored;
        Errors errors;
        double strength = 0.0;
        std::size_t shadows = 0;
        for (std::size_t i = 0; i < rays.size(); ++i) {
            if (scene.isSky(i) || passesLight(scene, i, effect.virtualLights()))
                continue;
            found.push_back(static_cast<double>(sums[i].x) / scattering);
            truth.push_back(rays[i].airlight);
            factored.push_back(rays[i].factored());
            const double shadow = rays[i].unshadowed - rays[i].airlight;
            if (shadow > 0.02 * rays[i].unshadowed) {
                strength += std::abs((rays[i].unshadowed - found.back()) / shadow - 1.0);
                ++shadows;
            }
        }
        errors.truth = relativeRmse(found, truth);
        errors.factored = relativeRmse(found, factored);
        errors.strength = strength / static_cast<double>(std::max<std::size_t>(shadows, 1));
        errors.shadows = shadows;
        return errors;
    }

    const TriangleMesh mMesh = reference::makeFenceScene();
};

TEST_F(AreaLightGlTest, OneVolumeAgreesWithRayCasting) {
    const FogScene scene(gl(), mMesh, reference::frontEye(), {48, 38});
    struct Case {
        const char* name;
        LightSource light;
        double weighted; ///< Most relative RMSE against the truth.
        double factored; ///< And of the factored form against mean visibility.
        bool isShadowed;
    };
    // A cone's rim moves by half a sample along each ray, and all the light is inside it.
    const Case cases[] = {
        {"point on screen", PointLight{{0.6, 2.2, -2.6}}, 0.01, 0.01, true},
        {"point off screen", PointLight{{-3.5, 3.0, 1.0}}, 0.004, 0.005, true},
        {"point behind the camera", PointLight{{1.5, 2.6, 7.0}}, 0.005, 0.006, false},
        {"spot", SpotLight{{-2.5, 3.0, -2.0}, {2.5, -2.2, 1.5}, 0.5}, 0.02, 0.02, true},
        {"sun", DirectionalLight{{0.5, -0.5, 0.6}}, 0.006, 0.008, true}};
    AreaLightDesc desc;
    desc.voxels = {512, 512, 512};
    desc.mapTexels = 1024;
    for (const Case& test : cases) {
        SCOPED_TRACE(test.name);
        const auto lights = sampleVirtualLights(test.light, 1).value();
        const auto rays = cast(scene, lights, fog(), 160);
        for (const AirlightForm form : {AirlightForm::Weighted, AirlightForm::Factored}) {
            desc.airlight = form;
            const AreaLight effect = lit(desc, scene, test.light, fog());
            const Errors errors = compare(scene, effect, fog(), rays);
            std::printf("%-24s %-8s truth %.2f %%, factored %.2f %%\n", test.name,
                        form == AirlightForm::Weighted ? "weighted" : "factored",
                        100.0 * errors.truth, 100.0 * errors.factored);
            if (form == AirlightForm::Weighted)
                EXPECT_LE(errors.truth, test.weighted);
            else
                EXPECT_LE(errors.factored, test.factored);
            EXPECT_TRUE(!test.isShadowed || errors.shadows > scene.pixelCount() / 20);
        }
    }
}

TEST_F(AreaLightGlTest, ManyVolumesAgreeWithRayCasting) {
    const FogScene scene(gl(), mMesh, reference::frontEye(), {20, 16});
    AreaLightDesc desc;
    desc.virtualLights = 64;
    const auto lights = sampleVirtualLights(television(), desc.virtualLights).value();
    const auto rays = cast(scene, lights, fog(), 100);
    for (const ShadowMaps maps : {ShadowMaps::Rendered, ShadowMaps::Imperfect})
        for (const AirlightForm form : {AirlightForm::Weighted, AirlightForm::Factored}) {
            desc.maps = maps;
            desc.airlight = form;
            const AreaLight effect = lit(desc, scene, television(), fog());
            const Errors errors = compare(scene, effect, fog(), rays);
            const bool isRendered = maps == ShadowMaps::Rendered;
            const bool isWeighted = form == AirlightForm::Weighted;
            std::printf("%-9s %-8s truth %.2f %%, factored %.2f %%, strength %.1f %%\n",
                        isRendered ? "rendered" : "imperfect", isWeighted ? "weighted" : "factored",
                        100.0 * errors.truth, 100.0 * errors.factored, 100.0 * errors.strength);
            // What remains of the strength's error are the steps in theta and phi, and the points
            // of imperfect maps. Mean visibility alone errs by 20 to 30 %.
            if (isWeighted) {
                EXPECT_LE(errors.truth, isRendered ? 0.01 : 0.02);
                EXPECT_LE(errors.strength, isRendered ? 0.04 : 0.08);
            } else {
                EXPECT_LE(errors.factored, isRendered ? 0.02 : 0.04);
                EXPECT_GT(errors.strength, 0.15);
            }
            EXPECT_GT(errors.shadows, scene.pixelCount() / 5);
        }
}

TEST_F(AreaLightGlTest, SurfaceLightAgreesWithRayCasting) {
    const FogScene scene(gl(), mMesh, reference::frontEye(), {40, 32});
    AreaLightDesc desc;
    desc.virtualLights = 24;
    desc.maps = ShadowMaps::Rendered;
    double last = 1.0;
    for (const std::uint32_t voxels : {128u, 256u}) {
        desc.voxels = glm::uvec3(voxels);
        desc.mapTexels = 4 * voxels;
        const AreaLight effect = lit(desc, scene, television(), fog());
        const auto sums = scene.read(effect.sums()[1]);
        const auto volumes = effect.volumes()[0].transforms();
        const auto lights = effect.virtualLights();
        const glm::dvec3 bias(desc.alphaBias, 0.0, desc.phiBias);
        std::vector<double> found, expected, ideal, biased;
        for (std::size_t i = 0; i < scene.pixelCount(); ++i) {
            if (scene.isSky(i) || scene.normal(i) == glm::dvec3(0.0))
                continue;
            double truth = 0.0;
            double stepped = 0.0;
            double moved = 0.0;
            for (std::size_t light = 0; light < lights.size(); ++light) {
                const double strength =
                    reference::irradiance(lights[light], fog(), scene.point(i), scene.normal(i));
                if (strength == 0.0)
                    continue;
                const auto& volume = volumes[light];
                const glm::dvec3 place = volume.worldToVoxel(scene.point(i)) + bias;
                truth += reference::castIrradiance(scene.rays(), lights[light], fog(),
                                                   scene.point(i), scene.normal(i), 1e-3);
                // Visibility of the voxels' centres, and of the very point that is asked for.
                stepped += strength *
                           reference::litVoxels(scene.rays(), volume, place, {true, true, true});
                moved += strength *
                         reference::litVoxels(scene.rays(), volume, place, {false, false, false});
            }
            expected.push_back(truth);
            ideal.push_back(stepped);
            biased.push_back(moved);
            found.push_back(static_cast<double>(sums[i].x) * 3.14159265358979);
        }
        const double error = relativeRmse(found, expected);
        const double ofSteps = relativeRmse(ideal, expected);
        std::printf("surface light, %u voxels: %.2f %%; perfect volumes %.2f %%, of that the bias "
                    "%.2f %%; ours against perfect volumes %.2f %%\n",
                    voxels, 100.0 * error, 100.0 * ofSteps, 100.0 * relativeRmse(biased, expected),
                    100.0 * relativeRmse(found, ideal));
        // Nearly all of the error is what the biases move shadows by.
        EXPECT_LE(error, 1.15 * ofSteps);
        EXPECT_LE(relativeRmse(found, ideal), 0.03);
        EXPECT_LE(error, 0.9 * last);
        last = std::min(error, 0.2);
    }
}

TEST_F(AreaLightGlTest, CoarseGathersAgreeWithTheFullOne) {
    const FogScene scene(gl(), mMesh, reference::frontEye(), {150, 120});
    AreaLightDesc desc;
    desc.virtualLights = 81;
    desc.maps = ShadowMaps::Imperfect;
    SurfaceTextures medium = scene.surfaces();
    medium.normal = 0;
    // Off the screen: beside a point light the medium is not smooth.
    RectangleLight light = television();
    light.corner.y = 4.6;
    const auto pixels = [&](GatherMode mode) {
        desc.gather = mode;
        auto effect = lit(desc, scene, light, fog());
        return scene.read(effect.apply(scene.view(), medium).value());
    };
    const auto full = pixels(GatherMode::Full);
    // Pixels beside another surface, where a filter may mix what is before and behind.
    const auto isEdge = [&](std::size_t i) {
        const double here = glm::distance(scene.point(i), scene.eye());
        for (const std::size_t other : {i + 1, i + scene.view().size.x})
            if (other < scene.pixelCount() &&
                std::abs(glm::distance(scene.point(other), scene.eye()) - here) > 0.2 * here)
                return true;
        return false;
    };
    for (const GatherMode mode : {GatherMode::Interleaved, GatherMode::Quarter}) {
        const auto coarse = pixels(mode);
        std::vector<double> found[2], expected[2];
        for (std::size_t i = 0; i < full.size(); ++i)
            for (const int set : {0, isEdge(i) ? 1 : 0}) {
                found[set].push_back(static_cast<double>(coarse[i].x));
                expected[set].push_back(static_cast<double>(full[i].x));
            }
        const double error = relativeRmse(found[0], expected[0]);
        const double atEdges = relativeRmse(found[1], expected[1]);
        std::printf("%s: %.2f %%, at edges %.2f %%\n",
                    mode == GatherMode::Quarter ? "quarter" : "interleaved", 100.0 * error,
                    100.0 * atEdges);
        EXPECT_LE(error, 0.02);
        EXPECT_LE(atEdges, 0.06);
        EXPECT_GT(error, 0.0);
        EXPECT_GT(found[1].size(), 500u);
    }
}

TEST_F(AreaLightGlTest, SeparateVolumesGiveTheTiledOnesPicture) {
    const FogScene scene(gl(), mMesh, reference::frontEye(), {32, 24});
    AreaLightDesc desc;
    desc.virtualLights = 12;
    desc.voxels = {64, 48, 160};
    desc.maps = ShadowMaps::Rendered;
    const AreaLight tiled = lit(desc, scene, television(), fog());
    desc.layout = ShadowVolumeLayout::Separate;
    const AreaLight separate = lit(desc, scene, television(), fog());
    EXPECT_EQ(tiled.volumes().size(), 1u);
    ASSERT_EQ(separate.volumes().size(), 12u);
    for (int target = 0; target < 2; ++target) {
        const auto a = scene.read(tiled.sums()[static_cast<std::size_t>(target)]);
        const auto b = scene.read(separate.sums()[static_cast<std::size_t>(target)]);
        for (std::size_t i = 0; i < a.size(); ++i)
            // The order of the additions differs.
            ASSERT_NEAR(a[i].x, b[i].x, 1e-5f * a[i].x) << i;
    }
}

TEST_F(AreaLightGlTest, HostShadersFindTheSameSums) {
    const FogScene scene(gl(), mMesh, reference::frontEye(), {32, 24});
    AreaLightDesc desc;
    desc.virtualLights = 20;
    const AreaLight effect = lit(desc, scene, television(), fog());
    const std::string source = "#version 450 core\n#define LAMINA_EPIPOLAR_BLOCK_BINDING 3\n"
                               "#define LAMINA_EPIPOLAR_TEXTURE_UNIT 5\n"
                               "#define LAMINA_AREA_LIGHT_BLOCK_BINDING 4\n" +
                               shaderSource("lamina/area_light.glsl").value() + R"(
layout(local_size_x = 64) in;
layout(std430, binding = 0) readonly buffer Points { vec4 points[]; };
layout(std430, binding = 1) buffer Results { vec4 results[]; };
void main() {
    uint i = gl_GlobalInvocationID.x;
    if (i >= uint(results.length()))
        return;
    vec3 sum = vec3(0.0);
    for (int light = 0; light < laminaVirtualLightCount(); ++light)
        sum += laminaAirlight(light, light, laminaLightRay(light, light, points[2u * i].xyz, points[2u * i + 1u].xyz));
    results[i] = vec4(sum, laminaTransmittance(2.0));
})";
    const GLuint program = buildProgram({{GL_COMPUTE_SHADER, source}});
    effect.bind(3, 5, 4);
    std::vector<glm::vec4> points;
    for (std::size_t i = 0; i < scene.pixelCount(); ++i) {
        points.emplace_back(glm::vec3(scene.point(i)), 0.0f);
        points.emplace_back(glm::vec3(scene.normal(i)), 0.0f);
    }
    std::vector<glm::vec4> results(scene.pixelCount());
    runCompute(program, std::as_bytes(std::span(points)),
               std::as_writable_bytes(std::span(results)),
               static_cast<std::uint32_t>(results.size()));
    const auto sums = scene.read(effect.sums()[0]);
    std::size_t compared = 0;
    std::vector<double> found, expected;
    for (std::size_t i = 0; i < results.size(); ++i) {
        EXPECT_NEAR(results[i].w, std::exp(-2.0f * fog().extinction), 1e-6f);
        if (scene.isSky(i))
            continue;
        ++compared;
        found.push_back(static_cast<double>(results[i].x));
        expected.push_back(static_cast<double>(sums[i].x));
    }
    // World points of the depth buffer are rounded, and may fall into the next voxel.
    EXPECT_LT(relativeRmse(found, expected), 1e-3);
    EXPECT_GT(compared, results.size() / 2);
    gl().DeleteProgram(program);
}

TEST_F(AreaLightGlTest, OneImperfectVolumeIsTheVolumeUpToItsMap) {
    const FogScene scene(gl(), mMesh, reference::frontEye(), {32, 24});
    DiskLight small;
    small.center = {0.4, 2.9, -2.6};
    small.normal = {-0.1, -0.8, 0.6};
    small.radius = 0.02;
    small.radiance = glm::vec3(100.0f);
    AreaLightDesc desc;
    desc.virtualLights = 1;
    desc.voxels = {256, 256, 256};
    desc.mapTexels = 512;
    desc.imperfect = {1u << 18u, 1u << 17u, 2};
    const auto sums = [&](ShadowMaps maps) {
        desc.maps = maps;
        std::vector<double> values;
        for (const glm::vec4& texel : scene.read(lit(desc, scene, small, fog()).sums()[0]))
            values.push_back(static_cast<double>(texel.x));
        return values;
    };
    const auto rendered = sums(ShadowMaps::Rendered);
    const auto imperfect = sums(ShadowMaps::Imperfect);
    const double error = relativeRmse(imperfect, rendered);
    std::printf("imperfect against rendered: %.2f %%\n", 100.0 * error);
    EXPECT_LE(error, 0.02);
}

} // namespace
} // namespace lamina
