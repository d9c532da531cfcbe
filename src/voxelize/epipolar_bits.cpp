#include <lamina/voxelize/epipolar_bits.hpp>

#include "voxelize/epipolar_constants.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <new>
#include <optional>
#include <string>

namespace lamina {

/// Where a point falls: the epipole rule's answer, or biased coordinates.
struct EpipolarBits::Place {
    std::optional<bool> litByRule;
    glm::dvec3 coordinates{0.0};
};

Result<EpipolarBits> EpipolarBits::create(std::span<const EpipolarTransform> transforms,
                                          const EpipolarLayout& layout) {
    if (auto sound = checkEpipolarLayout(transforms, layout); !sound)
        return sound.error();
    EpipolarBits bits;
    bits.mLayout = layout;
    try {
        bits.mTransforms.assign(transforms.begin(), transforms.end());
        bits.mWords.resize(bits.texelIndex(transforms.size(), 0, 0, 0));
    } catch (const std::bad_alloc&) {
        return Error{ErrorCode::OutOfMemory,
                     "epipolar bits: no memory for " + std::to_string(transforms.size()) +
                         " shadow volumes of " + transforms.front().describe() + " voxels"};
    }
    return bits;
}

bool EpipolarBits::test(std::size_t vsv, const glm::uvec3& voxel) const {
    assert(vsv < mTransforms.size() && voxel.x < size().x && voxel.y < size().y &&
           voxel.z < size().z);
    const std::uint32_t bit = voxel.z % mLayout.bitsPerTexel;
    const std::size_t texel = texelIndex(vsv, voxel.x, voxel.y, voxel.z / mLayout.bitsPerTexel);
    return (mWords[texel + bit / 32] >> (bit % 32) & 1u) != 0;
}

void EpipolarBits::set(std::size_t vsv, const glm::uvec3& voxel, bool value) {
    assert(vsv < mTransforms.size() && voxel.x < size().x && voxel.y < size().y &&
           voxel.z < size().z);
    const std::uint32_t bit = voxel.z % mLayout.bitsPerTexel;
    const std::size_t texel = texelIndex(vsv, voxel.x, voxel.y, voxel.z / mLayout.bitsPerTexel);
    std::uint32_t& word = mWords[texel + bit / 32];
    const std::uint32_t mask = 1u << (bit % 32);
    word = value ? word | mask : word & ~mask;
}

EpipolarBits::Place EpipolarBits::place(std::size_t vsv, const glm::dvec3& world) const {
    const EpipolarTransform& transform = mTransforms[vsv];
    const glm::dvec3 extent(size());
    glm::dvec3 coordinates = transform.worldToVoxel(world);
    Place place;
    const double alpha = transform.origin().x + coordinates.x / transform.scale().x;
    if (alpha < mLayout.epipoleVoxels / transform.scale().x)
        place.litByRule =
            glm::dot(world - transform.eye(), transform.axis()) >= epipoleRuleDistance(transform);
    coordinates += glm::dvec3(mLayout.alphaBias, 0.0, mLayout.phiBias);
    place.coordinates = {std::clamp(coordinates.x, 0.0, extent.x), coordinates.y,
                         std::clamp(coordinates.z, 0.0, extent.z)};
    return place;
}

bool EpipolarBits::shadowed(std::size_t vsv, std::int64_t alpha, std::int64_t theta,
                            std::int64_t phi) const {
    const glm::i64vec3 extent(size());
    if (mTransforms[vsv].isFullCircle())
        theta = theta < 0 ? theta + extent.y : (theta >= extent.y ? theta - extent.y : theta);
    const glm::i64vec3 voxel(std::clamp<std::int64_t>(alpha, 0, extent.x - 1),
                             std::clamp<std::int64_t>(theta, 0, extent.y - 1),
                             std::clamp<std::int64_t>(phi, 0, extent.z - 1));
    return test(vsv, glm::uvec3(voxel));
}

bool EpipolarBits::lit(std::size_t vsv, const glm::dvec3& world) const {
    const Place at = place(vsv, world);
    if (at.litByRule)
        return *at.litByRule;
    const glm::i64vec3 voxel(glm::floor(at.coordinates));
    return !shadowed(vsv, voxel.x, voxel.y, voxel.z);
}

double EpipolarBits::litInterpolated(std::size_t vsv, const glm::dvec3& world) const {
    const Place at = place(vsv, world);
    if (at.litByRule)
        return *at.litByRule ? 1.0 : 0.0;
    const glm::dvec3 shifted = at.coordinates - glm::dvec3(0.0, 0.5, 0.5);
    const glm::i64vec3 low(glm::floor(shifted));
    double sum = 0.0;
    for (const int theta : {0, 1})
        for (const int phi : {0, 1}) {
            const double weight = (1.0 - std::abs(shifted.y - static_cast<double>(low.y + theta))) *
                                  (1.0 - std::abs(shifted.z - static_cast<double>(low.z + phi)));
            if (!shadowed(vsv, low.x, low.y + theta, low.z + phi))
                sum += weight;
        }
    return sum;
}

double EpipolarBits::fractionOfRay(std::size_t vsv, std::int64_t alpha, std::int64_t theta,
                                   double end, bool interpolate) const {
    const auto value = [&](std::int64_t phi) {
        return shadowed(vsv, alpha, theta, phi) ? 1.0 : 0.0;
    };
    constexpr double kLeast = 1.0 / 1024.0;
    if (end < kLeast)
        return value(0);
    const std::int64_t last = std::int64_t{size().z} - 1;
    const auto whole = std::clamp<std::int64_t>(
        static_cast<std::int64_t>(std::floor(interpolate ? end - 0.5 : end)), 0, last);
    double sum = 0.0;
    for (std::int64_t phi = 0; phi < whole; ++phi)
        sum += value(phi);
    if (!interpolate)
        return (sum + (end - static_cast<double>(whole)) * value(whole)) / end;
    if (end < 0.5)
        return value(0);
    // From the centre of sample `whole` on, linear towards the next; half a sample before it.
    const double part = end - 0.5 - static_cast<double>(whole);
    sum += (0.5 + part) * value(whole) + 0.5 * part * part * (value(whole + 1) - value(whole));
    return sum / end;
}

double EpipolarBits::shadowedFraction(std::size_t vsv, const glm::dvec3& world) const {
    const Place at = place(vsv, world);
    if (at.litByRule)
        return *at.litByRule ? 0.0 : 1.0;
    const glm::i64vec3 voxel(glm::floor(at.coordinates));
    return fractionOfRay(vsv, voxel.x, voxel.y, at.coordinates.z, false);
}

double EpipolarBits::shadowedFractionInterpolated(std::size_t vsv, const glm::dvec3& world) const {
    const Place at = place(vsv, world);
    if (at.litByRule)
        return *at.litByRule ? 0.0 : 1.0;
    const double theta = std::floor(at.coordinates.y - 0.5);
    const double weight = at.coordinates.y - 0.5 - theta;
    const auto alpha = static_cast<std::int64_t>(std::floor(at.coordinates.x));
    const auto low = static_cast<std::int64_t>(theta);
    return (1.0 - weight) * fractionOfRay(vsv, alpha, low, at.coordinates.z, true) +
           weight * fractionOfRay(vsv, alpha, low + 1, at.coordinates.z, true);
}

} // namespace lamina
