#pragma once

#include "gl/device_state.hpp"
#include "shadow_volumes/frame_constants.hpp"
#include "voxelize/triangle_capture.hpp"

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

namespace lamina {

/// What a draw of a caster makes primitives of.
enum class CasterPart : std::uint8_t {
    Edges,    ///< GL_LINES_ADJACENCY
    Triangles ///< GL_TRIANGLES
};

/// The casters of a frame, ready to be drawn by programs with shadow_volumes/caster.vert.
class CasterDraws {
public:
    explicit CasterDraws(std::shared_ptr<gl::DeviceState> device);

    /// Errors: InvalidArgument. Changes nothing.
    [[nodiscard]] Result<void> check(std::span<const ShadowCaster> casters) const;
    /// Captures those of the checked casters that their own vertex stage makes, and takes all over.
    /// clipsVolumes: volumes of VolumeExtent::Kept fill clip distances.
    /// Errors: InvalidArgument (a vertex stage that makes too few vertices), OutOfMemory,
    /// ShaderError.
    [[nodiscard]] Result<void> set(std::span<const ShadowCaster> casters, const glm::dvec3& origin,
                                   bool clipsVolumes);

    [[nodiscard]] std::uint32_t size() const { return static_cast<std::uint32_t>(mCasters.size()); }
    /// The casters' masks as a frame begins: empty.
    [[nodiscard]] std::vector<shared::LaminaShadowCaster> emptyMasks() const;

    /// Binds the vertex array.
    void bind() const;
    /// Draws a part of a caster; `command`: byte offset of its command in the buffer bound for
    /// indirect draws, or none to draw it all.
    void draw(std::uint32_t caster, CasterPart part, VolumeExtent extent,
              std::optional<std::size_t> command) const;

private:
    struct Caster {
        const ShadowTopology* topology = nullptr;
        MeshView view;
    };

    [[nodiscard]] static Result<void> checkVertices(const Caster& caster, std::size_t index);
    [[nodiscard]] Result<Caster> resolve(const ShadowCaster& caster, std::size_t index);
    void uploadBlocks(const glm::dvec3& origin, bool clipsVolumes);

    std::shared_ptr<gl::DeviceState> mDevice;
    TriangleCapture mCapture;
    gl::VertexArray mVertexArray;
    gl::Buffer mBlocks;
    std::size_t mBlockStride = 0;
    std::vector<Caster> mCasters;
};

} // namespace lamina
