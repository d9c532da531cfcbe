#include "bench_case.hpp"
#include "gl_timing.hpp"
#include "uploaded_mesh.hpp"

#include <lamina/voxelize/epipolar_grid.hpp>
#include <lamina/voxelize/epipolar_voxelizer.hpp>
#include <lamina/voxelize/geometry_source.hpp>

#include <cmath>
#include <numbers>
#include <vector>

namespace lamina::bench {
namespace {

enum class Stage { All, Rectify, Scan };

struct Setting {
    const char* name;
    std::uint32_t lights;
    std::uint32_t voxels; ///< Along alpha, theta and phi.
    Stage stage;
};

/// Point lights on a ring above the mesh, seen by an eye that looks at it from two diameters away.
Result<std::vector<EpipolarTransform>> makeTransforms(const Box3& box, const Setting& setting) {
    const glm::dvec3 center = 0.5 * (box.min + box.max);
    const double radius = 0.5 * glm::length(box.size());
    const glm::dvec3 eye = center + glm::dvec3(0.0, 0.5, 4.0) * radius;
    std::vector<EpipolarTransform> transforms;
    for (std::uint32_t i = 0; i < setting.lights; ++i) {
        const double angle = 2.0 * std::numbers::pi * i / setting.lights;
        EpipolarLight light;
        light.position = center + radius * glm::dvec3(std::cos(angle), 1.5, std::sin(angle));
        EpipolarRanges ranges;
        ranges.farDistance = 8.0 * radius;
        auto made = EpipolarTransform::create(eye, light, ranges, glm::uvec3(setting.voxels));
        if (!made)
            return made.error();
        transforms.push_back(*made);
    }
    return transforms;
}

Result<void> run(benchmark::State& state, const Device& device,
                 const std::shared_ptr<NamedMesh>& mesh, const Setting& setting) {
    auto uploaded = upload(device, *mesh);
    if (!uploaded)
        return uploaded.error();
    auto transforms = makeTransforms(uploaded->mesh->bounds(), setting);
    EpipolarVoxelizerDesc desc;
    desc.depthMapTexels = setting.voxels;
    auto voxelizer = EpipolarVoxelizer::create(device, desc);
    auto grid = EpipolarGrid::create(device);
    if (!transforms)
        return transforms.error();
    if (!voxelizer)
        return voxelizer.error();
    if (!grid)
        return grid.error();
    const std::span<const GeometrySource> sources(&uploaded->source, 1);
    EpipolarStats stats;
    const auto voxelize = [&](bool scans) -> Result<void> {
        auto done = scans ? voxelizer->voxelize(sources, *transforms, *grid)
                          : voxelizer->rectify(sources, *transforms, *grid);
        if (!done)
            return done.error();
        stats = *done;
        return {};
    };
    if (auto first = voxelize(true); !first)
        return first;
    auto measured = measure(state, device, [&]() -> Result<void> {
        return setting.stage == Stage::Scan ? voxelizer->scan(*grid)
                                            : voxelize(setting.stage == Stage::All);
    });
    if (!measured)
        return measured;
    using benchmark::Counter;
    const double voxels = std::pow(setting.voxels, 3.0) * setting.lights;
    state.counters["voxels/s"] = Counter(voxels, Counter::kIsIterationInvariantRate);
    const auto triangles = static_cast<double>(uploaded->mesh->triangles.size());
    state.counters["triangles"] = triangles;
    if (setting.stage != Stage::Scan)
        state.counters["triangles/s"] = Counter(triangles, Counter::kIsIterationInvariantRate);
    state.counters["depth maps"] = stats.depthMaps;
    state.counters["bytes"] = static_cast<double>(stats.gridBytes + stats.depthBytes);
    return {};
}

} // namespace

void registerEpipolar(const Device& device, const std::shared_ptr<NamedMesh>& mesh) {
    for (const Setting& setting :
         {Setting{"1 light, 512 cubed/depth maps, rectify and scan", 1, 512, Stage::All},
          Setting{"1 light, 512 cubed/depth maps and rectify", 1, 512, Stage::Rectify},
          Setting{"1 light, 512 cubed/scan", 1, 512, Stage::Scan},
          Setting{"64 lights, 128 cubed/depth maps, rectify and scan", 64, 128, Stage::All},
          Setting{"256 lights, 128 cubed/scan", 256, 128, Stage::Scan}})
        registerMethod(
            mesh->name + "/epipolar, " + setting.name,
            [=, &device](benchmark::State& state) { return run(state, device, mesh, setting); });
}

} // namespace lamina::bench
