// After a round of sweeps: if it found nothing, the flood is complete, and the rounds that the host has
// issued already become empty dispatches. The mark of a change is left where the last round was one too
// few.
#include <voxelize/solid_tally.glsl>

layout(local_size_x = 1) in;

layout(location = 0) uniform int laminaDispatches;
layout(location = 1) uniform int laminaIsLast;

void main() {
    if (laminaTally[LAMINA_TALLY_CHANGED] == 0u) {
        for (int i = 0; i < laminaDispatches; ++i)
            laminaTally[LAMINA_TALLY_DISPATCHES + i * 4] = 0u;
    } else if (laminaIsLast == 0) {
        laminaTally[LAMINA_TALLY_CHANGED] = 0u;
    }
}
