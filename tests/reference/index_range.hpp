#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace lamina::reference {

/// Integers from first to last inclusive; empty if first > last.
struct IndexRange {
    std::int64_t first = 0, last = -1;
};

/// The integers i in [0, count) with low <= i <= high.
[[nodiscard]] inline IndexRange indicesBetween(double low, double high, std::uint32_t count) {
    const double last = static_cast<double>(count) - 1.0;
    if (!(low <= last && high >= 0.0))
        return {};
    return {static_cast<std::int64_t>(std::ceil(std::max(low, 0.0))),
            static_cast<std::int64_t>(std::floor(std::min(high, last)))};
}

} // namespace lamina::reference
