#include "voxelize/slicemap_groups.hpp"

#include <algorithm>
#include <limits>
#include <string>

namespace lamina {

Result<std::vector<SlicemapGroups>> slicemapGroups(const gl::DeviceState& device,
                                                   const GridTransform& transform, VoxelStore store,
                                                   std::uint32_t mostPerPass) {
    const glm::uvec3 size = transform.size();
    const std::uint32_t groupCount =
        (size.z + BitGrid::kSlicesPerGroup - 1) / BitGrid::kSlicesPerGroup;
    std::uint64_t perPass = mostPerPass;
    const std::uint64_t layerBytes = std::uint64_t{16} * size.x * size.y;
    const std::uint64_t alignment = device.limits.storageBufferOffsetAlignment;
    // A binding begins up to this much before its words.
    const std::uint64_t slack = layerBytes % alignment == 0 ? 0 : alignment;
    if (store == VoxelStore::Buffer) {
        // Word indices in the shader are signed 32-bit numbers.
        const std::uint64_t room =
            std::min<std::uint64_t>(device.limits.maxStorageBlockBytes, 1u << 30u);
        if (layerBytes + slack > room && layerBytes * groupCount > room)
            return Error{ErrorCode::DeviceLimit,
                         "voxelize: grid " + transform.describe() + " needs " +
                             std::to_string(layerBytes >> 20u) +
                             " MiB of storage buffer for 128 slices, the device's limit is " +
                             std::to_string(room >> 20u) +
                             " MiB; use fewer columns or VoxelStore::Texture"};
        if (layerBytes * groupCount > room || perPass < groupCount)
            perPass = std::min(perPass, std::max<std::uint64_t>((room - slack) / layerBytes, 1));
    }
    std::vector<SlicemapGroups> ranges;
    for (std::uint32_t group = 0; group < groupCount;) {
        SlicemapGroups range;
        range.first = group;
        range.count =
            static_cast<std::uint32_t>(std::min<std::uint64_t>(perPass, groupCount - group));
        const std::uint64_t begin = layerBytes * range.first;
        const std::uint64_t aligned = begin / alignment * alignment;
        range.offsetBytes = static_cast<GLintptr>(aligned);
        range.sizeBytes = static_cast<GLsizeiptr>(begin - aligned + layerBytes * range.count);
        range.skippedWords = static_cast<std::uint32_t>((begin - aligned) / sizeof(std::uint32_t));
        ranges.push_back(range);
        group += range.count;
    }
    return ranges;
}

void limitDepths(SlicemapPass& pass, const GridTransform& transform, Coverage coverage) {
    constexpr double kUnbounded = std::numeric_limits<double>::infinity();
    pass.nearDepth = transform.depthAtSlice(pass.firstSlice);
    pass.farDepth = transform.depthAtSlice(pass.firstSlice + pass.sliceCount);
    if (coverage == Coverage::Solid) {
        // A crossing toggles all slices before it. The first pass counts those before the grid too.
        if (pass.firstSlice == 0)
            pass.nearDepth = -kUnbounded;
        pass.farDepth = kUnbounded;
    }
}

} // namespace lamina
