#pragma once

#include <lamina/core/triangle_mesh.hpp>
#include <lamina/grid/grid_transform.hpp>

#include <cstdint>
#include <memory>
#include <optional>
#include <unordered_map>
#include <vector>

/// Exact crossings of rays with leaves (Embree), for tests of transmittance shadows.
namespace lamina::reference {

/// A point on a surface.
struct SurfacePoint {
    glm::dvec3 position{0.0};
    glm::dvec3 normal{0.0, 1.0, 0.0};
    std::uint32_t triangle = UINT32_MAX; ///< Of the leaves; none for points on other surfaces.
};

/// `count` points distributed evenly over the area of a mesh.
[[nodiscard]] std::vector<SurfacePoint> sampleSurface(const TriangleMesh& mesh, std::size_t count,
                                                      std::uint32_t seed);

/// Casts rays through a mesh of leaves. Keeps a copy of what it needs.
class LeafRays {
public:
    explicit LeafRays(const TriangleMesh& leaves);
    LeafRays(LeafRays&&) noexcept;
    ~LeafRays();

    /// Leaves between a point and a light: `toLight` ends there, or is a unit direction towards a
    /// light that is `infinitely` far. The point's own triangle does not count.
    [[nodiscard]] unsigned between(const SurfacePoint& point, const glm::dvec3& toLight) const;

    /// Parameters t in (0, 1) of all crossings of the segment from + t * along, sorted.
    [[nodiscard]] std::vector<double> crossings(const glm::dvec3& from, const glm::dvec3& along,
                                                std::uint32_t excluded = UINT32_MAX) const;

private:
    struct Impl;
    std::unique_ptr<Impl> mImpl;
};

/// What a perfect slicemap of given columns and slices knows: the exact crossings of each column's
/// centre line, quantised into its slices.
class IdealSlicemap {
public:
    /// local: each column's slices divide the range of its own crossings.
    IdealSlicemap(const LeafRays& rays, const GridTransform& transform, bool local)
        : mRays(rays)
        , mTransform(transform)
        , mLocal(local) {}

    /// Set slices before the one that holds a point, in its column ([ED06] 3.1).
    [[nodiscard]] unsigned countNearer(const glm::dvec3& point);

private:
    struct Column {
        std::optional<ColumnRange> range;
        std::vector<std::uint32_t> slices; ///< Set ones, sorted, each once.
    };
    const Column& column(const glm::uvec2& place);
    [[nodiscard]] std::optional<std::uint32_t> sliceOf(double depth, const Column& column) const;

    const LeafRays& mRays;
    const GridTransform& mTransform;
    bool mLocal;
    std::unordered_map<std::uint64_t, Column> mColumns;
};

} // namespace lamina::reference
