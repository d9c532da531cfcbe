#include <lamina/grid/attribute_grid.hpp>

#include <glm/vector_relational.hpp>

#include <array>
#include <bit>
#include <new>
#include <string>
#include <utility>

namespace lamina {
namespace {

struct Painted {
    glm::uvec3 voxel;
    glm::u8vec4 color;
};

constexpr std::array<glm::ivec3, 6> kFaces{glm::ivec3{0, 0, -1}, {0, 0, 1},  {0, -1, 0},
                                           glm::ivec3{0, 1, 0},  {-1, 0, 0}, {1, 0, 0}};

/// Breadth first from the voxels with hits; `colors` takes what is found.
void spread(const BitGrid& grid, const BitRank& rank, const std::vector<std::uint32_t>& hits,
            std::vector<glm::u8vec4>& colors) {
    const glm::uvec3 size = grid.size();
    std::vector<bool> isPainted(hits.size());
    std::vector<Painted> front;
    std::vector<Painted> next;
    std::size_t index = 0;
    grid.forEachSet([&](const glm::uvec3& voxel) {
        isPainted[index] = hits[index] > 0;
        if (isPainted[index])
            front.push_back({voxel, colors[index]});
        ++index;
    });
    for (; !front.empty(); std::swap(front, next)) {
        next.clear();
        for (const Painted& from : front)
            for (const glm::ivec3& step : kFaces) {
                // Before the first voxel it wraps around to beyond the last.
                const glm::uvec3 to = from.voxel + glm::uvec3(step);
                if (glm::any(glm::greaterThanEqual(to, size)) || !grid.test(to))
                    continue;
                const std::size_t place = rank(to);
                if (isPainted[place])
                    continue;
                isPainted[place] = true;
                colors[place] = from.color;
                next.push_back({to, from.color});
            }
    }
}

} // namespace

Result<void> spreadColors(const BitGrid& grid, AttributeGrid& attributes) {
    auto rank = BitRank::create(grid);
    if (!rank)
        return rank.error();
    if (attributes.colors.size() != rank->count() || attributes.hits.size() != rank->count())
        return Error{ErrorCode::InvalidArgument,
                     "spread colours: expected " + std::to_string(rank->count()) +
                         " colours and hits, one for each set voxel, found " +
                         std::to_string(attributes.colors.size()) + " and " +
                         std::to_string(attributes.hits.size()) +
                         "; take attributes of the same grid"};
    try {
        std::vector<glm::u8vec4> colors = attributes.colors;
        spread(grid, *rank, attributes.hits, colors);
        attributes.colors = std::move(colors);
    } catch (const std::bad_alloc&) {
        return Error{ErrorCode::OutOfMemory, "spread colours: found too little memory for " +
                                                 std::to_string(rank->count()) +
                                                 " voxels; use fewer"};
    }
    return {};
}

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
