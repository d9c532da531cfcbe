#pragma once

#include "request.hpp"
#include "run_record.hpp"

#include <lamina/core/triangle_mesh.hpp>

namespace lamina::tool {

/// Voxelizes the mesh with every backend and coverage that the device serves (or the coverage that
/// the request names), solids by every rule, each several times, and sets the results beside the
/// exact sets. Fills renderer and comparison of `record`, whose grid is planned and whose mesh is
/// inspected. Throws Failure.
void compareOnDevice(const Request& request, const TriangleMesh& mesh, StageClock& clock,
                     RunRecord& record);

} // namespace lamina::tool
