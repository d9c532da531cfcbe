#include "bench_case.hpp"

#include <lamina/mesh_io/mesh_file.hpp>
#include <lamina/mesh_io/subdivision.hpp>

#include <reference/shapes.hpp>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>

namespace lamina::bench {
namespace {

namespace fs = std::filesystem;

constexpr const char* kDebianBunny = "/usr/share/glmark2/models/bunny.obj";
constexpr const char* kMeshNames[] = {"bunny", "armadillo", "dragon", "igea", "igea_loop1"};
constexpr const char* kExtensions[] = {".ply", ".obj", ".stl", ".off"};

void addFile(std::vector<std::shared_ptr<NamedMesh>>& meshes, const std::string& name,
             const fs::path& file) {
    std::error_code ignored;
    if (!fs::is_regular_file(file, ignored))
        return;
    meshes.push_back(std::make_shared<NamedMesh>(name, [file] {
        MeshReadOptions options;
        options.computeNormals = false;
        return readMesh(file, options);
    }));
}

} // namespace

Result<const TriangleMesh*> NamedMesh::get() {
    if (mMake) {
        auto made = mMake();
        if (!made)
            return made.error();
        mMesh = std::move(*made);
        mMake = nullptr;
    }
    return static_cast<const TriangleMesh*>(&mMesh);
}

std::vector<std::shared_ptr<NamedMesh>> benchMeshes() {
    std::vector<std::shared_ptr<NamedMesh>> meshes;
    meshes.push_back(std::make_shared<NamedMesh>(
        "sphere_20k", [] { return Result(reference::makeIcosphere({}, 1.0f, 5)); }));
    meshes.push_back(std::make_shared<NamedMesh>("knot_100k", [] {
        return Result(reference::makeTorusKnot({}, 1.0f, 0.3f, 2, 3, 1000, 50));
    }));
    meshes.push_back(std::make_shared<NamedMesh>("knot_1m", [] {
        return Result(reference::makeTorusKnot({}, 1.0f, 0.3f, 2, 3, 4000, 125));
    }));
    addFile(meshes, "glmark2_bunny", kDebianBunny);
    if (const char* directory = std::getenv("LAMINA_MESH_DIR"))
        for (const char* name : kMeshNames)
            for (const char* extension : kExtensions)
                addFile(meshes, name, fs::path(directory) / (std::string(name) + extension));
    return meshes;
}

std::vector<std::shared_ptr<NamedMesh>> scalingMeshes() {
    constexpr unsigned kLevels = 5;
    std::vector<std::shared_ptr<NamedMesh>> meshes;
    for (unsigned level = 0; level <= kLevels; ++level)
        meshes.push_back(std::make_shared<NamedMesh>("knot_loop" + std::to_string(level), [level] {
            // 10,240 triangles, times four a level.
            return subdivide(reference::makeTorusKnot({}, 1.0f, 0.3f, 2, 3, 256, 20), level);
        }));
    return meshes;
}

Result<GridTransform> benchGrid(const TriangleMesh& mesh, std::uint32_t resolution) {
    Box3 box = mesh.bounds();
    const glm::dvec3 size = box.size();
    const double edge = std::max({size.x, size.y, size.z}) / resolution;
    // A side that is a whole number of voxels but for rounding gets no extra one.
    constexpr double kRounding = 1e-6;
    glm::uvec3 voxels;
    for (int axis = 0; axis < 3; ++axis) {
        const double count = std::max(1.0, std::ceil(size[axis] / edge - kRounding));
        voxels[axis] = static_cast<std::uint32_t>(count);
        box.max[axis] = box.min[axis] + count * edge;
    }
    return GridTransform::box(box, voxels, Axis::Z);
}

void report(benchmark::State& state, const TriangleMesh& mesh, const GridTransform& grid,
            std::uint64_t setVoxels, std::uint64_t bytes) {
    using benchmark::Counter;
    constexpr auto kPerSecond = Counter::kIsIterationInvariantRate;
    const glm::dvec3 size = grid.size();
    const auto set = static_cast<double>(setVoxels);
    state.counters["triangles"] = static_cast<double>(mesh.triangles.size());
    state.counters["triangles/s"] = Counter(static_cast<double>(mesh.triangles.size()), kPerSecond);
    state.counters["voxels/s"] = Counter(size.x * size.y * size.z, kPerSecond);
    state.counters["set voxels/s"] = Counter(set, kPerSecond);
    state.counters["set voxels"] = set;
    state.counters["bytes"] = static_cast<double>(bytes);
}

void registerMethod(const std::string& name, std::function<Result<void>(benchmark::State&)> body) {
    benchmark::RegisterBenchmark(name.c_str(),
                                 [body = std::move(body)](benchmark::State& state) {
                                     if (auto done = body(state); !done)
                                         state.SkipWithError(done.error().text.c_str());
                                 })
        ->UseRealTime()
        ->MeasureProcessCPUTime()
        ->Unit(benchmark::kMillisecond);
}

} // namespace lamina::bench
