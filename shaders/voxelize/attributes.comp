// Adds up what the triangles of a chunk leave in set voxels, or enqueues large triangles
// (overlap_small.glsl, attribute_sums.glsl).
// permute LAMINA_GRID_BUFFER_STORE = 0 1
// permute LAMINA_ATTRIBUTE_COLORS = 0 1
#define LAMINA_COVERAGE LAMINA_COVERAGE_CONSERVATIVE
#include <voxelize/overlap_small.glsl>
#include <voxelize/attribute_sums.glsl>
