#include "mesh_io/vertex_welder.hpp"

#include <array>
#include <bit>

namespace lamina::detail {
namespace {

std::array<std::uint32_t, 3> bitsOf(const glm::vec3& p) {
    return {std::bit_cast<std::uint32_t>(p.x), std::bit_cast<std::uint32_t>(p.y),
            std::bit_cast<std::uint32_t>(p.z)};
}

} // namespace

std::uint32_t VertexWelder::add(const glm::vec3& position) {
    const glm::vec3 p = position + 0.0f; // -0 becomes 0
    const std::array<std::uint32_t, 3> bits = bitsOf(p);
    const std::uint64_t hash = mixBits(mixBits(std::uint64_t{bits[0]} << 32u | bits[1]) ^ bits[2]);
    const auto fresh = static_cast<std::uint32_t>(mPositions.size());
    const std::uint32_t index = mTable.findOrInsert(
        hash, fresh, [&](std::uint32_t other) { return bitsOf(mPositions[other]) == bits; });
    if (index == fresh)
        mPositions.push_back(p);
    return index;
}

} // namespace lamina::detail
