#include <lamina/grid/bit_grid.hpp>

#include <algorithm>
#include <new>
#include <numeric>

namespace lamina {

Result<BitGrid> BitGrid::create(const GridTransform& transform) {
    BitGrid grid(transform);
    const glm::uvec3 size = transform.size();
    const double words = 4.0 * size.x * size.y * grid.groupCount();
    try {
        if (words > static_cast<double>(grid.mWords.max_size()))
            throw std::bad_alloc();
        grid.mWords.resize(static_cast<std::size_t>(words));
    } catch (const std::bad_alloc&) {
        return Error{ErrorCode::OutOfMemory,
                     "bit grid: " + transform.describe() + " needs " +
                         std::to_string(static_cast<std::uint64_t>(words * 4.0 / (1 << 20))) +
                         " MiB, which the host could not give; use fewer voxels"};
    }
    return grid;
}

bool BitGrid::at(const glm::dvec3& world) const {
    const auto voxel = mTransform.voxelAt(world);
    return voxel && test(*voxel);
}

std::uint64_t BitGrid::count() const {
    return std::transform_reduce(
        mWords.begin(), mWords.end(), std::uint64_t{0}, std::plus<>(),
        [](std::uint32_t word) { return static_cast<std::uint64_t>(std::popcount(word)); });
}

std::uint32_t BitGrid::countNearer(const glm::uvec2& column, std::uint32_t slice) const {
    const std::uint32_t limit = std::min(slice, size().z);
    std::uint32_t count = 0;
    for (std::uint32_t first = 0; first < limit; first += 32) {
        std::uint32_t word = mWords[wordIndex({column.x, column.y, first})];
        if (limit - first < 32)
            word &= (1u << (limit - first)) - 1u;
        count += static_cast<std::uint32_t>(std::popcount(word));
    }
    return count;
}

Result<BitGrid> BitGrid::reoriented(Axis axis) const {
    const auto from = mTransform.boxAxis();
    if (!from || mTransform.distribution().kind() != SliceDistribution::Kind::Linear)
        return Error{ErrorCode::InvalidArgument,
                     "bit grid: expected a box grid with linear slices to reorient, found " +
                         mTransform.describe()};
    if (*from == axis)
        return *this;
    const glm::uvec3 fromAxes = boxGridAxes(*from);
    glm::uvec3 worldCounts;
    for (int i = 0; i < 3; ++i)
        worldCounts[fromAxes[i]] = size()[i];
    auto transform = GridTransform::box(mTransform.boxBounds(), worldCounts, axis);
    if (!transform)
        return transform.error();
    auto target = create(*transform);
    if (!target)
        return target;
    const glm::uvec3 toAxes = boxGridAxes(axis);
    forEachSet([&](const glm::uvec3& voxel) {
        glm::uvec3 world;
        for (int i = 0; i < 3; ++i)
            world[fromAxes[i]] = voxel[i];
        target->set({world[toAxes.x], world[toAxes.y], world[toAxes.z]});
    });
    return target;
}

Result<BitGridComparison> compare(const BitGrid& first, const BitGrid& second) {
    if (first.size() != second.size())
        return Error{ErrorCode::InvalidArgument, "compare: expected grids of equal size, found " +
                                                     first.transform().describe() + " and " +
                                                     second.transform().describe()};
    BitGridComparison result;
    const auto a = first.words();
    const auto b = second.words();
    for (std::size_t i = 0; i < a.size(); ++i) {
        result.both += static_cast<std::uint64_t>(std::popcount(a[i] & b[i]));
        result.onlyFirst += static_cast<std::uint64_t>(std::popcount(a[i] & ~b[i]));
        result.onlySecond += static_cast<std::uint64_t>(std::popcount(b[i] & ~a[i]));
    }
    return result;
}

} // namespace lamina
