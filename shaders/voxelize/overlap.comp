// Sets every voxel that the triangles of a chunk meet, or enqueues large triangles (overlap_small.glsl).
// permute LAMINA_COVERAGE = LAMINA_COVERAGE_CONSERVATIVE LAMINA_COVERAGE_SEPARATING6
#include <voxelize/overlap_small.glsl>
#include <voxelize/overlap_bits.glsl>
