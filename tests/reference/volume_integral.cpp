#include <reference/volume_integral.hpp>

#include <algorithm>
#include <optional>

namespace lamina::reference {
namespace {

/// The nearest voxel that is not empty in front of (step -1) or behind (step 1) voxel i.
std::optional<Facing> neighbour(std::span<const Facing> column, std::size_t i, int step) {
    for (auto at = static_cast<std::ptrdiff_t>(i) + step;
         at >= 0 && at < static_cast<std::ptrdiff_t>(column.size()); at += step)
        if (column[static_cast<std::size_t>(at)] != Facing::Empty)
            return column[static_cast<std::size_t>(at)];
    return {};
}

bool isInner(std::span<const Facing> column, std::size_t i) {
    const auto before = neighbour(column, i, -1);
    const auto behind = neighbour(column, i, 1);
    if (column[i] != Facing::Empty)
        return column[i] != Facing::Back || !behind;
    if (!before || !behind)
        return false;
    if (*before != Facing::Both)
        return *before == Facing::Front;
    return *behind == Facing::Back;
}

} // namespace

unsigned countInner(std::span<const Facing> column) {
    unsigned count = 0;
    for (std::size_t i = 0; i < column.size(); ++i)
        count += isInner(column, i) ? 1 : 0;
    return count;
}

bool looksClosed(std::span<const Facing> column) {
    const auto first = std::ranges::find_if(column, [](Facing f) { return f != Facing::Empty; });
    if (first == column.end())
        return true;
    const auto last = neighbour(column, column.size(), -1);
    return *first != Facing::Back && *last != Facing::Front;
}

std::vector<Facing> quantised(std::span<const Crossing> sorted, double near, double far,
                              unsigned slices) {
    std::vector<Facing> column(slices, Facing::Empty);
    for (const Crossing& crossing : sorted) {
        const double fraction = far > near ? (crossing.depth - near) / (far - near) : 0.0;
        const auto slice =
            static_cast<std::size_t>(std::clamp(fraction * slices, 0.0, slices - 1.0));
        const Facing facing = crossing.frontFacing ? Facing::Front : Facing::Back;
        column[slice] =
            column[slice] == Facing::Empty || column[slice] == facing ? facing : Facing::Both;
    }
    return column;
}

} // namespace lamina::reference
