#pragma once

#include <reference/fog.hpp>

#include <lamina/voxelize/epipolar_transform.hpp>

/// Airlight through perfect shadow volumes: what steps in alpha, theta and phi cost, one by one.
namespace lamina::reference {

/// Which coordinates stand for whole voxels: their visibility is that of the voxel's centre.
struct VoxelSteps {
    bool alpha = true;
    bool theta = true;
    bool phi = true;
    bool interpolate = true; ///< Linear in theta, between the centres of voxels.
};

/// The integral of marchFog() with the visibility that a volume without errors of its own has;
/// where the ray through the voxels' centres passes the first surface, it stays lit if it was so
/// before. light: a point light, that of `volume`; `point` is seen from the volume's eye.
[[nodiscard]] double marchVoxels(const ShadowRays& rays, const VirtualLight& light,
                                 const EpipolarTransform& volume, const Medium& medium,
                                 const glm::dvec3& point, std::uint32_t steps,
                                 const VoxelSteps& voxels);

/// The lit share of a point of the volume's space, likewise; interpolated in theta and phi.
[[nodiscard]] double litVoxels(const ShadowRays& rays, const EpipolarTransform& volume,
                               const glm::dvec3& coordinates, const VoxelSteps& voxels);

} // namespace lamina::reference
