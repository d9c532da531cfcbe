#pragma once

#include "gl/host_texture.hpp"
#include "gl/state_guard.hpp"
#include "shadow_volumes/frame_constants.hpp"

#include <span>
#include <vector>

namespace lamina {

/// Receivers of a frame as geometry: which of them the viewer sees, and their slicemap.
class ReceiverPass {
public:
    explicit ReceiverPass(std::shared_ptr<gl::DeviceState> device);

    /// Errors: InvalidArgument. Changes nothing.
    [[nodiscard]] Result<void> check(std::span<const GeometrySource> receivers) const;
    /// Builds programs of checked receivers and makes room. withSlicemap: also for drawLayers().
    /// Errors: ShaderError, OutOfMemory.
    [[nodiscard]] Result<void> set(std::span<const GeometrySource> receivers, bool withSlicemap);

    /// Marks the receivers that the view sees. The caller has bound the frame's constants, and
    /// guards raster state of two uniform buffers, storage buffers and texture units.
    void findSeen(const ShadowScene& scene, const glm::dvec3& origin,
                  const gl::SampledDepths& depths, gl::RasterStateGuard& guard);
    /// Sets the bits of seen receivers in the slicemap, into the bound framebuffer's viewport.
    void drawLayers(std::span<const GeometrySource> receivers, gl::RasterStateGuard& guard) const;

    /// One word a receiver: 1 if seen.
    [[nodiscard]] GLuint flags() const { return mFlags.id(); }
    [[nodiscard]] std::uint32_t size() const { return mCount; }

private:
    struct Programs {
        GLuint seen = 0, layers = 0;
    };

    [[nodiscard]] Result<Programs> build(const GeometrySource& source, bool withSlicemap) const;
    void draw(std::span<const GeometrySource> receivers, bool isSlicemap, GLuint pass,
              gl::RasterStateGuard& guard) const;

    std::shared_ptr<gl::DeviceState> mDevice;
    gl::Framebuffer mTarget; ///< As large as the view, nothing attached.
    gl::VertexArray mVertexArray;
    gl::Buffer mBlocks, mFlags;
    std::size_t mBlockStride = 0;
    std::vector<Programs> mPrograms;
    std::uint32_t mCount = 0;
    std::uint32_t mCapacity = 0;
    bool mWithSlicemap = false;
};

} // namespace lamina
