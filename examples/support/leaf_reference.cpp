#include "leaf_reference.hpp"

#include <embree3/rtcore.h>

#include <algorithm>
#include <vector>

namespace example {
namespace {

struct Hit {
    unsigned geometry;
    unsigned triangle;
    auto operator<=>(const Hit&) const = default;
};

struct Collector {
    RTCIntersectContext context; // First: Embree hands back its address.
    std::vector<Hit> hits;
};

void collect(const RTCFilterFunctionNArguments* arguments) {
    if (arguments->valid[0] != -1)
        return;
    const auto* hit = reinterpret_cast<const RTCHit*>(arguments->hit);
    reinterpret_cast<Collector*>(arguments->context)->hits.push_back({hit->geomID, hit->primID});
    arguments->valid[0] = 0;
}

} // namespace

struct LeafReference::Impl {
    RTCDevice device = rtcNewDevice(nullptr);
    RTCScene scene = rtcNewScene(device);
    unsigned classes = 0;

    ~Impl() {
        rtcReleaseScene(scene);
        rtcReleaseDevice(device);
    }
    void add(const lamina::TriangleMesh& mesh) const {
        RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
        std::ranges::copy(mesh.positions, static_cast<glm::vec3*>(rtcSetNewGeometryBuffer(
                                              geometry, RTC_BUFFER_TYPE_VERTEX, 0,
                                              RTC_FORMAT_FLOAT3, 12, mesh.positions.size())));
        std::ranges::copy(mesh.triangles, static_cast<glm::uvec3*>(rtcSetNewGeometryBuffer(
                                              geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                              12, mesh.triangles.size())));
        rtcSetGeometryIntersectFilterFunction(geometry, collect);
        rtcCommitGeometry(geometry);
        rtcAttachGeometry(scene, geometry);
        rtcReleaseGeometry(geometry);
    }
};

LeafReference::LeafReference(std::span<const lamina::TriangleMesh> leaves,
                             const lamina::TriangleMesh& wood)
    : mImpl(std::make_unique<Impl>()) {
    rtcSetSceneFlags(mImpl->scene, RTC_SCENE_FLAG_ROBUST);
    for (const lamina::TriangleMesh& mesh : leaves)
        mImpl->add(mesh);
    mImpl->classes = static_cast<unsigned>(leaves.size());
    mImpl->add(wood);
    rtcCommitScene(mImpl->scene);
}

LeafReference::~LeafReference() = default;

LeafReference::Crossings LeafReference::towards(const glm::vec3& point,
                                                const glm::vec3& toSun) const {
    Collector collector;
    rtcInitIntersectContext(&collector.context);
    RTCRayHit query{};
    query.ray.org_x = point.x;
    query.ray.org_y = point.y;
    query.ray.org_z = point.z;
    query.ray.dir_x = toSun.x;
    query.ray.dir_y = toSun.y;
    query.ray.dir_z = toSun.z;
    query.ray.tnear = 1e-4f;
    query.ray.tfar = 1e3f;
    query.ray.mask = ~0u;
    query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    rtcIntersect1(mImpl->scene, &collector.context, &query);
    std::ranges::sort(collector.hits);
    collector.hits.erase(std::unique(collector.hits.begin(), collector.hits.end()),
                         collector.hits.end());
    Crossings crossings;
    for (const Hit& hit : collector.hits) {
        if (hit.geometry < mImpl->classes)
            ++crossings.leaves[hit.geometry];
        else
            crossings.isBehindWood = true;
    }
    return crossings;
}

} // namespace example
