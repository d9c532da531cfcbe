#pragma once

#include <lamina/core/triangle_mesh.hpp>
#include <lamina/gl/device.hpp>
#include <lamina/grid/grid_transform.hpp>

#include <benchmark/benchmark.h>

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace lamina::bench {

/// A mesh by name, loaded or made when a benchmark first asks for it: a filtered run pays for what
/// it measures.
class NamedMesh {
public:
    NamedMesh(std::string meshName, std::function<Result<TriangleMesh>()> make)
        : name(std::move(meshName))
        , mMake(std::move(make)) {}

    /// Why it cannot be had, or the mesh; valid while this object lives.
    [[nodiscard]] Result<const TriangleMesh*> get();

    const std::string name;

private:
    std::function<Result<TriangleMesh>()> mMake;
    TriangleMesh mMesh;
};

/// Procedural meshes, glmark2's bunny, and the meshes of known names in the folder that the
/// environment variable LAMINA_MESH_DIR names, as far as they exist.
[[nodiscard]] std::vector<std::shared_ptr<NamedMesh>> benchMeshes();
/// One shape at about 10k, 40k, ... 10M triangles by Loop subdivision, named "knot_loop0", ...
[[nodiscard]] std::vector<std::shared_ptr<NamedMesh>> scalingMeshes();

/// What is voxelized: cubes, `resolution` of them on the mesh's longest side; columns along z.
struct Case {
    std::shared_ptr<NamedMesh> mesh;
    std::uint32_t resolution = 0;

    [[nodiscard]] std::string describe() const {
        return mesh->name + "/" + std::to_string(resolution);
    }
};

/// The grid of a Case.
[[nodiscard]] Result<GridTransform> benchGrid(const TriangleMesh& mesh, std::uint32_t resolution);

/// What every method reports besides its time: triangles and voxels per second, voxels set, bytes.
void report(benchmark::State& state, const TriangleMesh& mesh, const GridTransform& grid,
            std::uint64_t setVoxels, std::uint64_t bytes);

/// Registers a benchmark in wall and processor time; an error of `body` skips it with its text.
void registerMethod(const std::string& name, std::function<Result<void>(benchmark::State&)> body);

/// Each registers benchmarks of one method, named "mesh/resolution/method".
void registerVoxelizers(const Device& device, const Case& what);
void registerAttributes(const Device& device, const Case& what);
void registerVolumes(const Device& device, const Case& what);
void registerEpipolar(const Device& device, const std::shared_ptr<NamedMesh>& mesh);
void registerSlicemaps(const Device& device, const std::shared_ptr<NamedMesh>& mesh);
void registerRanges(const Device& device, const std::shared_ptr<NamedMesh>& mesh);
#if defined(LAMINA_HAS_REFRACTION)
void registerRefraction(const Device& device, const std::shared_ptr<NamedMesh>& mesh);
#endif
void registerHostOverlap(const Case& what);
#if defined(LAMINA_HAS_OPENVDB)
void registerOpenVdb(const Case& what);
#endif

} // namespace lamina::bench
