#pragma once

#include <lamina/core/export.hpp>
#include <lamina/core/result.hpp>
#include <lamina/gl/device.hpp>
#include <lamina/grid/grid_transform.hpp>
#include <lamina/parity/sprite_layers.hpp>

#include <cstdint>
#include <memory>

namespace lamina {

namespace detail {
struct DepthSpriteData;
}

/// What a build found in its shape.
struct SpriteReport {
    /// Depth complexity: most crossings of a column; even, as one more counts where it is odd.
    std::uint32_t layers = 0;
    /// Columns that cross the surface an odd number of times: it is open there. They are taken to
    /// begin at the sprite's near side, as Coverage::Solid does. 0 for closed shapes.
    std::uint64_t oddColumns = 0;
    /// Columns with more crossings than the sprite has layers. They are empty.
    std::uint64_t overflowColumns = 0;
    std::uint64_t crossings = 0; ///< Of all columns.
};

/// A volumetric depth sprite ([TD08] 3.1): a shape as the depths at which an orthographic camera's
/// pixels, the columns, cross its surface.
///
/// GL: a 2D array texture, GL_R32F, columns x by columns y, a layer per crossing, nearest first,
/// and one with the ranges of blocks of columns (lamina/parity_boxes.glsl). Depths are linear, as
/// fractions of the transform's depth range: 0 for crossings before it, 1.5 beyond it; 2 where a
/// column has no more crossings, and as the border. Shaders test points by
/// `#include <lamina/parity.glsl>` and SpriteSet::bind(). Reused across frames: memory is allocated
/// again only when columns or layers change. Move-only; see Device for threads and lifetime.
class LAMINA_API DepthSprite {
public:
    /// A sprite of no size; SpriteBuilder gives it one. Errors: OutOfMemory.
    [[nodiscard]] static Result<DepthSprite> create(const Device& device);

    DepthSprite(DepthSprite&&) noexcept;
    DepthSprite& operator=(DepthSprite&&) noexcept;
    ~DepthSprite();

    /// Where the columns are, in the space of the sources it was built of; nothing before a build.
    [[nodiscard]] const GridTransform* transform() const;
    /// Crossings that a column can have, an even number: the texture's layers but for the last.
    [[nodiscard]] std::uint32_t layers() const;
    /// GL name of the array texture; 0 before a build.
    [[nodiscard]] std::uint32_t texture() const;
    /// Bytes of GL memory held.
    [[nodiscard]] std::uint64_t gpuBytes() const;
    /// GL memory of a sprite of that many columns and layers.
    [[nodiscard]] static std::uint64_t bytesFor(const GridTransform& transform,
                                                std::uint32_t layers);

    /// What the last build found. Waits for the GPU. Errors: InvalidArgument before a build.
    [[nodiscard]] Result<SpriteReport> downloadReport() const;
    /// The layers, copied to host memory. Waits for the GPU.
    /// Errors: InvalidArgument before a build, OutOfMemory.
    [[nodiscard]] Result<SpriteLayers> download() const;

    /// For Lamina's own modules; not part of the stable API.
    [[nodiscard]] detail::DepthSpriteData& data() { return *mData; }
    [[nodiscard]] const detail::DepthSpriteData& data() const { return *mData; }

private:
    explicit DepthSprite(std::unique_ptr<detail::DepthSpriteData> data);
    std::unique_ptr<detail::DepthSpriteData> mData;
};

} // namespace lamina
