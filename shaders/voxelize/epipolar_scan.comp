// Extrudes occlusion away from the light: a segmented inclusive OR scan along alpha, in place, of all
// shadow volumes of a grid in one dispatch ([WD13] 3.1.4).
//
// Launch: ceil(rows / LAMINA_EPIPOLAR_SCAN_ROWS) x phi groups x shadow volumes work groups. A work group
// owns that many rows of one layer of one tile; 16 invocations share a row:
//   1. each ORs its contiguous run of texels;
//   2. barrier: each reads the totals of the runs before its own;
//   3. each scans its run, starting from them.
// No segment flags are needed: a row of a tile is a segment, and no invocation leaves its tile.
#include <lamina/shared/epipolar_block.glsl>

layout(local_size_x = LAMINA_EPIPOLAR_SCAN_RUNS, local_size_y = LAMINA_EPIPOLAR_SCAN_ROWS) in;

layout(std430, binding = LAMINA_EPIPOLAR_PASS_SPACE_BINDING) readonly buffer LaminaEpipolarBlock {
    LaminaEpipolarSpace laminaEpipolarSpaces[];
};
layout(rgba32ui, binding = LAMINA_EPIPOLAR_PASS_WORD_IMAGE) uniform uimage2DArray laminaEpipolarImage;

shared uvec4 totals[LAMINA_EPIPOLAR_SCAN_ROWS][LAMINA_EPIPOLAR_SCAN_RUNS];

void main() {
    uint vsv = gl_WorkGroupID.z;
    uvec4 size = laminaEpipolarSpaces[vsv].size;
    uint row = gl_WorkGroupID.x * LAMINA_EPIPOLAR_SCAN_ROWS + gl_LocalInvocationID.y;
    uint run = gl_LocalInvocationID.x;
    uint length = (size.x + LAMINA_EPIPOLAR_SCAN_RUNS - 1u) / LAMINA_EPIPOLAR_SCAN_RUNS;
    uint first = min(run * length, size.x);
    uint end = row < size.y ? min(first + length, size.x) : first;
    ivec3 origin = ivec3(laminaEpipolarSpaces[vsv].tile.xy + uvec2(0u, row), gl_WorkGroupID.y);

    uvec4 bits = uvec4(0u);
    for (uint i = first; i < end; ++i)
        bits |= imageLoad(laminaEpipolarImage, origin + ivec3(i, 0, 0));
    totals[gl_LocalInvocationID.y][run] = bits;
    barrier();
    bits = uvec4(0u);
    for (uint i = 0u; i < run; ++i)
        bits |= totals[gl_LocalInvocationID.y][i];
    for (uint i = first; i < end; ++i) {
        bits |= imageLoad(laminaEpipolarImage, origin + ivec3(i, 0, 0));
        imageStore(laminaEpipolarImage, origin + ivec3(i, 0, 0), bits);
    }
}
