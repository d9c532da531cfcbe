// Numbers that GLSL and C++ must agree on. Valid in both languages; include it, never copy from it.
#ifndef LAMINA_SHARED_CONSTANTS
#define LAMINA_SHARED_CONSTANTS

// Slices in one texture layer: the bits of a uvec4.
#define LAMINA_SLICES_PER_GROUP 128

// A depth fraction this close to a slice boundary counts as on it, so that rounding in the world
// transform cannot move a face that lies on a boundary to the wrong side (2^-40).
#define LAMINA_DEPTH_SNAP 9.094947017729282e-13

// Perspective triangles are cut at this fraction of the near depth, in front of every slice.
#define LAMINA_EYE_CUT 0.015625

// Capacity of LaminaGridBlock.boundaries: slices + 1 of a grid whose slices are not linear.
#define LAMINA_MAX_SLICE_BOUNDARIES 4032

// Both numbers of a near/far map's texel where the column is empty: the largest float.
#define LAMINA_EMPTY_COLUMN 3.4028234663852886e38

// Texture units from that of a grid's words to that of its near/far map, unless told otherwise.
#define LAMINA_GRID_DEFAULT_RANGE_UNIT 8

// LaminaGridConstants.size.w
#define LAMINA_GRID_PERSPECTIVE 1u
#define LAMINA_GRID_CUSTOM_SLICES 2u
#define LAMINA_GRID_LOCAL 4u

// LAMINA_COVERAGE
#define LAMINA_COVERAGE_SAMPLED 0
#define LAMINA_COVERAGE_FILLED 1
#define LAMINA_COVERAGE_CONSERVATIVE 2
#define LAMINA_COVERAGE_SEPARATING6 3
#define LAMINA_COVERAGE_SOLID 4

// Vertex attribute locations of MeshView sources.
#define LAMINA_ATTRIBUTE_POSITION 0
#define LAMINA_ATTRIBUTE_NORMAL 1
#define LAMINA_ATTRIBUTE_COLOR 2

// A captured vertex: its position alone, or also normal, colour and material id. Bytes.
#define LAMINA_CAPTURE_POSITION_BYTES 12
#define LAMINA_CAPTURE_NORMAL_OFFSET 12
#define LAMINA_CAPTURE_COLOR_OFFSET 24
#define LAMINA_CAPTURE_MATERIAL_OFFSET 40
#define LAMINA_CAPTURE_SURFACE_BYTES 44

// Uniform buffer binding of the voxelization passes.
#define LAMINA_DRAW_BLOCK_BINDING 0
#define LAMINA_PASS_GRID_BLOCK_BINDING 1
#define LAMINA_CLASS_BLOCK_BINDING 2

// Image unit of the near/far map, and storage buffer binding of the words, in slicemap passes.
#define LAMINA_RANGE_IMAGE_UNIT 1
#define LAMINA_WORDS_BINDING 7

// How a slicemap pass sorts triangles into grids (LaminaDrawConstants.pass.w).
#define LAMINA_SPLIT_FACING 0
#define LAMINA_SPLIT_CLASS 1

// Capacity of LaminaClassBlock: materials of a split by class.
#define LAMINA_MAX_CLASS_MATERIALS 4096
// Its entries: the grid, and which sides of a triangle the material's orientation rule takes.
#define LAMINA_CLASS_GRID 255u
#define LAMINA_CLASS_FRONT 256u
#define LAMINA_CLASS_BACK 512u

// Image unit of the parity of each column's crossings, a bit each.
#define LAMINA_COLUMN_PARITY_IMAGE 0

#endif
