// Sets every voxel that the enqueued triangles of one class meet (overlap_large.glsl).
// permute LAMINA_COVERAGE = LAMINA_COVERAGE_CONSERVATIVE LAMINA_COVERAGE_SEPARATING6
#include <voxelize/overlap_large.glsl>
#include <voxelize/overlap_bits.glsl>
