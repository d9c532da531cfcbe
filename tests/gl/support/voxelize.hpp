#pragma once

#include <lamina/voxelize/voxelizer.hpp>

#include <gtest/gtest.h>

#include <span>

namespace lamina::test {

/// The voxels of `sources` by a new voxelizer and grid; an error fails the test.
inline BitGrid voxelize(const Device& device, const VoxelizerDesc& desc,
                        std::span<const GeometrySource> sources, const GridTransform& transform) {
    auto voxelizer = Voxelizer::create(device, desc).value();
    auto grid = VoxelGrid::create(device).value();
    const auto stats = voxelizer->voxelize(sources, transform, grid);
    EXPECT_TRUE(stats) << stats.error().text;
    return stats ? grid.download().value() : BitGrid::create(transform).value();
}

inline BitGrid voxelize(const Device& device, const VoxelizerDesc& desc, const TriangleMesh& mesh,
                        const GridTransform& transform, const glm::mat4& model = glm::mat4(1.0f)) {
    auto buffers = MeshBuffers::upload(device, mesh).value();
    const GeometrySource source = buffers.view(model);
    return voxelize(device, desc, {&source, 1}, transform);
}

} // namespace lamina::test
