#pragma once

#include <lamina/area_light/light_source.hpp>
#include <lamina/core/triangle_mesh.hpp>
#include <lamina/grid/grid_transform.hpp>

#include <vector>

/// Scenes of a large light in fog, for tests and tables of accuracy.
namespace lamina::reference {

struct FogStudy {
    const char* name;
    TriangleMesh mesh;
    GridCamera camera;
    RectangleLight light;
    Medium medium;
};

/// "fence": thin bars before a television at the upper edge of the screen. "columns": a row of
/// round columns, the light beside the screen. "foliage": a tree of some thousand leaves under a
/// light from above.
[[nodiscard]] std::vector<FogStudy> makeFogStudies();

} // namespace lamina::reference
