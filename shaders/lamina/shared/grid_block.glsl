// Layout of the uniform buffer that describes one grid (std140). Valid GLSL and C++.
#ifndef LAMINA_SHARED_GRID_BLOCK
#define LAMINA_SHARED_GRID_BLOCK

#include <lamina/shared/constants.glsl>

struct LaminaGridConstants {
    // Rows of the affine map from world (x,y,z,1) to (column x * w, column y * w, depth); w is the
    // depth in a perspective grid and 1 in an orthographic one.
    vec4 worldToColumn[3];
    // near depth, far depth, 1 / (far - near), slices.
    vec4 depthRange;
    // columns x, columns y, slices, LAMINA_GRID_* flags.
    uvec4 size;
};

// The same in double precision, for the voxelization passes.
struct LaminaDrawConstants {
    // Rows of the map from the source's local space to (column x * w, column y * w, depth).
    dvec4 localToColumn[3];
    // near depth, 1 / (far - near), near depth * LAMINA_EYE_CUT, slices.
    dvec4 depthRange;
    // Depth interval of the slices of this pass, widened by a rounding allowance; number of the
    // slices of this pass; words from the storage binding's start, which is aligned, to the pass's.
    dvec4 passDepths;
    // columns x, columns y, slices, LAMINA_GRID_* flags.
    uvec4 size;
    // First slice of this pass, material id, number of grids that the triangles are split among,
    // LAMINA_SPLIT_*.
    uvec4 pass;
    // Distance in pixels by which triangles are dilated before rasterization; 1 where a triangle
    // that turns counter-clockwise in columns is a front, -1 where it is a back; unused.
    vec4 dilation;
};

#endif
