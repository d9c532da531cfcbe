#include <reference/leaf_rays.hpp>

#include <reference/ray_scene.hpp>

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <random>
#include <tuple>

namespace lamina::reference {
namespace {

struct Hit {
    double t;
    std::uint32_t triangle;
};

struct Collector {
    RTCIntersectContext context; ///< First: Embree hands back its address.
    std::vector<Hit> hits;
    std::uint32_t excluded;
};

/// Notes the hit and lets the ray go on.
void collect(const RTCFilterFunctionNArguments* arguments) {
    if (arguments->valid[0] != -1)
        return;
    auto* collector = reinterpret_cast<Collector*>(arguments->context);
    const auto* ray = reinterpret_cast<const RTCRay*>(arguments->ray);
    const auto* hit = reinterpret_cast<const RTCHit*>(arguments->hit);
    if (hit->primID != collector->excluded)
        collector->hits.push_back({static_cast<double>(ray->tfar), hit->primID});
    arguments->valid[0] = 0;
}

} // namespace

std::vector<SurfacePoint> sampleSurface(const TriangleMesh& mesh, std::size_t count,
                                        std::uint32_t seed) {
    std::vector<double> areas;
    double area = 0.0;
    const auto corner = [&](std::size_t triangle, int i) {
        return glm::dvec3(mesh.positions[mesh.triangles[triangle][i]]);
    };
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
        area +=
            0.5 * glm::length(glm::cross(corner(i, 1) - corner(i, 0), corner(i, 2) - corner(i, 0)));
        areas.push_back(area);
    }
    std::mt19937 random(seed);
    const auto unit = [&] { return (random() + 0.5) / 4294967296.0; };
    std::vector<SurfacePoint> points;
    for (std::size_t n = 0; n < count; ++n) {
        const auto at = std::ranges::upper_bound(areas, unit() * area);
        const auto i = std::min(static_cast<std::size_t>(at - areas.begin()), areas.size() - 1);
        const double root = std::sqrt(unit());
        const double part = unit();
        const glm::dvec3 a = corner(i, 0), b = corner(i, 1), c = corner(i, 2);
        points.push_back({(1.0 - root) * a + root * ((1.0 - part) * b + part * c),
                          glm::normalize(glm::cross(b - a, c - a)), static_cast<std::uint32_t>(i)});
    }
    return points;
}

struct LeafRays::Impl {
    RayScene scene;
};

LeafRays::LeafRays(const TriangleMesh& leaves)
    : mImpl(new Impl{RayScene(leaves, collect)}) {}

LeafRays::LeafRays(LeafRays&&) noexcept = default;
LeafRays::~LeafRays() = default;

std::vector<double> LeafRays::crossings(const glm::dvec3& from, const glm::dvec3& along,
                                        std::uint32_t excluded) const {
    Collector collector{{}, {}, excluded};
    std::ignore = mImpl->scene.cast(collector.context, from, along, 1.0);
    // A filter may see a hit more than once.
    std::ranges::sort(collector.hits, {}, &Hit::triangle);
    const auto isSame = [](const Hit& a, const Hit& b) { return a.triangle == b.triangle; };
    collector.hits.erase(std::unique(collector.hits.begin(), collector.hits.end(), isSame),
                         collector.hits.end());
    std::vector<double> found;
    for (const Hit& hit : collector.hits)
        found.push_back(hit.t);
    std::ranges::sort(found);
    return found;
}

unsigned LeafRays::between(const SurfacePoint& point, const glm::dvec3& toLight) const {
    return static_cast<unsigned>(crossings(point.position, toLight, point.triangle).size());
}

const IdealSlicemap::Column& IdealSlicemap::column(const glm::uvec2& place) {
    const auto [found, isNew] = mColumns.try_emplace(std::uint64_t{place.y} << 32u | place.x);
    Column& made = found->second;
    if (!isNew)
        return made;
    const glm::dvec2 centre = glm::dvec2(place) + 0.5;
    const glm::dvec3 front = mTransform.gridToWorld({centre, 0.0});
    const glm::dvec3 back = mTransform.gridToWorld({centre, mTransform.size().z});
    std::vector<double> depths;
    for (const double t : mRays.crossings(front, back - front))
        depths.push_back(mTransform.nearDepth() +
                         t * (mTransform.farDepth() - mTransform.nearDepth()));
    if (depths.empty())
        return made;
    if (mLocal)
        made.range =
            ColumnRange{static_cast<float>(depths.front()), static_cast<float>(depths.back())};
    for (const double depth : depths)
        if (const auto slice = sliceOf(
                made.range ? std::clamp<double>(depth, made.range->near, made.range->far) : depth,
                made))
            made.slices.push_back(*slice);
    made.slices.erase(std::unique(made.slices.begin(), made.slices.end()), made.slices.end());
    return made;
}

std::optional<std::uint32_t> IdealSlicemap::sliceOf(double depth, const Column& column) const {
    return column.range ? mTransform.sliceAt(depth, *column.range) : mTransform.sliceAt(depth);
}

unsigned IdealSlicemap::countNearer(const glm::dvec3& point) {
    const auto place = mTransform.columnAt(point);
    if (!place)
        return 0;
    const Column& here = column(place->column);
    const double near = here.range ? here.range->near : mTransform.nearDepth();
    const double far = here.range ? here.range->far : mTransform.farDepth();
    if (here.slices.empty() || place->depth <= near)
        return 0;
    if (place->depth > far)
        return static_cast<unsigned>(here.slices.size());
    const auto slice = sliceOf(place->depth, here);
    return static_cast<unsigned>(std::ranges::lower_bound(here.slices, slice.value_or(0)) -
                                 here.slices.begin());
}

} // namespace lamina::reference
