#pragma once

#include "request.hpp"
#include "run_record.hpp"

#include <lamina/gl/device.hpp>
#include <lamina/grid/voxel_grid.hpp>
#include <lamina/headless/context.hpp>

namespace lamina::tool {

/// A context of the kind that the request names, and Lamina's device on it.
struct OpenDevice {
    headless::Context context;
    Device device;

    /// Waits for the GPU, so that the time of a stage is what it cost.
    void wait() const;
};

/// Fills renderer of `record`. `clock` must outlive the result. Throws Failure.
[[nodiscard]] OpenDevice openDevice(const Request& request, StageClock& clock, RunRecord& record);

/// The voxels of a grid as files and pictures can hold them: columns with ranges of their own are
/// resampled into as many slices of the whole range. Waits for the GPU. Throws Failure.
[[nodiscard]] BitGrid downloadUniform(const VoxelGrid& grid);

} // namespace lamina::tool
