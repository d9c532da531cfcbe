#pragma once

#include "grid_io/preview_camera.hpp"
#include "grid_io/voxel_tree.hpp"

#include <glm/vec4.hpp>

#include <cstdint>

namespace lamina::detail {

/// sRGB in [0,1] to linear and back, by the standard's curve.
glm::vec3 linearFromSrgb(const glm::vec3& color);
glm::vec3 srgbFromLinear(const glm::vec3& color);

/// Voxels under sun and sky on a ground that shows nothing but their shadow.
class PreviewScene {
public:
    /// `voxels` is borrowed and must outlive this object.
    PreviewScene(const BoxVoxels& voxels, const PreviewDesc& desc);

    /// The sum of the samples [first, end) of a pixel, in linear light, premultiplied by alpha,
    /// without background: 0 where neither voxel nor shadow is. Pure: any thread, any order.
    [[nodiscard]] glm::vec4 samples(std::uint32_t x, std::uint32_t y, std::uint32_t first,
                                    std::uint32_t end) const;
    /// What stands behind a row of pixels, in linear light; transparent if so wished.
    [[nodiscard]] glm::vec4 background(std::uint32_t y) const;

private:
    struct Surface;
    struct Randoms;

    [[nodiscard]] VoxelRay voxelRay(const glm::dvec3& origin, const glm::dvec3& direction) const;
    [[nodiscard]] glm::vec4 sample(const glm::dvec2& pixel, const Randoms& randoms) const;
    [[nodiscard]] glm::vec4 ground(const glm::dvec3& direction, const Randoms& randoms) const;
    [[nodiscard]] Surface surface(const VoxelHit& hit, const glm::dvec3& position) const;
    [[nodiscard]] glm::vec3 albedo(const glm::ivec3& voxel) const;
    [[nodiscard]] glm::vec3 shade(const Surface& surface, const Randoms& randoms) const;
    [[nodiscard]] glm::vec3 skyLight(const Surface& surface, const Randoms& randoms) const;
    [[nodiscard]] bool sunReaches(const glm::dvec3& position, const Randoms& randoms) const;

    const BoxVoxels& mVoxels;
    VoxelTree mTree;
    PreviewDesc mDesc;
    PreviewCamera mCamera;
    glm::dvec3 mOrigin, mEdge;         ///< The grid's low corner and a voxel's edges, world units.
    glm::dvec3 mUp, mSun;              ///< Unit, world.
    double mFoot = 0.0, mHeight = 1.0; ///< Set voxels along mUp, world units.
    double mOffset = 0.0;              ///< How far secondary rays start off a surface, world units.
    bool mHasGround = false;
    glm::vec3 mLowColor, mHighColor, mBackgroundTop, mBackgroundBottom; ///< Linear.
};

} // namespace lamina::detail
