#pragma once

#include "voxelize/overlap_constants.hpp"
#include "voxelize/triangle_capture.hpp"

#include <lamina/voxelize/voxelizer.hpp>

#include <span>
#include <vector>

namespace lamina {

/// Triangles in buffers that compute shaders can read.
struct OverlapSource {
    glm::dmat4 localToGrid{1.0};
    glm::dmat3 normalToWorld{1.0};
    MeshView view; ///< Its model matrix is part of localToGrid.
    std::uint64_t triangles = 0;
    CaptureContent content = CaptureContent::Positions; ///< Which streams the shaders read.
    bool hasVertexMaterials = false;                    ///< Captured: an id follows each colour.

    /// Fills in what the shaders need to know of a chunk of the triangles.
    void write(std::uint64_t firstTriangle, std::uint64_t count, std::uint64_t alignment,
               shared::LaminaOverlapConstants& block) const;
    /// Binds the buffers of that chunk.
    void bind(const gl::DeviceState& device, std::uint64_t firstTriangle,
              std::uint64_t count) const;

private:
    void writeSurface(std::uint64_t firstTriangle, std::uint64_t count, std::uint64_t alignment,
                      shared::LaminaOverlapConstants& block) const;
};

/// Turns the sources of a voxelize() call into such triangles.
class OverlapSources {
public:
    OverlapSources(std::shared_ptr<gl::DeviceState> device, CaptureContent content)
        : mDevice(device)
        , mContent(content)
        , mCapture(std::move(device), content) {}

    /// Checks all sources, then captures those that need it. Counts triangles in `stats`.
    /// Errors: as Voxelizer::voxelize().
    [[nodiscard]] Result<std::vector<OverlapSource>>
    prepare(std::span<const GeometrySource> sources, const GridTransform& transform,
            VoxelizeStats& stats);

private:
    std::shared_ptr<gl::DeviceState> mDevice;
    CaptureContent mContent;
    TriangleCapture mCapture;
};

} // namespace lamina
