#pragma once

#include "request.hpp"
#include "run_record.hpp"

#include <lamina/core/triangle_mesh.hpp>
#include <lamina/grid/attribute_grid.hpp>
#include <lamina/grid/bit_grid.hpp>

#include <optional>

namespace lamina::tool {

/// Voxels, and their attributes as far as they were asked for.
struct Voxels {
    BitGrid bits;
    std::optional<AttributeGrid> attributes;
};

/// The fastest rule that fits the mesh, whose report is known: parity is exact if inside and
/// outside are defined and parts cannot overlap.
[[nodiscard]] SolidRule fittingSolidRule(const MeshFacts& mesh);

/// Makes a context, voxelizes the mesh (given up as soon as the device has it) and brings the
/// voxels back; all device memory is free again after it. Fills renderer and voxels of `record`,
/// whose grid is planned. Throws Failure.
/// wanted: attributes to make, nothing automatic left.
[[nodiscard]] Voxels voxelizeOnDevice(const Request& request, const AttributeRequest& wanted,
                                      TriangleMesh mesh, StageClock& clock, RunRecord& record);

} // namespace lamina::tool
