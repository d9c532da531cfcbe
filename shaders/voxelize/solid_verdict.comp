// Judges the sums of crossing_check.glsl: is the mesh closed, and is its parity its solid?
// One invocation: some tens of words.
#include <voxelize/solid_tally.glsl>

layout(local_size_x = 1) in;

uvec2 laminaSum(int sum) {
    uvec2 total = uvec2(0u);
    for (int slot = 0; slot < LAMINA_SUM_SLOTS; ++slot) {
        int place = LAMINA_TALLY_SUMS + slot * LAMINA_SUM_STRIDE + sum;
        total += uvec2(laminaTally[place], laminaTally[place + 1]);
    }
    return total;
}

void main() {
    uvec2 crossings = laminaSum(LAMINA_SUM_CROSSINGS);
    uvec2 changes = laminaSum(LAMINA_SUM_CHANGES);
    bool isClosed = laminaSum(LAMINA_SUM_EDGES) == uvec2(0u);
    laminaTally[LAMINA_TALLY_CLOSED] = isClosed ? 1u : 0u;
    laminaTally[LAMINA_TALLY_CLEAN] = isClosed && (crossings == changes || crossings == -changes) ? 1u : 0u;
}
