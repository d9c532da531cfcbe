#pragma once

#include "voxelize/volume_constants.hpp"

#include <lamina/core/result.hpp>
#include <lamina/grid/grid_transform.hpp>
#include <lamina/voxelize/material.hpp>
#include <lamina/voxelize/volume_voxelizer.hpp>

#include <glm/mat3x3.hpp>

#include <cstdint>
#include <span>

namespace lamina {

/// Are there at most as many materials as a table holds, each with values in range?
/// Errors: InvalidArgument.
[[nodiscard]] Result<void> checkMaterials(std::span<const Material> materials);

[[nodiscard]] shared::LaminaMaterialConstants materialConstants(const Material& material);

/// What all draws of a call share.
[[nodiscard]] shared::LaminaVolumeDrawConstants volumeDrawConstants(const GridTransform& transform,
                                                                    const VolumeLayout& layout,
                                                                    const VolumeVoxelizerDesc& desc,
                                                                    std::size_t materialCount,
                                                                    std::uint32_t subpixelBits);

/// How a linear map changes cross products: cross(M a, M b) = cofactors(M) cross(a, b).
[[nodiscard]] glm::dmat3 cofactors(const glm::dmat3& matrix);

/// The map of vertex normals from a source's local space to the world, up to their length.
[[nodiscard]] glm::dmat3 normalMatrix(const glm::dmat4& localToWorld);

/// Sets what depends on a source's place.
void setTransform(shared::LaminaVolumeDrawConstants& constants, const GridTransform& transform,
                  const glm::dmat4& localToWorld);

/// Passes that draw every layer of a triangle through the whole grid.
[[nodiscard]] std::uint32_t volumePassCount(const GridTransform& transform);

/// The first layer that a pass draws, counted from a triangle's own first layer.
[[nodiscard]] std::uint32_t firstLayerOf(std::uint32_t pass);

} // namespace lamina
