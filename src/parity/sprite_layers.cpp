#include "parity/parity_constants.hpp"

#include <lamina/parity/sprite_layers.hpp>

#include <glm/vec4.hpp>

#include <algorithm>
#include <string>

namespace lamina {
namespace {

/// The depths of the slices' centres as the sprite's depths are stored.
std::vector<float> sliceCentres(const GridTransform& transform) {
    const std::uint32_t slices = transform.size().z;
    const bool isLinear = transform.distribution().kind() == SliceDistribution::Kind::Linear;
    const double near = transform.nearDepth();
    const double range = transform.farDepth() - near;
    std::vector<float> centres(slices);
    for (std::uint32_t slice = 0; slice < slices; ++slice) {
        const double centre = slice + 0.5;
        centres[slice] = static_cast<float>(
            isLinear ? centre / slices : (transform.depthAtSlice(centre) - near) / range);
    }
    return centres;
}

/// Sets slices [first, end) of a column.
void setSlices(BitGrid& grid, const glm::uvec2& column, std::uint32_t first, std::uint32_t end) {
    for (std::uint32_t slice = first; slice < end;) {
        const std::uint32_t wordEnd = std::min(end, (slice | 31u) + 1);
        const std::uint32_t count = wordEnd - slice;
        const std::uint32_t bits = count == 32 ? ~0u : ((1u << count) - 1) << (slice & 31u);
        grid.words()[grid.wordIndex({column, slice})] |= bits;
        slice = wordEnd;
    }
}

} // namespace

Result<SpriteLayers> SpriteLayers::create(const GridTransform& transform, std::uint32_t layers,
                                          std::vector<float> depths) {
    const glm::uvec3 size = transform.size();
    const std::size_t expected = std::size_t{size.x} * size.y * layers;
    if (transform.projection() != Projection::Orthographic || depths.size() != expected)
        return Error{ErrorCode::InvalidArgument,
                     "sprite layers: expected an orthographic transform and " +
                         std::to_string(expected) + " depths, found " + transform.describe() +
                         " and " + std::to_string(depths.size())};
    return SpriteLayers(transform, layers, std::move(depths));
}

std::uint32_t SpriteLayers::layersBefore(const glm::uvec2& column, float limit) const {
    std::uint32_t low = 0;
    for (std::uint32_t high = mLayers; low < high;) {
        const std::uint32_t middle = (low + high) / 2;
        if (depth(column, middle) <= limit)
            low = middle + 1;
        else
            high = middle;
    }
    return low;
}

std::uint32_t SpriteLayers::crossings(const glm::dvec3& point) const {
    const glm::dvec4 place = mTransform.worldToColumn() * glm::dvec4(point, 1.0);
    const double fraction =
        (place.z - mTransform.nearDepth()) / (mTransform.farDepth() - mTransform.nearDepth());
    const glm::uvec2 columns(mTransform.size());
    if (!(place.x >= 0.0 && place.y >= 0.0 && place.x <= columns.x && place.y <= columns.y &&
          fraction >= 0.0 && fraction <= 1.0))
        return 0;
    return layersBefore(glm::min(glm::uvec2(place), columns - 1u), static_cast<float>(fraction));
}

Result<BitGrid> SpriteLayers::voxels() const {
    auto grid = BitGrid::create(mTransform);
    if (!grid)
        return grid;
    const std::vector<float> centres = sliceCentres(mTransform);
    const auto firstAtOrBeyond = [&](float depth) {
        return static_cast<std::uint32_t>(std::ranges::lower_bound(centres, depth) -
                                          centres.begin());
    };
    const glm::uvec3 size = mTransform.size();
    for (std::uint32_t y = 0; y < size.y; ++y)
        for (std::uint32_t x = 0; x < size.x; ++x)
            for (std::uint32_t layer = 0; layer + 1 < mLayers; layer += 2) {
                const float enter = depth({x, y}, layer);
                if (enter > 1.0f)
                    break;
                setSlices(*grid, {x, y}, firstAtOrBeyond(enter),
                          firstAtOrBeyond(depth({x, y}, layer + 1)));
            }
    return grid;
}

} // namespace lamina
