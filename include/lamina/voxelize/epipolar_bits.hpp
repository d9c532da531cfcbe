#pragma once

#include <lamina/core/export.hpp>
#include <lamina/core/result.hpp>
#include <lamina/voxelize/epipolar_transform.hpp>

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace lamina {

/// How the bits of shadow volumes are stored and asked.
struct EpipolarLayout {
    /// Phi samples in a texel of 128 bits: 128, or 127 for devices that lose the last bit ([WD13]
    /// 5).
    std::uint32_t bitsPerTexel = 128;
    /// Voxels added to a point's coordinates before a look-up, against shadow acne on surfaces; 0
    /// for exact volumes. [WD13] 5 found -2.25 and -1 to work well for surface shadows.
    double alphaBias = 0.0;
    double phiBias = 0.0;
    /// Eye rays within this many alpha voxels of the light take the epipole rule ([WD13] 5):
    /// queries take the point asked for as what the eye sees there, so it and all before it are lit
    /// exactly if it lies beyond the light (beyond the sky distance, for a directional light). 0:
    /// no rule, right for points that the eye may not see.
    double epipoleVoxels = 0.0;

    bool operator==(const EpipolarLayout&) const = default;
};

/// The voxels of shadow volumes in host memory, and the queries of lamina/epipolar.glsl in double
/// precision. Set bit: shadowed. Every volume has the same size.
class LAMINA_API EpipolarBits {
public:
    /// All voxels clear.
    /// Errors: InvalidArgument (no transforms, different sizes, bitsPerTexel other than 127 or 128,
    /// non-finite biases), OutOfMemory.
    [[nodiscard]] static Result<EpipolarBits> create(std::span<const EpipolarTransform> transforms,
                                                     const EpipolarLayout& layout = {});

    [[nodiscard]] std::span<const EpipolarTransform> transforms() const { return mTransforms; }
    [[nodiscard]] const EpipolarLayout& layout() const { return mLayout; }
    /// Voxels along alpha, theta, phi of every volume.
    [[nodiscard]] const glm::uvec3& size() const { return mTransforms.front().size(); }
    /// Texels along phi.
    [[nodiscard]] std::uint32_t groupCount() const {
        return (size().z + mLayout.bitsPerTexel - 1) / mLayout.bitsPerTexel;
    }

    /// Is the voxel (alpha, theta, phi) of volume `vsv` shadowed? Both in range (asserted).
    [[nodiscard]] bool test(std::size_t vsv, const glm::uvec3& voxel) const;
    void set(std::size_t vsv, const glm::uvec3& voxel, bool value = true);

    /// Is a world point lit? The answer of the voxel that holds it.
    [[nodiscard]] bool lit(std::size_t vsv, const glm::dvec3& world) const;
    /// The lit share in [0,1] of a world point, interpolated between the centres of its neighbours
    /// in theta and phi ([WD13] 3.3).
    [[nodiscard]] double litInterpolated(std::size_t vsv, const glm::dvec3& world) const;
    /// The shadowed share in [0,1] of the eye ray from the eye to a world point, in equal steps of
    /// phi.
    [[nodiscard]] double shadowedFraction(std::size_t vsv, const glm::dvec3& world) const;
    /// The same, interpolated in theta and phi.
    [[nodiscard]] double shadowedFractionInterpolated(std::size_t vsv,
                                                      const glm::dvec3& world) const;

    /// Four words a texel, by volume, group, theta, alpha; bit (k & 31) of word k >> 5 of group g
    /// is phi sample g * bitsPerTexel + k.
    [[nodiscard]] std::span<const std::uint32_t> words() const { return mWords; }
    [[nodiscard]] std::span<std::uint32_t> words() { return mWords; }
    /// Index of the first word of a texel.
    [[nodiscard]] std::size_t texelIndex(std::size_t vsv, std::uint32_t alpha, std::uint32_t theta,
                                         std::uint32_t group) const {
        return (((vsv * groupCount() + group) * size().y + theta) * size().x + alpha) * 4;
    }

private:
    EpipolarBits() = default;
    struct Place;
    [[nodiscard]] Place place(std::size_t vsv, const glm::dvec3& world) const;
    [[nodiscard]] bool shadowed(std::size_t vsv, std::int64_t alpha, std::int64_t theta,
                                std::int64_t phi) const;
    [[nodiscard]] double fractionOfRay(std::size_t vsv, std::int64_t alpha, std::int64_t theta,
                                       double end, bool interpolate) const;

    std::vector<EpipolarTransform> mTransforms;
    EpipolarLayout mLayout;
    std::vector<std::uint32_t> mWords;
};

} // namespace lamina
