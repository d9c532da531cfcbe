#include "bench_case.hpp"

#include <openvdb/openvdb.h>
#include <openvdb/tools/MeshToVolume.h>

namespace lamina::bench {
namespace {

/// A TriangleMesh as OpenVDB reads meshes: corners in voxel coordinates.
struct MeshAdapter {
    const TriangleMesh& mesh;
    const GridTransform& transform;

    [[nodiscard]] std::size_t polygonCount() const { return mesh.triangles.size(); }
    [[nodiscard]] std::size_t pointCount() const { return mesh.positions.size(); }
    [[nodiscard]] static std::size_t vertexCount(std::size_t) { return 3; }
    void getIndexSpacePoint(std::size_t polygon, std::size_t corner,
                            openvdb::Vec3d& position) const {
        const auto index = mesh.triangles[polygon][static_cast<glm::length_t>(corner)];
        const glm::dvec3 point = transform.worldToGrid(mesh.positions[index]);
        position = {point.x, point.y, point.z};
    }
};

/// The cheapest answer that OpenVDB gives: no sign (which needs a closed surface), and a band of
/// one voxel around the surface.
Result<void> run(benchmark::State& state, const Case& what) {
    auto mesh = what.mesh->get();
    if (!mesh)
        return mesh.error();
    auto transform = benchGrid(**mesh, what.resolution);
    if (!transform)
        return transform.error();

    constexpr float kBandVoxels = 1.0f;
    const MeshAdapter adapter{**mesh, *transform};
    const auto unitVoxels = openvdb::math::Transform::createLinearTransform();
    openvdb::FloatGrid::Ptr grid;
    for ([[maybe_unused]] auto iteration : state)
        grid = openvdb::tools::meshToVolume<openvdb::FloatGrid>(
            adapter, *unitVoxels, kBandVoxels, kBandVoxels,
            openvdb::tools::UNSIGNED_DISTANCE_FIELD);
    report(state, **mesh, *transform, grid->activeVoxelCount(), grid->memUsage());
    return {};
}

} // namespace

void registerOpenVdb(const Case& what) {
    openvdb::initialize();
    registerMethod(what.describe() + "/OpenVDB meshToVolume, all cores",
                   [what](benchmark::State& state) { return run(state, what); });
}

} // namespace lamina::bench
