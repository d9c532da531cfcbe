#include <reference/slices.hpp>

namespace lamina::reference {
namespace {

/// Boundary k as a fraction of the depth range.
double boundary(const GridTransform& transform, std::uint32_t k) {
    const auto boundaries = transform.sliceBoundaries();
    return boundaries.empty() ? static_cast<double>(k) / transform.size().z
                              : static_cast<double>(boundaries[k]);
}

} // namespace

double openSliceCoordinate(const GridTransform& transform, double depth) {
    const std::uint32_t slices = transform.size().z;
    const double fraction =
        (depth - transform.nearDepth()) / (transform.farDepth() - transform.nearDepth());
    if (fraction < -kDepthSnap)
        return fraction / boundary(transform, 1);
    if (fraction > 1.0 + kDepthSnap)
        return slices + (fraction - 1.0) / (1.0 - boundary(transform, slices - 1));

    // The last slice that begins at or before the depth.
    std::uint32_t low = 0, high = slices;
    while (high - low > 1) {
        const std::uint32_t middle = low + (high - low) / 2;
        (boundary(transform, middle) <= fraction + kDepthSnap ? low : high) = middle;
    }
    const double front = boundary(transform, low);
    const double part = (fraction - front) / (boundary(transform, low + 1) - front);
    return low + std::clamp(part, 0.0, 1.0);
}

IndexRange slicesTouched(const GridTransform& transform, const DepthSpan& span, double grow) {
    const std::uint32_t slices = transform.size().z;
    const double low = openSliceCoordinate(transform, span.min) - grow;
    const double high = openSliceCoordinate(transform, span.max) + grow;
    if (!(low <= slices && high >= 0.0))
        return {};
    return indicesBetween(std::min(std::floor(low), slices - 1.0), std::floor(high), slices);
}

} // namespace lamina::reference
