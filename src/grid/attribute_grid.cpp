#include <lamina/grid/attribute_grid.hpp>

#include <bit>
#include <new>

namespace lamina {

Result<BitRank> BitRank::create(const BitGrid& grid) {
    BitRank rank(grid);
    const std::span<const std::uint32_t> words = grid.words();
    try {
        rank.mTexels.resize(words.size() / 4);
    } catch (const std::bad_alloc&) {
        return Error{ErrorCode::OutOfMemory, "voxel ranks: expected " +
                                                 std::to_string(words.size() * 2 / (1 << 20)) +
                                                 " MiB for " + grid.transform().describe() +
                                                 ", found too little memory; use fewer voxels"};
    }
    std::size_t count = 0;
    for (std::size_t texel = 0; texel < rank.mTexels.size(); ++texel) {
        rank.mTexels[texel] = count;
        for (std::size_t word = 0; word < 4; ++word)
            count += static_cast<std::size_t>(std::popcount(words[texel * 4 + word]));
    }
    rank.mCount = count;
    return rank;
}

std::size_t BitRank::operator()(const glm::uvec3& voxel) const {
    const std::size_t own = mGrid->wordIndex(voxel);
    const std::span<const std::uint32_t> words = mGrid->words();
    std::size_t count = mTexels[own / 4];
    for (std::size_t word = own / 4 * 4; word < own; ++word)
        count += static_cast<std::size_t>(std::popcount(words[word]));
    const std::uint32_t below = (1u << (voxel.z & 31u)) - 1u;
    return count + static_cast<std::size_t>(std::popcount(words[own] & below));
}

} // namespace lamina
