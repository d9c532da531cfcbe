#include <reference/epipolar_rays.hpp>

#include <reference/ray_scene.hpp>
#include <reference/shapes.hpp>

#include <glm/geometric.hpp>

#include <cmath>
#include <limits>

namespace lamina::reference {

TriangleMesh makeFenceScene() {
    TriangleMesh scene = makePlane({0.0f, 0.0f, 0.0f}, {0.0f, 1.0f, 0.0f}, 8.0f);
    scene = merged(scene, makeIcosphere({-1.2f, 0.8f, 0.6f}, 0.8f, 3));
    constexpr int kBars = 13;
    for (int bar = 0; bar < kBars; ++bar) {
        const float x = -1.8f + 0.3f * static_cast<float>(bar);
        scene = merged(scene, makeBox({x, 0.0f, -1.03f}, {x + 0.05f, 1.5f, -0.98f}));
    }
    for (const float y : {0.4f, 1.2f})
        scene = merged(scene, makeBox({-2.0f, y, -1.02f}, {2.0f, y + 0.06f, -0.99f}));
    return scene;
}

struct ShadowRays::Impl {
    RayScene scene;
};

ShadowRays::ShadowRays(const TriangleMesh& mesh)
    : mImpl(new Impl{RayScene(mesh)}) {}

ShadowRays::ShadowRays(ShadowRays&&) noexcept = default;
ShadowRays::~ShadowRays() = default;

bool ShadowRays::lit(const EpipolarLight& light, const glm::dvec3& point) const {
    if (light.kind == LightKind::Directional)
        return mImpl->scene.isFree(point, -glm::normalize(light.direction),
                                   std::numeric_limits<double>::infinity());
    const glm::dvec3 toLight = light.position - point;
    if (light.kind == LightKind::Spot &&
        glm::dot(-glm::normalize(toLight), glm::normalize(light.direction)) <
            std::cos(light.coneAngle))
        return false;
    return mImpl->scene.isFree(point, toLight, 1.0);
}

double ShadowRays::firstHit(const glm::dvec3& origin, const glm::dvec3& direction) const {
    constexpr double kFar = std::numeric_limits<double>::infinity();
    RTCIntersectContext context;
    const RTCRayHit query = mImpl->scene.cast(context, origin, direction, kFar);
    return query.hit.geomID == RTC_INVALID_GEOMETRY_ID ? kFar : static_cast<double>(query.ray.tfar);
}

} // namespace lamina::reference
