#pragma once

#include <lamina/core/export.hpp>
#include <lamina/core/result.hpp>
#include <lamina/gl/device.hpp>
#include <lamina/grid/grid_transform.hpp>

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

namespace lamina {

/// What a voxel of a volume can record about the surfaces that hit it.
enum class VolumePayload : std::uint8_t {
    Count,      ///< Hits. R8 or R32UI.
    Absorption, ///< Sum of the hits' material absorption. R8, R16F or R32F.
    Normal,     ///< Mean surface normal, world space. RGBA8, RGBA16F or RGBA32F.
    Color,      ///< Mean surface colour. RGBA8, RGBA16F or RGBA32F.
    /// Mean refractive index and transmission; in float formats also where the surface crosses its
    /// slice. RGBA8, RGBA16F or RGBA32F.
    Optics,
};
inline constexpr std::size_t kVolumePayloadCount = 5;

enum class VolumeFormat : std::uint8_t { None, R8, R16F, R32F, R32UI, RGBA8, RGBA16F, RGBA32F };

/// How each payload is stored; None: not at all.
///
/// No format wraps around. Each has a ceiling, where a sum stops to grow exactly, and which
/// VolumeData reports: R8 counts 255, R8 absorption 1, half floats 2048 hits of a voxel, floats
/// 2^24, R32UI 2^32 - 1.
/// 8-bit means and absorption are made from half-float sums by a further pass over the grid, and
/// need these sums as scratch memory in the voxelizer.
struct VolumeLayout {
    VolumeFormat count = VolumeFormat::R32UI;
    VolumeFormat absorption = VolumeFormat::None;
    VolumeFormat normal = VolumeFormat::None;
    VolumeFormat color = VolumeFormat::None;
    VolumeFormat optics = VolumeFormat::None;

    [[nodiscard]] LAMINA_API VolumeFormat format(VolumePayload payload) const;
    bool operator==(const VolumeLayout&) const = default;
};

/// A volume in host memory. Arrays of payloads that the volume does not hold are empty, the others
/// have a value per voxel: x fastest, then y, then slice.
struct VolumeData {
    GridTransform transform;
    std::vector<std::uint32_t> counts;
    std::vector<float> absorption;
    std::vector<glm::vec3> normals; ///< Unit length; zero without hits, or where they cancel out.
    std::vector<glm::vec3> colors;  ///< Zero without hits.
    std::vector<glm::vec2> optics;  ///< Refractive index, transmission; (1,1) without hits.
    /// Voxels of each payload (by VolumePayload) at the ceiling of its format: their values are
    /// lower bounds.
    std::array<std::uint64_t, kVolumePayloadCount> saturatedVoxels{};

    [[nodiscard]] std::size_t index(const glm::uvec3& voxel) const {
        const glm::uvec3& size = transform.size();
        return (std::size_t{voxel.z} * size.y + voxel.y) * size.x + voxel.x;
    }
};

/// Voxels in GL memory with what surfaces leave in them: the result of a VolumeVoxelizer, and what
/// shaders query ([CLN11] 2).
///
/// One 3D texture a payload: columns x, columns y, slices. Texels of float formats hold sums over
/// the hits of a voxel: absorption; (normal, hits), (colour, hits), (refractive index,
/// transmission, offset, hits), where offset is that of the surface at the column's centre from the
/// voxel's, in slices. Those of RGBA8 hold means: normal * 0.5 + 0.5, colour, ((index - 1) / 3,
/// transmission, 0), and min(hits, 255) / 255 in alpha. A uniform buffer holds the grid's
/// constants. `#include <lamina/volume.glsl>` queries all of them. Reused across frames: memory is
/// allocated again only when the size changes. Move-only; see Device for threads and lifetime.
class LAMINA_API VolumeGrid {
public:
    /// A volume of no size; a VolumeVoxelizer or resize() gives it one.
    /// Errors: InvalidArgument (a payload with a format that cannot hold it, no payload at all),
    /// OutOfMemory (for the 16 KiB uniform buffer).
    [[nodiscard]] static Result<VolumeGrid> create(const Device& device,
                                                   const VolumeLayout& layout = {});

    VolumeGrid(VolumeGrid&&) noexcept;
    VolumeGrid& operator=(VolumeGrid&&) noexcept;
    ~VolumeGrid();

    /// Takes the shape and place of `transform`; the voxels' values are then undefined.
    /// Errors: DeviceLimit, OutOfMemory; the volume is then unchanged.
    [[nodiscard]] Result<void> resize(const GridTransform& transform);

    /// The voxels, copied to host memory. Waits for the GPU.
    /// Errors: InvalidArgument on a volume of no size, OutOfMemory.
    [[nodiscard]] Result<VolumeData> download() const;

    /// Binds what lamina/volume.glsl reads: the uniform buffer to `uniformBufferBinding`
    /// (LAMINA_VOLUME_BLOCK_BINDING of the shader), textures (and no sampler objects) to the six
    /// units from `textureUnit` (LAMINA_VOLUME_TEXTURE_UNIT), of which payloads that the volume
    /// does not hold leave theirs alone. Does nothing on a volume of no size. GL: these bindings
    /// are what it changes; the caller restores them if need be.
    void bind(std::uint32_t uniformBufferBinding = 0, std::uint32_t textureUnit = 0) const;

    [[nodiscard]] const VolumeLayout& layout() const;
    /// Where the voxels are; nothing for a volume of no size.
    [[nodiscard]] const GridTransform* transform() const;
    /// GL name of a payload's texture; 0 if there is none.
    [[nodiscard]] std::uint32_t texture(VolumePayload payload) const;
    /// GL name of the uniform buffer.
    [[nodiscard]] std::uint32_t uniformBuffer() const;
    /// Bytes of GL memory held.
    [[nodiscard]] std::uint64_t gpuBytes() const;
    /// Building block for Lamina's own modules; not part of the stable API.
    [[nodiscard]] const gl::DeviceState* deviceState() const;

private:
    struct Impl;
    explicit VolumeGrid(std::unique_ptr<Impl> impl);
    std::unique_ptr<Impl> mImpl;
};

} // namespace lamina
