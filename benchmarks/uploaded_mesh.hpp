#pragma once

#include "bench_case.hpp"

#include <lamina/voxelize/geometry_source.hpp>

namespace lamina::bench {

/// A benchmark's mesh on the GPU.
struct UploadedMesh {
    const TriangleMesh* mesh = nullptr;
    MeshBuffers buffers;
    GeometrySource source;
};
[[nodiscard]] Result<UploadedMesh> upload(const Device& device, NamedMesh& named);

/// A Case on the GPU.
struct UploadedCase : UploadedMesh {
    GridTransform transform;
};
[[nodiscard]] Result<UploadedCase> upload(const Device& device, const Case& what);

} // namespace lamina::bench
