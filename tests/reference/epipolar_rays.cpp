#include <reference/epipolar_rays.hpp>

#include <reference/shapes.hpp>

#include <embree3/rtcore.h>
#include <glm/geometric.hpp>

#include <cmath>
#include <limits>
#include <stdexcept>

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
    RTCDevice device = nullptr;
    RTCScene scene = nullptr;
    ~Impl() {
        rtcReleaseScene(scene);
        rtcReleaseDevice(device);
    }
    /// Hit parameter in (0, far), or infinity.
    [[nodiscard]] double cast(const glm::dvec3& origin, const glm::dvec3& direction,
                              double far) const {
        RTCIntersectContext context;
        rtcInitIntersectContext(&context);
        RTCRayHit query{};
        const glm::vec3 start(origin);
        const glm::vec3 along(direction);
        query.ray.org_x = start.x;
        query.ray.org_y = start.y;
        query.ray.org_z = start.z;
        query.ray.dir_x = along.x;
        query.ray.dir_y = along.y;
        query.ray.dir_z = along.z;
        query.ray.tfar = static_cast<float>(far);
        query.ray.mask = ~0u;
        query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
        rtcIntersect1(scene, &context, &query);
        return query.hit.geomID == RTC_INVALID_GEOMETRY_ID ? std::numeric_limits<double>::infinity()
                                                           : static_cast<double>(query.ray.tfar);
    }
};

ShadowRays::ShadowRays(const TriangleMesh& mesh)
    : mImpl(std::make_unique<Impl>()) {
    mImpl->device = rtcNewDevice("threads=1");
    mImpl->scene = rtcNewScene(mImpl->device);
    rtcSetSceneFlags(mImpl->scene, RTC_SCENE_FLAG_ROBUST);
    RTCGeometry geometry = rtcNewGeometry(mImpl->device, RTC_GEOMETRY_TYPE_TRIANGLE);
    auto* vertices = static_cast<float*>(
        rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                3 * sizeof(float), mesh.positions.size()));
    auto* indices = static_cast<unsigned*>(
        rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                3 * sizeof(unsigned), mesh.triangles.size()));
    if (!vertices || !indices)
        throw std::runtime_error("embree: no memory");
    for (std::size_t i = 0; i < mesh.positions.size(); ++i)
        for (int axis = 0; axis < 3; ++axis)
            vertices[3 * i + static_cast<std::size_t>(axis)] = mesh.positions[i][axis];
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i)
        for (int corner = 0; corner < 3; ++corner)
            indices[3 * i + static_cast<std::size_t>(corner)] = mesh.triangles[i][corner];
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(mImpl->scene, geometry);
    rtcReleaseGeometry(geometry);
    rtcCommitScene(mImpl->scene);
}

ShadowRays::ShadowRays(ShadowRays&&) noexcept = default;
ShadowRays::~ShadowRays() = default;

bool ShadowRays::lit(const EpipolarLight& light, const glm::dvec3& point) const {
    if (light.kind == LightKind::Directional)
        return std::isinf(mImpl->cast(point, -glm::normalize(light.direction),
                                      std::numeric_limits<double>::infinity()));
    const glm::dvec3 toLight = light.position - point;
    if (light.kind == LightKind::Spot &&
        glm::dot(-glm::normalize(toLight), glm::normalize(light.direction)) <
            std::cos(light.coneAngle))
        return false;
    return std::isinf(mImpl->cast(point, toLight, 1.0));
}

double ShadowRays::firstHit(const glm::dvec3& origin, const glm::dvec3& direction) const {
    return mImpl->cast(origin, direction, std::numeric_limits<double>::infinity());
}

} // namespace lamina::reference
