#include <reference/ray_scene.hpp>

#include <algorithm>
#include <stdexcept>

namespace lamina::reference {
namespace {

RTCRay makeRay(const glm::dvec3& origin, const glm::dvec3& direction, double far) {
    const glm::vec3 start(origin);
    const glm::vec3 along(direction);
    RTCRay ray{};
    ray.org_x = start.x;
    ray.org_y = start.y;
    ray.org_z = start.z;
    ray.dir_x = along.x;
    ray.dir_y = along.y;
    ray.dir_z = along.z;
    ray.tfar = static_cast<float>(far);
    ray.mask = ~0u;
    return ray;
}

} // namespace

RayScene::RayScene(const TriangleMesh& mesh, RTCFilterFunctionN filter)
    : mDevice(rtcNewDevice("threads=1"))
    , mScene(rtcNewScene(mDevice)) {
    rtcSetSceneFlags(mScene, RTC_SCENE_FLAG_ROBUST);
    RTCGeometry geometry = rtcNewGeometry(mDevice, RTC_GEOMETRY_TYPE_TRIANGLE);
    void* vertices = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                             sizeof(glm::vec3), mesh.positions.size());
    void* indices = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                            sizeof(glm::uvec3), mesh.triangles.size());
    if (!vertices || !indices)
        throw std::runtime_error("embree: no memory");
    std::ranges::copy(mesh.positions, static_cast<glm::vec3*>(vertices));
    std::ranges::copy(mesh.triangles, static_cast<glm::uvec3*>(indices));
    rtcSetGeometryIntersectFilterFunction(geometry, filter);
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(mScene, geometry);
    rtcReleaseGeometry(geometry);
    rtcCommitScene(mScene);
}

RayScene::~RayScene() {
    rtcReleaseScene(mScene);
    rtcReleaseDevice(mDevice);
}

bool RayScene::isFree(const glm::dvec3& origin, const glm::dvec3& direction, double far) const {
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    RTCRay ray = makeRay(origin, direction, far);
    rtcOccluded1(mScene, &context, &ray);
    return ray.tfar >= 0.0f;
}

RTCRayHit RayScene::cast(RTCIntersectContext& context, const glm::dvec3& origin,
                         const glm::dvec3& direction, double far) const {
    rtcInitIntersectContext(&context);
    RTCRayHit query{};
    query.ray = makeRay(origin, direction, far);
    query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    rtcIntersect1(mScene, &context, &query);
    return query;
}

} // namespace lamina::reference
