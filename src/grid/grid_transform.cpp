#include <lamina/grid/grid_transform.hpp>

#include "core/finite.hpp"
#include "lamina/shared/constants.glsl"

#include <glm/gtc/matrix_inverse.hpp>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <string>

namespace lamina {
namespace {

using detail::isFinite;

Error invalid(std::string text) {
    return {ErrorCode::InvalidArgument, "grid transform: " + std::move(text)};
}

std::string numbers(const glm::dvec3& v) {
    return "(" + std::to_string(v.x) + ", " + std::to_string(v.y) + ", " + std::to_string(v.z) +
           ")";
}

Result<void> checkSize(const glm::uvec3& size) {
    if (size.x == 0 || size.y == 0 || size.z == 0)
        return invalid("expected at least one voxel along each axis, found " +
                       std::to_string(size.x) + " x " + std::to_string(size.y) + " x " +
                       std::to_string(size.z));
    constexpr std::uint32_t kMost = std::numeric_limits<std::int32_t>::max();
    if (size.x > kMost || size.y > kMost || size.z > kMost)
        return invalid("expected at most " + std::to_string(kMost) +
                       " voxels along each axis, found " + std::to_string(size.x) + " x " +
                       std::to_string(size.y) + " x " + std::to_string(size.z) +
                       "; use fewer voxels");
    return {};
}

/// World (x,y,z,1) to continuous columns and depth, from rows given one by one.
glm::dmat4 fromRows(const glm::dvec4& x, const glm::dvec4& y, const glm::dvec4& z,
                    const glm::dvec4& w) {
    return glm::transpose(glm::dmat4(x, y, z, w));
}

} // namespace

GridCamera GridCamera::perspective(const glm::dmat4& worldToEye, double verticalFieldOfView,
                                   double aspect, double near, double far) {
    GridCamera camera;
    camera.worldToEye = worldToEye;
    camera.projection = Projection::Perspective;
    camera.top = near * std::tan(0.5 * verticalFieldOfView);
    camera.bottom = -camera.top;
    camera.right = camera.top * aspect;
    camera.left = -camera.right;
    camera.near = near;
    camera.far = far;
    return camera;
}

Result<GridCamera> GridCamera::fromMatrices(const glm::dmat4& view, const glm::dmat4& projection) {
    const auto at = [&](int row, int column) { return projection[column][row]; };
    // A float projection matrix converted to double carries rounding of this size.
    const double tolerance = 1e-6;
    const auto isZero = [&](double value) { return std::abs(value) <= tolerance; };
    const bool sparse = isZero(at(0, 1)) && isZero(at(1, 0)) && isZero(at(2, 0)) &&
                        isZero(at(2, 1)) && isZero(at(3, 0)) && isZero(at(3, 1)) &&
                        !(at(0, 0) == 0.0) && !(at(1, 1) == 0.0);
    if (!isFinite(projection) || !isFinite(view) || !sparse)
        return invalid("expected an orthographic or perspective projection without skew and finite "
                       "matrices; build a GridCamera from its numbers instead");

    GridCamera camera;
    camera.worldToEye = view;
    const double a = at(2, 2);
    const double b = at(2, 3);
    if (isZero(at(3, 2)) && isZero(at(3, 3) - 1.0) && isZero(at(0, 2)) && isZero(at(1, 2))) {
        camera.projection = Projection::Orthographic;
        camera.left = (-1.0 - at(0, 3)) / at(0, 0);
        camera.right = (1.0 - at(0, 3)) / at(0, 0);
        camera.bottom = (-1.0 - at(1, 3)) / at(1, 1);
        camera.top = (1.0 - at(1, 3)) / at(1, 1);
        camera.near = (1.0 + b) / a;
        camera.far = (b - 1.0) / a;
    } else if (isZero(at(3, 2) + 1.0) && isZero(at(3, 3)) && isZero(at(0, 3)) && isZero(at(1, 3))) {
        camera.projection = Projection::Perspective;
        camera.near = b / (a - 1.0);
        camera.far = b / (a + 1.0);
        camera.left = camera.near * (at(0, 2) - 1.0) / at(0, 0);
        camera.right = camera.near * (at(0, 2) + 1.0) / at(0, 0);
        camera.bottom = camera.near * (at(1, 2) - 1.0) / at(1, 1);
        camera.top = camera.near * (at(1, 2) + 1.0) / at(1, 1);
    } else {
        return invalid(
            "expected a projection matrix whose last row is (0,0,0,1) or (0,0,-1,0), found (" +
            std::to_string(at(3, 0)) + ", " + std::to_string(at(3, 1)) + ", " +
            std::to_string(at(3, 2)) + ", " + std::to_string(at(3, 3)) + ")");
    }
    const bool perspective = camera.projection == Projection::Perspective;
    if (!std::isfinite(camera.near) || !std::isfinite(camera.far) || camera.near >= camera.far ||
        (perspective && camera.near <= 0.0))
        return invalid(
            "expected a projection with depth in [-1,1], near to -1 and a finite far plane; "
            "its planes read near " +
            std::to_string(camera.near) + ", far " + std::to_string(camera.far) +
            "; for reversed, infinite or [0,1] depth build a GridCamera from its numbers");
    return camera;
}

Result<GridTransform> GridTransform::box(const Box3& world, const glm::uvec3& voxels, Axis axis,
                                         const SliceDistribution& distribution) {
    if (auto checked = checkSize(voxels); !checked)
        return checked.error();
    if (axis > Axis::Z)
        return invalid("expected axis X, Y or Z, found value " +
                       std::to_string(static_cast<int>(axis)));
    const glm::dvec3 extent = world.max - world.min;
    for (int i = 0; i < 3; ++i)
        if (!std::isfinite(world.min[i]) || !std::isfinite(world.max[i]) ||
            !std::isfinite(extent[i]) || !(extent[i] > 0.0))
            return invalid("expected a finite box with min < max on each axis, found min " +
                           numbers(world.min) + ", max " + numbers(world.max) +
                           "; give a flat mesh an explicit box");

    const glm::uvec3 axes = boxGridAxes(axis);
    GridTransform transform;
    transform.mSize = {voxels[axes.x], voxels[axes.y], voxels[axes.z]};
    transform.mNear = 0.0;
    transform.mFar = extent[axes.z];
    transform.mBoxAxis = axis;
    transform.mBox = world;

    glm::dvec4 rows[3] = {};
    for (int i = 0; i < 3; ++i) {
        const unsigned worldAxis = axes[i];
        const double scale = i == 2 ? 1.0 : transform.mSize[i] / extent[worldAxis];
        rows[i][worldAxis] = scale;
        rows[i].w = -world.min[worldAxis] * scale;
    }
    transform.mWorldToColumn = fromRows(rows[0], rows[1], rows[2], {0, 0, 0, 1});

    glm::dmat4 inverse(0.0);
    for (int i = 0; i < 3; ++i) {
        const unsigned worldAxis = axes[i];
        inverse[i][worldAxis] = i == 2 ? 1.0 : extent[worldAxis] / transform.mSize[i];
        inverse[3][worldAxis] = world.min[worldAxis];
    }
    inverse[3][3] = 1.0;
    transform.mColumnToWorld = inverse;
    if (auto set = transform.setDistribution(distribution); !set)
        return set.error();
    return transform;
}

Result<GridTransform> GridTransform::camera(const GridCamera& camera, const glm::uvec3& size,
                                            const SliceDistribution& distribution) {
    if (auto checked = checkSize(size); !checked)
        return checked.error();
    const bool perspective = camera.projection == Projection::Perspective;
    if (!std::isfinite(camera.near) || !std::isfinite(camera.far) || !(camera.near < camera.far))
        return invalid("expected near < far, found near " + std::to_string(camera.near) + ", far " +
                       std::to_string(camera.far));
    if (perspective && !(camera.near > 0.0))
        return invalid("expected near > 0 for a perspective camera, found " +
                       std::to_string(camera.near));
    const double width = camera.right - camera.left;
    const double height = camera.top - camera.bottom;
    if (!std::isfinite(width) || !std::isfinite(height) || width == 0.0 || height == 0.0)
        return invalid("expected a finite window with left != right and bottom != top, found [" +
                       std::to_string(camera.left) + ", " + std::to_string(camera.right) + "] x [" +
                       std::to_string(camera.bottom) + ", " + std::to_string(camera.top) + "]");
    const glm::dmat4& eye = camera.worldToEye;
    if (!isFinite(eye) || eye[0][3] != 0.0 || eye[1][3] != 0.0 || eye[2][3] != 0.0 ||
        eye[3][3] != 1.0 || !(std::abs(glm::determinant(eye)) > 0.0))
        return invalid("expected a finite, invertible, affine worldToEye with last row (0,0,0,1)");

    GridTransform transform;
    transform.mSize = size;
    transform.mProjection = camera.projection;
    transform.mNear = camera.near;
    transform.mFar = camera.far;

    // Eye space to columns: the window becomes [0, size.x] x [0, size.y].
    const double windowDepth = perspective ? camera.near : 1.0;
    const double scaleX = size.x * windowDepth / width;
    const double scaleY = size.y * windowDepth / height;
    const double offsetX = -camera.left * size.x / width;
    const double offsetY = -camera.bottom * size.y / height;
    const glm::dmat4 eyeToColumn =
        perspective ? fromRows({scaleX, 0, -offsetX, 0}, {0, scaleY, -offsetY, 0}, {0, 0, -1, 0},
                               {0, 0, -1, 0})
                    : fromRows({scaleX, 0, 0, offsetX}, {0, scaleY, 0, offsetY}, {0, 0, -1, 0},
                               {0, 0, 0, 1});
    transform.mWorldToColumn = eyeToColumn * eye;

    // (column x * w, column y * w, depth, 1) back to eye space; w is 1 or the depth.
    const glm::dmat4 columnToEye =
        perspective ? fromRows({1 / scaleX, 0, -offsetX / scaleX, 0},
                               {0, 1 / scaleY, -offsetY / scaleY, 0}, {0, 0, -1, 0}, {0, 0, 0, 1})
                    : fromRows({1 / scaleX, 0, 0, -offsetX / scaleX},
                               {0, 1 / scaleY, 0, -offsetY / scaleY}, {0, 0, -1, 0}, {0, 0, 0, 1});
    transform.mColumnToWorld = glm::affineInverse(eye) * columnToEye;
    if (!isFinite(transform.mWorldToColumn) || !isFinite(transform.mColumnToWorld))
        return invalid("expected an invertible camera, found one whose inverse is not finite");
    if (auto set = transform.setDistribution(distribution); !set)
        return set.error();
    return transform;
}

Result<void> GridTransform::setDistribution(const SliceDistribution& distribution) {
    const std::size_t slices = mSize.z;
    mDistribution = distribution;
    switch (distribution.kind()) {
    case SliceDistribution::Kind::Linear:
        return {};
    case SliceDistribution::Kind::Logarithmic: {
        if (!(mNear > 0.0))
            return invalid("expected near > 0 for a logarithmic slice distribution, found " +
                           std::to_string(mNear));
        mBoundaries.resize(slices + 1);
        const double ratio = std::log(mFar / mNear);
        for (std::size_t k = 0; k <= slices; ++k)
            mBoundaries[k] = static_cast<float>(
                std::expm1(ratio * static_cast<double>(k) / static_cast<double>(slices)) /
                std::expm1(ratio));
        mBoundaries.back() = 1.0f;
        break;
    }
    case SliceDistribution::Kind::Custom: {
        const auto given = distribution.boundaries();
        if (given.size() != slices + 1)
            return invalid("expected slices + 1 (" + std::to_string(slices + 1) +
                           ") custom slice boundaries, found " + std::to_string(given.size()));
        mBoundaries.assign(given.begin(), given.end());
        if (mBoundaries.front() != 0.0f || mBoundaries.back() != 1.0f)
            return invalid("expected custom slice boundaries from 0 to 1, found " +
                           std::to_string(mBoundaries.front()) + " to " +
                           std::to_string(mBoundaries.back()));
        break;
    }
    }
    for (std::size_t k = 0; k < slices; ++k)
        if (!(mBoundaries[k] < mBoundaries[k + 1]))
            return invalid("expected strictly increasing slice boundaries, found " +
                           std::to_string(mBoundaries[k]) + " then " +
                           std::to_string(mBoundaries[k + 1]) + " at slice " + std::to_string(k) +
                           "; use fewer slices");
    return {};
}

namespace {

/// Where a depth stands in a range, 0 to 1; anywhere in a range of no extent is its front.
double fractionOf(double depth, const ColumnRange& range) {
    const double near = range.near;
    const double extent = range.far - near;
    return extent > 0.0 ? (depth - near) / extent : 0.0;
}

} // namespace

double GridTransform::sliceCoordinateOf(double fraction) const {
    const double slices = mSize.z;
    if (!(fraction > 0.0))
        return 0.0;
    if (fraction >= 1.0)
        return slices;
    if (mBoundaries.empty())
        return fraction * slices;
    const auto upper =
        std::upper_bound(mBoundaries.begin(), mBoundaries.end(), fraction,
                         [](double value, float boundary) { return value < boundary; });
    const auto k = static_cast<std::size_t>(upper - mBoundaries.begin()) - 1;
    const double low = mBoundaries[k];
    return static_cast<double>(k) + (fraction - low) / (mBoundaries[k + 1] - low);
}

double GridTransform::sliceCoordinate(double depth) const {
    if (mBoundaries.empty())
        return (depth - mNear) * (mSize.z / (mFar - mNear));
    return sliceCoordinateOf((depth - mNear) * (1.0 / (mFar - mNear)));
}

double GridTransform::sliceCoordinate(double depth, const ColumnRange& range) const {
    assert(!range.isEmpty());
    return sliceCoordinateOf(fractionOf(depth, range));
}

double GridTransform::fractionAtSlice(double sliceCoordinate) const {
    const double s = std::clamp(sliceCoordinate, 0.0, static_cast<double>(mSize.z));
    if (mBoundaries.empty())
        return s / mSize.z;
    const auto k = std::min(static_cast<std::size_t>(s), static_cast<std::size_t>(mSize.z) - 1);
    const double low = mBoundaries[k];
    return low + (s - static_cast<double>(k)) * (mBoundaries[k + 1] - low);
}

double GridTransform::depthAtSlice(double sliceCoordinate) const {
    if (mBoundaries.empty())
        return mNear + std::clamp(sliceCoordinate, 0.0, static_cast<double>(mSize.z)) *
                           ((mFar - mNear) / mSize.z);
    return mNear + fractionAtSlice(sliceCoordinate) * (mFar - mNear);
}

double GridTransform::depthAtSlice(double sliceCoordinate, const ColumnRange& range) const {
    assert(!range.isEmpty());
    const double near = range.near;
    return near + fractionAtSlice(sliceCoordinate) * (range.far - near);
}

std::optional<std::uint32_t> GridTransform::sliceOf(double fraction) const {
    // The same steps as laminaSliceOf() in lamina/slice_distribution.glsl.
    if (!(fraction >= -LAMINA_DEPTH_SNAP && fraction <= 1.0 + LAMINA_DEPTH_SNAP))
        return std::nullopt;
    const double snapped = std::max(fraction + LAMINA_DEPTH_SNAP, 0.0);
    if (mBoundaries.empty())
        return std::min(static_cast<std::uint32_t>(snapped * mSize.z), mSize.z - 1);
    const auto upper =
        std::upper_bound(mBoundaries.begin(), mBoundaries.end(), snapped,
                         [](double value, float boundary) { return value < boundary; });
    return std::min(static_cast<std::uint32_t>(upper - mBoundaries.begin()) - 1, mSize.z - 1);
}

std::optional<std::uint32_t> GridTransform::sliceAt(double depth) const {
    return sliceOf((depth - mNear) * (1.0 / (mFar - mNear)));
}

std::optional<std::uint32_t> GridTransform::sliceAt(double depth, const ColumnRange& range) const {
    // The same steps as localSlices() in voxelize/slicemap.frag.
    const double rounding = (mFar - mNear) * LAMINA_DEPTH_SNAP;
    const double near = range.near;
    const double far = range.far;
    if (range.isEmpty() || !(depth >= near - rounding && depth <= far + rounding))
        return std::nullopt;
    return sliceOf(fractionOf(std::clamp(depth, near, far), range));
}

Result<GridTransform> GridTransform::withSlices(std::uint32_t slices,
                                                const SliceDistribution& distribution) const {
    GridTransform transform = *this;
    transform.mSize.z = slices;
    transform.mBoundaries.clear();
    if (auto checked = checkSize(transform.mSize); !checked)
        return checked.error();
    if (auto set = transform.setDistribution(distribution); !set)
        return set.error();
    return transform;
}

glm::dvec3 GridTransform::worldToGrid(const glm::dvec3& world) const {
    const glm::dvec4 h = mWorldToColumn * glm::dvec4(world, 1.0);
    const double w = mProjection == Projection::Perspective && !(h.w > 0.0)
                         ? std::numeric_limits<double>::quiet_NaN()
                         : h.w;
    return {h.x / w, h.y / w, std::isnan(w) ? w : sliceCoordinate(h.z)};
}

glm::dvec3 GridTransform::gridToWorld(const glm::dvec3& grid) const {
    const double depth = depthAtSlice(grid.z);
    const double w = mProjection == Projection::Perspective ? depth : 1.0;
    return glm::dvec3(mColumnToWorld * glm::dvec4(grid.x * w, grid.y * w, depth, 1.0));
}

std::optional<ColumnPlace> GridTransform::columnAt(const glm::dvec3& world) const {
    const glm::dvec4 h = mWorldToColumn * glm::dvec4(world, 1.0);
    if (!(h.w > 0.0))
        return std::nullopt;
    const double x = h.x / h.w;
    const double y = h.y / h.w;
    if (!(x >= 0.0 && x <= mSize.x && y >= 0.0 && y <= mSize.y))
        return std::nullopt;
    return ColumnPlace{{std::min(static_cast<std::uint32_t>(x), mSize.x - 1),
                        std::min(static_cast<std::uint32_t>(y), mSize.y - 1)},
                       h.z};
}

std::optional<glm::uvec3> GridTransform::voxelAt(const glm::dvec3& world) const {
    const auto place = columnAt(world);
    const auto slice = place ? sliceAt(place->depth) : std::nullopt;
    if (!slice)
        return std::nullopt;
    return glm::uvec3(place->column, *slice);
}

std::string GridTransform::describe() const {
    return std::to_string(mSize.x) + " x " + std::to_string(mSize.y) + " x " +
           std::to_string(mSize.z) +
           (mProjection == Projection::Perspective ? " perspective" : " orthographic");
}

bool GridTransform::operator==(const GridTransform& other) const {
    return mSize == other.mSize && mProjection == other.mProjection && mNear == other.mNear &&
           mFar == other.mFar && mBoundaries == other.mBoundaries &&
           mWorldToColumn == other.mWorldToColumn;
}

} // namespace lamina
