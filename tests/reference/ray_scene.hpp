#pragma once

#include <lamina/core/triangle_mesh.hpp>

#include <embree3/rtcore.h>

namespace lamina::reference {

/// A mesh that Embree casts rays through; a copy.
class RayScene {
public:
    /// filter: called for every hit, decides whether the ray goes on; null: the first hit ends it.
    explicit RayScene(const TriangleMesh& mesh, RTCFilterFunctionN filter = nullptr);
    ~RayScene();
    RayScene(const RayScene&) = delete;
    RayScene& operator=(const RayScene&) = delete;

    /// Is nothing hit on origin + t * direction, 0 < t < far? Without a filter.
    [[nodiscard]] bool isFree(const glm::dvec3& origin, const glm::dvec3& direction,
                              double far) const;
    /// Casts origin + t * direction, 0 < t < far. `context` is what the filter sees.
    [[nodiscard]] RTCRayHit cast(RTCIntersectContext& context, const glm::dvec3& origin,
                                 const glm::dvec3& direction, double far) const;

private:
    RTCDevice mDevice;
    RTCScene mScene;
};

} // namespace lamina::reference
