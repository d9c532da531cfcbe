#include <reference/light_maps.hpp>

#include <glm/geometric.hpp>

#include <algorithm>
#include <array>
#include <cmath>

namespace lamina::reference {
namespace {

DistanceMap pulled(const DistanceMap& finer) {
    DistanceMap coarser{(finer.side + 1) / 2, {}, finer.empty};
    for (std::uint32_t y = 0; y < coarser.side; ++y)
        for (std::uint32_t x = 0; x < coarser.side; ++x) {
            std::vector<double> children;
            for (const std::uint32_t row : {2 * y, std::min(2 * y + 1, finer.side - 1)})
                for (const std::uint32_t column : {2 * x, std::min(2 * x + 1, finer.side - 1)})
                    if (finer.at(column, row) != finer.empty)
                        children.push_back(finer.at(column, row));
            if (children.size() < 3) {
                coarser.values.push_back(finer.empty);
                continue;
            }
            const double nearest = std::ranges::min(children);
            double sum = 0.0;
            double count = 0.0;
            for (const double child : children)
                if (child <= 1.1 * nearest) {
                    sum += child;
                    count += 1.0;
                }
            coarser.values.push_back(sum / count);
        }
    return coarser;
}

void push(const DistanceMap& coarser, DistanceMap& finer) {
    const auto clamped = [&](std::int64_t i) {
        return static_cast<std::uint32_t>(
            std::clamp(i, std::int64_t{0}, static_cast<std::int64_t>(coarser.side) - 1));
    };
    for (std::uint32_t y = 0; y < finer.side; ++y)
        for (std::uint32_t x = 0; x < finer.side; ++x) {
            double& value = finer.values[std::size_t{y} * finer.side + x];
            if (value != finer.empty)
                continue;
            // The texel's centre in the coarser map, whose texel centres are at whole numbers.
            const glm::dvec2 place = (glm::dvec2(x, y) + 0.5) * 0.5 - 0.5;
            const glm::dvec2 low = glm::floor(place);
            double sum = 0.0;
            bool isWhole = true;
            for (const double dy : {0.0, 1.0})
                for (const double dx : {0.0, 1.0}) {
                    const glm::dvec2 corner = low + glm::dvec2(dx, dy);
                    const double weight =
                        (1.0 - std::abs(place.x - corner.x)) * (1.0 - std::abs(place.y - corner.y));
                    const double found = coarser.at(clamped(static_cast<std::int64_t>(corner.x)),
                                                    clamped(static_cast<std::int64_t>(corner.y)));
                    isWhole = isWhole && found != coarser.empty;
                    sum += weight * found;
                }
            if (isWhole)
                value = sum;
        }
}

} // namespace

DistanceMap fillHoles(const DistanceMap& map, std::uint32_t levels) {
    std::vector<DistanceMap> pyramid{map};
    for (std::uint32_t i = 0; i < levels && pyramid.back().side > 1; ++i)
        pyramid.push_back(pulled(pyramid.back()));
    for (std::size_t i = pyramid.size(); i-- > 1;)
        push(pyramid[i], pyramid[i - 1]);
    return pyramid.front();
}

std::vector<std::uint32_t> rectify(const EpipolarTransform& transform,
                                   const FirstSurface& surface) {
    const glm::uvec3 size = transform.size();
    const glm::dvec3 origin = transform.origin();
    const glm::dvec3 scale = transform.scale();
    std::vector<std::uint32_t> first;
    for (std::uint32_t row = 0; row < size.y; ++row)
        for (std::uint32_t sample = 0; sample < size.z; ++sample) {
            const double theta = origin.y + (row + 0.5) / scale.y;
            const double phi = origin.z + (sample + 0.5) / scale.z;
            const glm::dvec3 side =
                std::cos(theta) * transform.u() + std::sin(theta) * transform.v();
            const bool isSun = transform.isDirectional();
            const auto hit =
                isSun ? surface(transform.eye() + phi * side, -transform.axis())
                      : surface(transform.light().position,
                                std::cos(phi) * -transform.axis() + std::sin(phi) * side);
            std::uint32_t voxel = size.x;
            if (hit) {
                const glm::dvec3 seen = glm::normalize(*hit - transform.eye());
                const double alpha =
                    std::acos(std::clamp(glm::dot(seen, transform.axis()), -1.0, 1.0));
                const double place = (alpha - origin.x) * scale.x;
                voxel = static_cast<std::uint32_t>(
                    std::clamp(std::ceil(place - 0.5), 0.0, static_cast<double>(size.x)));
            }
            first.push_back(voxel);
        }
    return first;
}

} // namespace lamina::reference
