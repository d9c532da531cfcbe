#include <reference/volume.hpp>

#include <reference/column_triangle.hpp>
#include <reference/index_range.hpp>
#include <reference/slices.hpp>

#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include <array>
#include <cmath>

namespace lamina::reference {
namespace {

/// What a mesh triangle looks like in the world.
class WorldTriangle {
public:
    WorldTriangle(const TriangleMesh& mesh, std::uint32_t triangle, const glm::dmat4& model) {
        const glm::dmat3 normalMatrix = glm::transpose(glm::inverse(glm::dmat3(model)));
        for (int i = 0; i < 3; ++i) {
            const std::uint32_t vertex = mesh.triangles[triangle][i];
            mCorners[i] = glm::dvec3(model * glm::dvec4(mesh.positions[vertex], 1.0));
            if (!mesh.colors.empty())
                mColors[i] = glm::dvec3(mesh.colors[vertex]);
            if (!mesh.normals.empty())
                mNormals[i] = glm::normalize(normalMatrix * glm::dvec3(mesh.normals[vertex]));
        }
        mFaceNormal = glm::cross(mCorners[1] - mCorners[0], mCorners[2] - mCorners[0]);
        if (mesh.normals.empty())
            mNormals.fill(glm::normalize(mFaceNormal));
    }

    /// Shares of the corners at a point of the triangle's plane.
    [[nodiscard]] glm::dvec3 shares(const glm::dvec3& point) const {
        glm::dvec3 areas;
        for (int i = 0; i < 3; ++i)
            areas[i] = glm::dot(mFaceNormal, glm::cross(mCorners[(i + 1) % 3] - point,
                                                        mCorners[(i + 2) % 3] - point));
        return areas / (areas.x + areas.y + areas.z);
    }
    [[nodiscard]] glm::dvec3 normal(const glm::dvec3& shares) const {
        return glm::normalize(shares.x * mNormals[0] + shares.y * mNormals[1] +
                              shares.z * mNormals[2]);
    }
    [[nodiscard]] glm::dvec3 color(const glm::dvec3& shares) const {
        return shares.x * mColors[0] + shares.y * mColors[1] + shares.z * mColors[2];
    }

private:
    std::array<glm::dvec3, 3> mCorners{};
    std::array<glm::dvec3, 3> mNormals{};
    std::array<glm::dvec3, 3> mColors{glm::dvec3(1.0), glm::dvec3(1.0), glm::dvec3(1.0)};
    glm::dvec3 mFaceNormal{};
};

/// Slices whose slab, grown by `overlap`, holds the depth.
IndexRange slabsAt(const GridTransform& transform, double depth, double overlap) {
    const double slice = openSliceCoordinate(transform, depth);
    const std::uint32_t slices = transform.size().z;
    if (!(slice >= 0.0 && slice <= slices))
        return {};
    // k <= slice + overlap and k > slice - overlap - 1.
    IndexRange range = indicesBetween(std::floor(slice - overlap), slice + overlap, slices);
    if (range.first > range.last)
        range = {slices - 1, slices - 1};
    return range;
}

void addHits(const ColumnTriangle& triangle, const WorldTriangle& world, double overlap,
             Volume& volume) {
    const glm::uvec3 size = volume.transform.size();
    const IndexRange columns =
        indicesBetween(triangle.min().x - 0.5, triangle.max().x - 0.5, size.x);
    const IndexRange rows = indicesBetween(triangle.min().y - 0.5, triangle.max().y - 0.5, size.y);
    for (std::int64_t y = rows.first; y <= rows.last; ++y)
        for (std::int64_t x = columns.first; x <= columns.last; ++x) {
            const glm::dvec2 center(static_cast<double>(x) + 0.5, static_cast<double>(y) + 0.5);
            if (!owns(triangle, center))
                continue;
            const double depth = depthAt(triangle, center);
            const IndexRange slabs = slabsAt(volume.transform, depth, overlap);
            if (slabs.first > slabs.last)
                continue;
            const double slice = openSliceCoordinate(volume.transform, depth);
            const glm::dvec3 shares =
                world.shares(volume.transform.gridToWorld(glm::dvec3(center, slice)));
            for (std::int64_t z = slabs.first; z <= slabs.last; ++z) {
                const std::size_t voxel = volume.index(glm::uvec3(x, y, z));
                volume.counts[voxel] += 1;
                volume.normalSums[voxel] += world.normal(shares);
                volume.colorSums[voxel] += world.color(shares);
            }
        }
}

} // namespace

Volume volume(const TriangleMesh& mesh, const GridTransform& transform,
              const VolumeOptions& options) {
    const glm::uvec3 size = transform.size();
    const std::size_t voxels = std::size_t{size.x} * size.y * size.z;
    Volume result{transform, std::vector<std::uint32_t>(voxels), std::vector<glm::dvec3>(voxels),
                  std::vector<glm::dvec3>(voxels)};
    for (const ColumnTriangle& triangle : columnTriangles(mesh, transform, options.model))
        addHits(triangle, WorldTriangle(mesh, triangle.source, options.model), options.slabOverlap,
                result);
    return result;
}

} // namespace lamina::reference
