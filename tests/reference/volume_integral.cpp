#include <reference/volume_integral.hpp>

#include <algorithm>
#include <optional>

namespace lamina::reference {
namespace {

/// For each voxel the nearest one that is not empty, in front of it (step 1: the column is walked
/// away from the eye) or behind it (step -1).
std::vector<std::optional<Facing>> neighbours(std::span<const Facing> column, int step) {
    std::vector<std::optional<Facing>> found(column.size());
    std::optional<Facing> last;
    for (std::size_t n = 0; n < column.size(); ++n) {
        const std::size_t i = step > 0 ? n : column.size() - 1 - n;
        found[i] = last;
        if (column[i] != Facing::Empty)
            last = column[i];
    }
    return found;
}

bool isInner(Facing voxel, std::optional<Facing> before, std::optional<Facing> behind) {
    if (voxel != Facing::Empty)
        return voxel != Facing::Back || !behind;
    if (!before || !behind)
        return false;
    if (*before != Facing::Both)
        return *before == Facing::Front;
    return *behind == Facing::Back;
}

} // namespace

unsigned countInner(std::span<const Facing> column) {
    const auto before = neighbours(column, 1);
    const auto behind = neighbours(column, -1);
    unsigned count = 0;
    for (std::size_t i = 0; i < column.size(); ++i)
        count += isInner(column[i], before[i], behind[i]) ? 1 : 0;
    return count;
}

bool looksClosed(std::span<const Facing> column) {
    const auto isFull = [](Facing facing) { return facing != Facing::Empty; };
    const auto first = std::ranges::find_if(column, isFull);
    if (first == column.end())
        return true;
    const auto last = std::find_if(column.rbegin(), column.rend(), isFull);
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
