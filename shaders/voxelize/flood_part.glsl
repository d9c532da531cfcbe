// A flood of the outside: the words of the grid hold the surface, a second buffer of the same shape what
// has been reached so far. It spreads through faces of voxels that the surface does not touch, by
// sweeps along the axes, each word-parallel.
#include <voxelize/solid_part.glsl>
#include <voxelize/solid_tally.glsl>

layout(std430, binding = LAMINA_FLOOD_OUTSIDE_BINDING) buffer LaminaOutside {
    uvec4 laminaOutside[];
};
