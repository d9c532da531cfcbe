#include "voxelize/overlap_grid.hpp"

#include <lamina/grid/bit_grid.hpp>

#include <algorithm>
#include <limits>
#include <string>

namespace lamina {
namespace {

constexpr std::uint64_t kTexelBytes = 16;
/// Word indices are 32-bit, and larger bindings gain nothing.
constexpr std::uint64_t kMaxBindingBytes = std::uint64_t{1} << 30u;

std::uint64_t maxBindingTexels(const gl::DeviceState& device) {
    return std::min(device.limits.maxStorageBlockBytes, kMaxBindingBytes) / kTexelBytes;
}

/// The part of `texels` texels from `firstTexel` on.
GridPart makePart(std::uint64_t firstTexel, std::uint64_t texels, std::uint64_t alignment) {
    const std::uint64_t begin = firstTexel * kTexelBytes;
    const std::uint64_t aligned = begin / alignment * alignment;
    GridPart part;
    part.offsetBytes = static_cast<GLintptr>(aligned);
    part.sizeBytes = static_cast<GLsizeiptr>(begin - aligned + texels * kTexelBytes);
    part.skippedTexels = static_cast<std::uint32_t>((begin - aligned) / kTexelBytes);
    return part;
}

} // namespace

std::uint32_t maxOverlapColumns(const gl::DeviceState& device) {
    return static_cast<std::uint32_t>(
        std::min<std::uint64_t>(device.limits.maxTextureBufferTexels, maxBindingTexels(device)));
}

std::uint32_t maxOverlapSlices(const gl::DeviceState& device) {
    return static_cast<std::uint32_t>(std::min<std::uint64_t>(
        std::uint64_t{device.limits.maxTextureBufferTexels} * BitGrid::kSlicesPerGroup, 1u << 24u));
}

bool isOverlapGrid(const GridTransform& transform) {
    return transform.projection() == Projection::Orthographic &&
           transform.distribution().kind() == SliceDistribution::Kind::Linear;
}

Result<std::vector<GridPart>> gridParts(const gl::DeviceState& device,
                                        const GridTransform& transform) {
    if (!isOverlapGrid(transform))
        return Error{
            ErrorCode::Unsupported,
            "voxelize: overlap expected an orthographic grid with linear slices, found " +
                transform.describe() +
                (transform.projection() == Projection::Orthographic
                     ? " with logarithmic or custom slices"
                     : "") +
                "; use Backend::Slicemap with Coverage::Conservative, or with Coverage::Solid "
                "and SolidRule::Parity"};
    const glm::uvec3 size = transform.size();
    if (size.x > maxOverlapColumns(device) || size.y > maxOverlapColumns(device) ||
        size.z > maxOverlapSlices(device))
        return Error{ErrorCode::DeviceLimit,
                     "voxelize: grid " + transform.describe() + ", the device's limit is " +
                         std::to_string(maxOverlapColumns(device)) + " x " +
                         std::to_string(maxOverlapColumns(device)) + " x " +
                         std::to_string(maxOverlapSlices(device)) + "; use a smaller grid"};

    const std::uint64_t layers = (size.z + BitGrid::kSlicesPerGroup - 1) / BitGrid::kSlicesPerGroup;
    const std::uint64_t layerTexels = std::uint64_t{size.x} * size.y;
    const std::uint64_t alignment = device.limits.storageBufferOffsetAlignment;
    // All but the first part lose up to one alignment to what stands before them.
    std::uint64_t room = maxBindingTexels(device);
    if (layers * layerTexels > room)
        room -= std::min(room, alignment / kTexelBytes);
    const std::uint64_t layersPerPart = std::min<std::uint64_t>(
        room / layerTexels, kOverlapSlicesPerPart / BitGrid::kSlicesPerGroup);
    const std::uint64_t rowsPerPart =
        layersPerPart > 0 ? size.y : std::max<std::uint64_t>(room / size.x, 1);
    const std::uint64_t step = std::max<std::uint64_t>(layersPerPart, 1);

    std::vector<GridPart> parts;
    for (std::uint64_t layer = 0; layer < layers; layer += step)
        for (std::uint64_t row = 0; row < size.y; row += rowsPerPart) {
            const std::uint64_t layerCount = std::min(step, layers - layer);
            const std::uint64_t rowCount = std::min(rowsPerPart, size.y - row);
            GridPart part = makePart(layer * layerTexels + row * size.x,
                                     layerCount * rowCount * size.x, alignment);
            part.low = {0, row, layer * BitGrid::kSlicesPerGroup};
            part.high = {
                size.x - 1, row + rowCount - 1,
                std::min<std::uint64_t>((layer + layerCount) * BitGrid::kSlicesPerGroup, size.z) -
                    1};
            parts.push_back(part);
        }
    return parts;
}

void writeGridPart(const GridPart& part, const GridTransform& transform,
                   shared::LaminaOverlapConstants& block) {
    block.low = glm::ivec4(part.low, part.skippedTexels);
    block.high = glm::ivec4(part.high, 0);
    block.grid = {transform.size().x, part.high.y - part.low.y + 1,
                  (part.high.z - part.low.z) / static_cast<int>(BitGrid::kSlicesPerGroup) + 1, 0};
}

glm::dmat4 overlapWorldToGrid(const GridTransform& transform) {
    const double scale = transform.size().z / (transform.farDepth() - transform.nearDepth());
    glm::dmat4 depthToSlice(1.0);
    depthToSlice[2][2] = scale;
    depthToSlice[3][2] = -transform.nearDepth() * scale;
    return depthToSlice * transform.worldToColumn();
}

} // namespace lamina
