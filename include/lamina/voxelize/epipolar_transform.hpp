#pragma once

#include <lamina/core/export.hpp>
#include <lamina/core/result.hpp>
#include <lamina/grid/grid_transform.hpp>

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <cstdint>
#include <limits>
#include <numbers>
#include <string>

namespace lamina {

enum class LightKind : std::uint8_t { Point, Spot, Directional };

/// A light that casts a voxelized shadow volume.
struct EpipolarLight {
    LightKind kind = LightKind::Point;
    glm::dvec3 position{0.0}; ///< Point and Spot; world space.
    glm::dvec3 direction{0.0, 0.0,
                         -1.0}; ///< Spot and Directional: where the light goes; any length.
    double coneAngle = std::numbers::pi / 4; ///< Spot: from the axis to the rim, radians in (0,
                                             ///< pi). Points outside the cone count as shadowed.
};

/// Which part of epipolar space a shadow volume covers. Points outside answer for its nearest
/// voxel.
struct EpipolarRanges {
    glm::dvec2 alpha{0.0, std::numbers::pi}; ///< Radians, within [0, pi].
    /// Radians, within [-pi, pi], around thetaZero.
    glm::dvec2 theta{-std::numbers::pi, std::numbers::pi};
    /// Point and spot lights: radians, within [0, pi]. Directional: world units, from 0.
    glm::dvec2 phi{0.0, std::numbers::pi};
    /// World direction whose part at right angles to the axis has theta 0; any if that part is
    /// zero.
    glm::dvec3 thetaZero{0.0, 0.0, -1.0};
    /// Greatest distance from the eye that matters, world units.
    double farDistance = 1.0;
    /// Directional lights: from this distance on the epipole rule (EpipolarLayout) takes a point to
    /// be sky, behind which the light is.
    double skyDistance = std::numeric_limits<double>::infinity();
};

/// Where the voxels of one voxelized shadow volume are ([WD13] 2.6): angles around the axis from an
/// eye E to a light L.
///
/// alpha: angle at E between the axis and a point P; theta: angle of the half-plane of P around the
/// axis; phi: angle at L between E and P, or for a directional light the distance of P from the
/// axis. An eye ray has constant alpha and theta, a light ray constant theta and phi; going away
/// from the light alpha grows. Voxel (i,j,k) covers [i,i+1) x [j,j+1) x [k,k+1) of the continuous
/// coordinates (alpha, theta, phi). A value type; all computations are in double precision.
class LAMINA_API EpipolarTransform {
public:
    /// Covers exactly what a camera sees up to its far depth.
    /// eye: a perspective camera (its near, far and window count). size: voxels along alpha, theta,
    /// phi. Errors: InvalidArgument (orthographic camera, light at the eye, a direction of no
    /// length, non-finite values, cone angle outside (0, pi), zero sizes).
    [[nodiscard]] static Result<EpipolarTransform>
    fit(const GridCamera& eye, const EpipolarLight& light, const glm::uvec3& size);

    /// Covers given ranges around an eye point.
    /// Errors: as fit(), and ranges that are empty or outside their bounds.
    [[nodiscard]] static Result<EpipolarTransform> create(const glm::dvec3& eye,
                                                          const EpipolarLight& light,
                                                          const EpipolarRanges& ranges,
                                                          const glm::uvec3& size);

    /// Voxels along alpha, theta, phi.
    [[nodiscard]] const glm::uvec3& size() const { return mSize; }
    [[nodiscard]] const EpipolarLight& light() const { return mLight; }
    [[nodiscard]] const EpipolarRanges& ranges() const { return mRanges; }
    [[nodiscard]] bool isDirectional() const { return mLight.kind == LightKind::Directional; }
    /// Does theta cover the whole circle, so that its last voxel borders on its first?
    [[nodiscard]] bool isFullCircle() const;

    [[nodiscard]] const glm::dvec3& eye() const { return mEye; }
    /// Unit vector from the eye to the light.
    [[nodiscard]] const glm::dvec3& axis() const { return mAxis; }
    /// Unit vector at right angles to the axis, theta = 0.
    [[nodiscard]] const glm::dvec3& u() const { return mU; }
    /// axis x u, theta = pi / 2.
    [[nodiscard]] const glm::dvec3& v() const { return mV; }
    /// From eye to light, world units; 0 for a directional light.
    [[nodiscard]] double lightDistance() const { return mLightDistance; }

    /// Least alpha, theta, phi, and voxels per unit of each.
    [[nodiscard]] glm::dvec3 origin() const {
        return {mRanges.alpha.x, mRanges.theta.x, mRanges.phi.x};
    }
    [[nodiscard]] glm::dvec3 scale() const;

    /// Continuous coordinates of a world point; not clamped.
    [[nodiscard]] glm::dvec3 worldToVoxel(const glm::dvec3& world) const;
    /// The inverse. Coordinates with alpha + phi >= pi (point and spot lights) or alpha <= 0 or >=
    /// pi (directional) belong to no point and give non-finite values or points behind the light.
    [[nodiscard]] glm::dvec3 voxelToWorld(const glm::dvec3& voxel) const;

    /// "512 x 512 x 512 epipolar", for messages.
    [[nodiscard]] std::string describe() const;

private:
    EpipolarTransform() = default;
    [[nodiscard]] static Result<EpipolarTransform>
    around(const glm::dvec3& eye, const EpipolarLight& light, const glm::uvec3& size);
    void setThetaZero(const glm::dvec3& direction);
    [[nodiscard]] double phiAt(double alpha, double distance) const;

    glm::uvec3 mSize{1};
    EpipolarLight mLight;
    EpipolarRanges mRanges;
    glm::dvec3 mEye{0.0}, mAxis{0.0, 0.0, 1.0}, mU{1.0, 0.0, 0.0}, mV{0.0, 1.0, 0.0};
    double mLightDistance = 0.0;
};

} // namespace lamina
