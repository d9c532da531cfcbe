#pragma once

#include <lamina/core/box.hpp>
#include <lamina/core/export.hpp>
#include <lamina/core/result.hpp>
#include <lamina/gl/device.hpp>
#include <lamina/grid/grid_transform.hpp>
#include <lamina/parity/depth_sprite.hpp>
#include <lamina/parity/sprite_transform.hpp>
#include <lamina/voxelize/geometry_source.hpp>

#include <cstdint>
#include <memory>
#include <span>

namespace lamina {

/// How a sprite's layers are found. Both give the same layers.
enum class SpriteMethod : std::uint8_t {
    SinglePass, ///< Gathers the crossings of all columns in one geometry pass, then sorts them.
    Peeling,    ///< Depth peeling ([TD08] 4.1): a geometry pass per layer and one that counts.
};

/// What a build did; known without waiting for the GPU.
struct SpriteStats {
    std::uint32_t geometryPasses = 0;
    std::uint64_t spriteBytes = 0; ///< GL memory of the sprite.
    /// GL memory that the builder keeps for its next build: 4 bytes a column (columns x
    /// times y of the last transform, counted ones too).
    std::uint64_t scratchBytes = 0;
};

/// A direction and what a sprite along it needs.
struct SpriteDirection {
    glm::dvec3 direction{0.0, 0.0, 1.0};
    SpriteReport report; ///< As counted at the resolution asked for.
};

/// Builds depth sprites from triangles on the GPU: once, or every frame for shapes that move.
///
/// Which column crosses which triangle is decided by exact edge equations in double precision, as
/// by a Voxelizer: closed shapes, of any orientation, cross every column evenly, faces parallel to
/// the axis and coincident faces included. Move-only; see Device for threads and lifetime.
///
/// Even is outside: a closed mesh whose faces all stand twice is outside everywhere. An open shape
/// whose columns enter by its closed side and leave by the hole is odd there
/// (SpriteReport::oddColumns), and the column is taken to begin at the sprite's near side: the
/// solid then lies before the shape. Turn the direction round, so that columns enter by the hole:
/// then the solid lies between the sprite's near side and the closed side.
///
/// Memory counts against DeviceDesc::memoryBudgetBytes (Device::setMemoryBudget()): a sprite's
/// DepthSprite::bytesFor(), and the builder's SpriteStats::scratchBytes and 24 bytes. While
/// columns or layers change, old and new memory are held together.
///
/// Every call leaves the GL state as it was and, unless it says otherwise, sprites unchanged if it
/// fails. Writes of the host
/// to its vertex buffers by shaders need GL_VERTEX_ATTRIB_ARRAY_BARRIER_BIT |
/// GL_ELEMENT_ARRAY_BARRIER_BIT before a call. A DrawSource's callback runs once per geometry pass.
class LAMINA_API SpriteBuilder {
public:
    /// Errors: ShaderError. Cost: compiles programs (milliseconds).
    [[nodiscard]] static Result<SpriteBuilder> create(const Device& device);

    SpriteBuilder(SpriteBuilder&&) noexcept;
    SpriteBuilder& operator=(SpriteBuilder&&) noexcept;
    ~SpriteBuilder();

    /// Builds `out` with `layers` layers (rounded up to an even number, at least 2), however many
    /// the shape needs; does not wait for the GPU. Columns with more crossings become empty, and
    /// DepthSprite::downloadReport() counts them. An empty list of sources gives an empty sprite.
    /// transform: orthographic. GL: `out` may be sampled at once, no barrier needed.
    /// Errors: InvalidArgument (a perspective transform, no layers, no SpriteMethod, a source that
    /// does not fit its buffers), DeviceLimit, OutOfMemory, ShaderError (a DrawSource's vertex
    /// stage).
    [[nodiscard]] Result<SpriteStats> build(std::span<const GeometrySource> sources,
                                            const GridTransform& transform, std::uint32_t layers,
                                            DepthSprite& out,
                                            SpriteMethod method = SpriteMethod::SinglePass);

    /// Builds `out` with at least as many layers as the shape needs, and tells what it found. Waits
    /// for the GPU. SinglePass first tries the layers that `out` has, if its columns are as many;
    /// if they are too few, and at first, a pass that counts finds the number.
    /// Errors: as build(); DeviceLimit and OutOfMemory name the layers needed, and `out` may then
    /// hold the shape with columns that overflow.
    [[nodiscard]] Result<SpriteReport> buildAndWait(std::span<const GeometrySource> sources,
                                                    const GridTransform& transform,
                                                    DepthSprite& out,
                                                    SpriteMethod method = SpriteMethod::SinglePass);

    /// What a sprite of these sources and this transform would need, by a geometry pass that only
    /// counts; DepthSprite::bytesFor() tells the memory. Waits for the GPU.
    /// Errors: as build(), but for layers.
    [[nodiscard]] Result<SpriteReport> downloadReport(std::span<const GeometrySource> sources,
                                                      const GridTransform& transform);

    /// Of the directions, the one with the least depth complexity; if several have it, the one with
    /// the fewest crossings, then the first. Waits for the GPU. bounds: of the sources.
    /// resolution: columns of the sprites that are counted, see fitSprite(). Cost: a geometry pass
    /// each. Errors: InvalidArgument (no directions), those of fitSprite() and downloadReport().
    [[nodiscard]] Result<SpriteDirection>
    downloadBestDirection(std::span<const GeometrySource> sources, const Box3& bounds,
                          std::span<const glm::dvec3> directions = spriteDirections(),
                          std::uint32_t resolution = 256);

private:
    struct Impl;
    explicit SpriteBuilder(std::unique_ptr<Impl> impl);
    std::unique_ptr<Impl> mImpl;
};

} // namespace lamina
