#include "voxelize/slicemap_calibration.hpp"

#include "gl/device_state.hpp"
#include "voxelize/slicemap_voxelizer.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <optional>

namespace lamina {
namespace {

/// Waves over the unit square, about as many columns a triangle as in a scanned mesh.
TriangleMesh makeWaves() {
    constexpr std::uint32_t kCells = 96;
    TriangleMesh mesh;
    for (std::uint32_t y = 0; y <= kCells; ++y)
        for (std::uint32_t x = 0; x <= kCells; ++x) {
            const glm::vec2 place = glm::vec2(x, y) / static_cast<float>(kCells);
            mesh.positions.emplace_back(place,
                                        0.5f + 0.4f * std::sin(9.0f * place.x + 7.0f * place.y));
        }
    for (std::uint32_t y = 0; y < kCells; ++y)
        for (std::uint32_t x = 0; x < kCells; ++x) {
            const std::uint32_t corner = y * (kCells + 1) + x;
            mesh.triangles.push_back({corner, corner + 1, corner + kCells + 1});
            mesh.triangles.push_back({corner + 1, corner + kCells + 2, corner + kCells + 1});
        }
    return mesh;
}

/// Least time of a few calls, in seconds.
std::optional<double> timeOf(const Device& device, VoxelStore store, const GeometrySource& source) {
    using Clock = std::chrono::steady_clock;
    const auto transform = GridTransform::box({{0, 0, 0}, {1, 1, 1}}, {256, 256, 1024});
    VoxelizerDesc desc;
    desc.backend = Backend::MrtSlicemap;
    desc.coverage = Coverage::Filled;
    desc.store = store;
    auto voxelizer = createSlicemapVoxelizer(device, desc);
    auto grid = VoxelGrid::create(device);
    if (!voxelizer || !grid || !transform)
        return std::nullopt;
    const auto& gl = device.state()->gl;
    std::optional<double> least;
    constexpr int kCalls = 4;
    for (int call = 0; call < kCalls; ++call) {
        const auto begin = Clock::now();
        if (!(*voxelizer)->voxelize({&source, 1}, *transform, *grid))
            return std::nullopt;
        gl.Finish();
        const double seconds = std::chrono::duration<double>(Clock::now() - begin).count();
        // The first call warms the device up.
        if (call > 0)
            least = std::min(least.value_or(seconds), seconds);
    }
    return least;
}

bool measure(const Device& device) {
    const auto buffers = MeshBuffers::upload(device, makeWaves());
    if (!buffers)
        return false;
    const GeometrySource source = buffers->view();
    const auto targets = timeOf(device, VoxelStore::Texture, source);
    const auto atomics = timeOf(device, VoxelStore::Buffer, source);
    return targets && atomics && *atomics < *targets;
}

} // namespace

VoxelStore fasterSlicemapStore(const Device& device) {
    std::optional<bool>& atomicsBeatTargets = device.state()->atomicsBeatTargets;
    if (!atomicsBeatTargets)
        atomicsBeatTargets = measure(device);
    return *atomicsBeatTargets ? VoxelStore::Buffer : VoxelStore::Texture;
}

} // namespace lamina
