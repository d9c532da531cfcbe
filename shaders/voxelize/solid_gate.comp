// Makes the diagonals' dispatches empty if no voxel is contested. An invocation for each of them.
#include <voxelize/solid_tally.glsl>

layout(local_size_x = LAMINA_OVERLAP_GROUP_SIZE) in;

layout(location = 0) uniform int laminaFirst;
layout(location = 1) uniform int laminaCount;

void main() {
    int i = int(gl_GlobalInvocationID.x);
    if (i < laminaCount && laminaTally[LAMINA_TALLY_CONTESTED] == 0u)
        laminaTally[LAMINA_TALLY_DISPATCHES + (laminaFirst + i) * 4] = 0u;
}
