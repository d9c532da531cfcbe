#pragma once

#include "request.hpp"
#include "run_record.hpp"

#include <lamina/core/triangle_mesh.hpp>
#include <lamina/grid/bit_grid.hpp>

namespace lamina::tool {

/// Makes a context, voxelizes the mesh (given up as soon as the device has it) and brings the
/// voxels back; all device memory is free again after it. Fills renderer and voxels of `record`,
/// whose grid is planned. Throws Failure.
[[nodiscard]] BitGrid voxelizeOnDevice(const Request& request, TriangleMesh mesh, StageClock& clock,
                                       RunRecord& record);

} // namespace lamina::tool
