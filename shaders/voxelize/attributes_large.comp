// Adds up what the enqueued triangles of one class leave in set voxels
// (overlap_large.glsl, attribute_sums.glsl).
// permute LAMINA_GRID_BUFFER_STORE = 0 1
// permute LAMINA_ATTRIBUTE_COLORS = 0 1
#define LAMINA_COVERAGE LAMINA_COVERAGE_CONSERVATIVE
#include <voxelize/overlap_large.glsl>
#include <voxelize/attribute_sums.glsl>
