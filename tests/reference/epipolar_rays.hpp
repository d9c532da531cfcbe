#pragma once

#include <lamina/core/triangle_mesh.hpp>
#include <lamina/voxelize/epipolar_transform.hpp>

#include <memory>

/// Ray-cast visibility (Embree), for tests of voxelized shadow volumes.
namespace lamina::reference {

/// A floor in y = 0, a sphere standing on it and a fence of thin bars and rails; within
/// [-4,4] x [0,2] x [-4,4].
[[nodiscard]] TriangleMesh makeFenceScene();

/// Casts shadow rays through a mesh. Keeps a copy of what it needs.
class ShadowRays {
public:
    explicit ShadowRays(const TriangleMesh& mesh);
    ShadowRays(ShadowRays&&) noexcept;
    ~ShadowRays();

    /// Does light reach the point? Points outside a spot's cone are not lit.
    [[nodiscard]] bool lit(const EpipolarLight& light, const glm::dvec3& point) const;
    /// Distance along a ray (direction of any length, result in its units) to the first surface;
    /// infinity for none.
    [[nodiscard]] double firstHit(const glm::dvec3& origin, const glm::dvec3& direction) const;

private:
    struct Impl;
    std::unique_ptr<Impl> mImpl;
};

} // namespace lamina::reference
