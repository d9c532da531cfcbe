// Makes dispatches empty that a word of the tally says are not needed. An invocation for each of them.
#include <voxelize/solid_tally.glsl>

layout(local_size_x = LAMINA_OVERLAP_GROUP_SIZE) in;

layout(location = 0) uniform int laminaFirst;
layout(location = 1) uniform int laminaCount;
layout(location = 2) uniform int laminaWord;  // Of the tally (LAMINA_TALLY_*).
layout(location = 3) uniform int laminaNeeded; // 1: they are needed if it is not 0; 0: if it is.

void main() {
    int i = int(gl_GlobalInvocationID.x);
    bool isNeeded = (laminaTally[laminaWord] != 0u) == (laminaNeeded != 0);
    if (i < laminaCount && !isNeeded)
        laminaTally[LAMINA_TALLY_DISPATCHES + (laminaFirst + i) * 4] = 0u;
}
