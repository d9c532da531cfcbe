#pragma once

#include <lamina/core/export.hpp>
#include <lamina/core/result.hpp>
#include <lamina/grid/bit_grid.hpp>
#include <lamina/grid/grid_transform.hpp>

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace lamina {

/// The layers of a DepthSprite in host memory, for tests without a GPU. Copyable.
class LAMINA_API SpriteLayers {
public:
    /// depths: columns x * columns y * layers numbers, column x fastest, layers slowest: sorted
    /// fractions of the transform's depth range, then LAMINA_PARITY_NO_LAYER (2).
    /// Errors: InvalidArgument (another number of depths, or a perspective transform).
    [[nodiscard]] static Result<SpriteLayers>
    create(const GridTransform& transform, std::uint32_t layers, std::vector<float> depths);

    [[nodiscard]] const GridTransform& transform() const { return mTransform; }
    [[nodiscard]] std::uint32_t layers() const { return mLayers; }
    [[nodiscard]] std::span<const float> depths() const { return mDepths; }
    /// Layer `layer` of a column in the sprite (asserted).
    [[nodiscard]] float depth(const glm::uvec2& column, std::uint32_t layer) const {
        return mDepths[index(column, layer)];
    }

    /// Crossings between the sprite's near side and a point of the space that the sprite was built
    /// in, along its axis; 0 outside the sprite. Cost: logarithmic in layers().
    [[nodiscard]] std::uint32_t crossings(const glm::dvec3& point) const;
    /// As laminaParityInside(), in double precision.
    [[nodiscard]] bool inside(const glm::dvec3& point) const { return crossings(point) % 2 != 0; }

    /// The solid: voxels of transform() whose centres lie inside. With linear slices equal to
    /// Coverage::Solid of the same sources and transform, up to its rounding.
    /// Errors: OutOfMemory. Cost: columns * (slices / 32 + layers()).
    [[nodiscard]] Result<BitGrid> voxels() const;

private:
    SpriteLayers(const GridTransform& transform, std::uint32_t layers, std::vector<float> depths)
        : mTransform(transform)
        , mLayers(layers)
        , mDepths(std::move(depths)) {}

    [[nodiscard]] std::size_t index(const glm::uvec2& column, std::uint32_t layer) const {
        const glm::uvec3 size = mTransform.size();
        return (std::size_t{layer} * size.y + column.y) * size.x + column.x;
    }
    [[nodiscard]] std::uint32_t layersBefore(const glm::uvec2& column, float depth) const;

    GridTransform mTransform;
    std::uint32_t mLayers;
    std::vector<float> mDepths;
};

} // namespace lamina
