#pragma once

#include "gl/support/fog_scene.hpp"
#include "gl/support/gl_test.hpp"

#include <reference/epipolar_agreement.hpp>
#include <reference/fog.hpp>

#include <glm/geometric.hpp>

#include <cmath>
#include <span>
#include <vector>

namespace lamina::test {

/// Lights a scene by an AreaLight and by ray marching.
class FogTest : public GlTest {
protected:
    /// The effect after a frame of `mesh`.
    AreaLight lit(const AreaLightDesc& desc, const FogScene& scene, const TriangleMesh& mesh,
                  const LightSource& light, const Medium& medium) {
        auto effect = AreaLight::create(device(), desc).value();
        draw(effect, scene, mesh, light, medium);
        return effect;
    }
    void draw(AreaLight& effect, const FogScene& scene, const TriangleMesh& mesh,
              const LightSource& light, const Medium& medium) {
        const auto buffers = MeshBuffers::upload(device(), mesh).value();
        const GeometrySource source = buffers.view();
        const auto stats = effect.prepare(scene.view(), light, medium, {&source, 1});
        ASSERT_TRUE(stats) << stats.error().text;
        const auto picture = effect.apply(scene.view(), scene.surfaces());
        ASSERT_TRUE(picture) << picture.error().text;
    }
    /// Red of the gathered airlight (0) or surface light (1).
    static std::vector<double> sums(const FogScene& scene, const AreaLight& effect, int which = 0) {
        std::vector<double> values;
        for (const glm::vec4& texel : scene.read(effect.sums()[static_cast<std::size_t>(which)]))
            values.push_back(static_cast<double>(texel.x));
        return values;
    }
    /// The same airlight by ray marching, shadowed and not.
    struct Marched {
        std::vector<double> airlight, unshadowed;

        /// Share of all light that shadows take away.
        [[nodiscard]] double shadow() const {
            double lost = 0.0;
            double whole = 0.0;
            for (std::size_t i = 0; i < airlight.size(); ++i) {
                lost += unshadowed[i] - airlight[i];
                whole += unshadowed[i];
            }
            return lost / whole;
        }
    };
    static Marched march(const FogScene& scene, std::span<const VirtualLight> lights,
                         const Medium& medium, std::uint32_t steps) {
        Marched marched;
        const double scattering = static_cast<double>(medium.albedo.x * medium.extinction);
        for (std::size_t i = 0; i < scene.pixelCount(); ++i) {
            const auto ray = reference::marchFog(&scene.rays(), lights, medium, scene.eye(),
                                                 scene.point(i), steps);
            marched.airlight.push_back(scattering * ray.airlight);
            marched.unshadowed.push_back(scattering * ray.unshadowed);
        }
        return marched;
    }
};

} // namespace lamina::test
