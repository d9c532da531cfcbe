#pragma once

#include <lamina/core/box.hpp>
#include <lamina/core/export.hpp>
#include <lamina/core/result.hpp>

#include <glm/mat4x4.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <vector>

namespace lamina {

enum class Axis : std::uint8_t { X, Y, Z };
enum class Projection : std::uint8_t { Orthographic, Perspective };

/// How a column's depth range [near, far] is cut into slices ([ED06] 2.1, the cellmask).
class SliceDistribution {
public:
    enum class Kind : std::uint8_t { Linear, Logarithmic, Custom };

    /// Slices of equal depth (the default).
    [[nodiscard]] static SliceDistribution linear() { return SliceDistribution(Kind::Linear, {}); }
    /// Slices whose depths grow by a constant ratio; needs near > 0.
    [[nodiscard]] static SliceDistribution logarithmic() {
        return SliceDistribution(Kind::Logarithmic, {});
    }
    /// `boundaries`: slices + 1 strictly increasing fractions of the depth range, from 0 to 1.
    [[nodiscard]] static SliceDistribution custom(std::vector<float> boundaries) {
        return SliceDistribution(Kind::Custom, std::move(boundaries));
    }

    [[nodiscard]] Kind kind() const { return mKind; }
    /// The fractions given to custom(); empty for the other kinds.
    [[nodiscard]] std::span<const float> boundaries() const { return mBoundaries; }
    bool operator==(const SliceDistribution&) const = default;

private:
    SliceDistribution(Kind kind, std::vector<float> boundaries)
        : mKind(kind)
        , mBoundaries(std::move(boundaries)) {}

    Kind mKind;
    std::vector<float> mBoundaries;
};

/// The depths that the slices of one column divide, in a grid with local ranges ([ED06] 2.3).
struct ColumnRange {
    float near = std::numeric_limits<float>::max(); ///< Eye depth, world units.
    float far = -std::numeric_limits<float>::max(); ///< Eye depth, world units.

    /// No geometry in the column; what a default-constructed range says.
    [[nodiscard]] bool isEmpty() const { return !(near <= far); }
    bool operator==(const ColumnRange&) const = default;
};

/// Where a world point stands in a grid.
struct ColumnPlace {
    glm::uvec2 column{0};
    double depth = 0.0; ///< World units; any.
};

/// A camera whose pixels are the columns of a grid.
struct GridCamera {
    glm::dmat4 worldToEye{
        1.0}; ///< Affine; the camera looks along -z of eye space, y up (OpenGL's view matrix).
    Projection projection = Projection::Orthographic;
    /// The window: eye-space x and y, in world units; for a perspective camera at depth `near`
    /// (as in glFrustum).
    double left = -1.0, right = 1.0, bottom = -1.0, top = 1.0;
    double near = 0.0; ///< Eye depth of slice 0's front, world units; > 0 for a perspective camera.
    double far = 1.0;  ///< Eye depth of the last slice's back, world units; > near.

    /// A perspective camera with a symmetric window.
    /// verticalFieldOfView: radians in (0, pi); aspect: width / height.
    [[nodiscard]] LAMINA_API static GridCamera perspective(const glm::dmat4& worldToEye,
                                                           double verticalFieldOfView,
                                                           double aspect, double near, double far);

    /// The camera of an engine's view and projection matrices. `projection` maps to OpenGL clip
    /// space with depth in [-1,1], near to -1, without skew (glm::ortho, glm::perspective,
    /// glm::frustum).
    /// Errors: InvalidArgument for any other matrix (reversed or infinite depth, [0,1] clip space
    /// with a near plane at or behind the eye, skew).
    [[nodiscard]] LAMINA_API static Result<GridCamera> fromMatrices(const glm::dmat4& view,
                                                                    const glm::dmat4& projection);
};

/// Where the voxels of a grid are: world space to voxel coordinates and back.
///
/// Grid coordinates are continuous: x and y in columns (pixels of the grid's camera, origin at its
/// lower left), z in slices, slice 0 nearest the camera. Voxel (i,j,k) covers [i,i+1) x [j,j+1) x
/// [k,k+1); the grid's upper bounds belong to the last voxel of each axis. Depth is the distance
/// along the viewing direction (not along the ray), in world units.
/// A value type; all computations are in double precision.
class LAMINA_API GridTransform {
public:
    /// A grid over an axis-aligned world box, columns along `axis`.
    /// voxels: counts along world x, y, z. Slices go along +axis; columns x, y of the grid are the
    /// two axes that follow `axis` cyclically (X: y,z; Y: z,x; Z: x,y). Errors: InvalidArgument
    /// (non-finite or zero-size box, zero counts, counts above 2^31 - 1).
    [[nodiscard]] static Result<GridTransform>
    box(const Box3& world, const glm::uvec3& voxels, Axis axis = Axis::Z,
        const SliceDistribution& distribution = SliceDistribution::linear());

    /// A grid whose columns are the pixels of `camera`.
    /// size: columns in x, columns in y, slices.
    /// Errors: InvalidArgument (near >= far, near <= 0 for perspective or logarithmic, empty
    /// window, singular or non-affine worldToEye, counts as for box(), custom boundaries that do
    /// not fit).
    [[nodiscard]] static Result<GridTransform>
    camera(const GridCamera& camera, const glm::uvec3& size,
           const SliceDistribution& distribution = SliceDistribution::linear());

