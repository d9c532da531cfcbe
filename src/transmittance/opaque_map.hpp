#pragma once

#include "transmittance/light_faces.hpp"
#include "transmittance/transmittance_constants.hpp"
#include "voxelize/epipolar_depth_maps.hpp"

#include <lamina/transmittance/transmittance.hpp>

#include <span>

namespace lamina {

/// The shadow map of the opaque casters: a depth texture array, a layer a face of the light.
class OpaqueMap {
public:
    OpaqueMap(std::shared_ptr<gl::DeviceState> device, std::uint32_t texels);

    /// Draws the casters as each face sees them.
    [[nodiscard]] Result<void> draw(std::span<const GeometrySource> sources,
                                    const LightFaces& faces);
    /// Copies the host's map.
    [[nodiscard]] Result<void> copy(const LightDepthMap& map, const TransmittanceLight& light);
    /// There are no opaque casters.
    void clear() { mIsPresent = false; }

    /// Fills the parts that tell how to query the map.
    void describe(shared::LaminaTransmittanceConstants& constants) const;
    /// 0: none.
    [[nodiscard]] GLuint texture() const;
    [[nodiscard]] std::uint64_t gpuBytes() const {
        return mRenderer.texture().bytes() + mCopy.bytes();
    }

private:
    [[nodiscard]] Result<void> reserveCopy(GLenum format, const glm::uvec3& size);

    std::shared_ptr<gl::DeviceState> mDevice;
    DepthMapRenderer mRenderer;
    std::uint32_t mTexels;
    gl::Texture mCopy;
    GLenum mCopyFormat = GL_NONE;
    glm::uvec3 mCopySize{0};

    bool mIsPresent = false;
    bool mIsCopy = false;
    glm::uvec2 mSize{0};
    float mEmptyDepth = 0.0f;
    std::vector<glm::dmat4> mWorldToTexel;
    std::array<int, 6> mLayerOfAxis{};
};

} // namespace lamina