    /// Columns in x, columns in y, slices.
    [[nodiscard]] const glm::uvec3& size() const { return mSize; }
    [[nodiscard]] Projection projection() const { return mProjection; }
    [[nodiscard]] double nearDepth() const { return mNear; } ///< World units.
    [[nodiscard]] double farDepth() const { return mFar; }   ///< World units.
    [[nodiscard]] const SliceDistribution& distribution() const { return mDistribution; }

    /// World point to continuous grid coordinates; not clamped to the grid.
    /// For a perspective grid, points at or behind the eye give non-finite coordinates.
    [[nodiscard]] glm::dvec3 worldToGrid(const glm::dvec3& world) const;
    /// The inverse of worldToGrid(); z is clamped to [0, slices].
    [[nodiscard]] glm::dvec3 gridToWorld(const glm::dvec3& grid) const;
    /// The column that holds a world point, or nothing outside the columns or behind the eye.
    [[nodiscard]] std::optional<ColumnPlace> columnAt(const glm::dvec3& world) const;
    /// The voxel that holds a world point, or nothing outside the grid.
    [[nodiscard]] std::optional<glm::uvec3> voxelAt(const glm::dvec3& world) const;
    /// World position of a voxel's centre (grid coordinates voxel + 0.5).
    [[nodiscard]] glm::dvec3 voxelCenter(const glm::uvec3& voxel) const {
        return gridToWorld(glm::dvec3(voxel) + 0.5);
    }

    /// Depth to continuous slice coordinate, piecewise linear between slice boundaries; not clamped
    /// for a linear distribution, clamped to [0, slices] for the others.
    [[nodiscard]] double sliceCoordinate(double depth) const;
    /// Depth at a slice coordinate in [0, slices] (clamped), world units.
    [[nodiscard]] double depthAtSlice(double sliceCoordinate) const;
    /// The slice that holds `depth`, or nothing outside [near, far]; far belongs to the last slice.
    /// A depth within 2^-40 of the depth range before a boundary counts as on it.
    [[nodiscard]] std::optional<std::uint32_t> sliceAt(double depth) const;
    /// The same three where the slices divide `range` instead of [near, far]: at the same fractions
    /// of it, whatever the distribution. A range of no extent has all its depths in slice 0.
    /// sliceAt(): nothing for an empty range; the other two need one that is not empty (asserted).
    [[nodiscard]] double sliceCoordinate(double depth, const ColumnRange& range) const;
    [[nodiscard]] double depthAtSlice(double sliceCoordinate, const ColumnRange& range) const;
    [[nodiscard]] std::optional<std::uint32_t> sliceAt(double depth,
                                                       const ColumnRange& range) const;
    /// slices + 1 increasing fractions of the depth range; empty for a linear distribution.
    [[nodiscard]] std::span<const float> sliceBoundaries() const { return mBoundaries; }

    /// World (x,y,z,1) to (columnX * w, columnY * w, depth, w): w is 1 for an orthographic grid and
    /// the depth for a perspective one.
    [[nodiscard]] const glm::dmat4& worldToColumn() const { return mWorldToColumn; }

    /// For grids made by box(): the axis its columns run along.
    [[nodiscard]] std::optional<Axis> boxAxis() const { return mBoxAxis; }
    /// For grids made by box(): the box.
    [[nodiscard]] const Box3& boxBounds() const { return mBox; }

    /// The same grid cut into another number of slices.
    /// Errors: InvalidArgument, as camera().
    [[nodiscard]] Result<GridTransform>
    withSlices(std::uint32_t slices,
               const SliceDistribution& distribution = SliceDistribution::linear()) const;

    /// "1024 x 1024 x 128 orthographic", for messages.
    [[nodiscard]] std::string describe() const;

    bool operator==(const GridTransform& other) const;

private:
    GridTransform() = default;
    Result<void> setDistribution(const SliceDistribution& distribution);
    [[nodiscard]] double sliceCoordinateOf(double fraction) const;
    [[nodiscard]] double fractionAtSlice(double sliceCoordinate) const;
    [[nodiscard]] std::optional<std::uint32_t> sliceOf(double fraction) const;

    glm::uvec3 mSize{1};
    Projection mProjection = Projection::Orthographic;
    double mNear = 0.0, mFar = 1.0;
    SliceDistribution mDistribution = SliceDistribution::linear();
    std::vector<float> mBoundaries;
    glm::dmat4 mWorldToColumn{1.0};
    glm::dmat4 mColumnToWorld{1.0};
    std::optional<Axis> mBoxAxis;
    Box3 mBox;
};

/// World axes of a box grid's columns x, columns y and slices, e.g. Axis::X gives {1, 2, 0}.
[[nodiscard]] constexpr glm::uvec3 boxGridAxes(Axis axis) {
    const auto slices = static_cast<unsigned>(axis);
    return {(slices + 1) % 3, (slices + 2) % 3, slices};
}

} // namespace lamina
