// A sweep of the flood along x (laminaAlong 0) or y (1) and back.
//
// One invocation owns the texels of one row in one layer, and carries the 128 voxels reached last on to
// the next column. Rows along x are numbered by y, rows along y by x.
#include <voxelize/flood_part.glsl>

layout(location = 0) uniform int laminaAlong;

void main() {
    ivec3 counts = laminaPartCounts();
    int row = int(gl_GlobalInvocationID.x);
    int layer = int(gl_GlobalInvocationID.y);
    if (row >= (laminaAlong == 0 ? counts.y : counts.x))
        return;
    int steps = laminaAlong == 0 ? counts.x : counts.y;
    uint stride = laminaAlong == 0 ? 1u : uint(counts.x);
    uint index = laminaAlong == 0 ? laminaPartIndex(0, row, layer) : laminaPartIndex(row, 0, layer);
    uvec4 slices = laminaSliceBits(layer);
    bool changed = false;
    for (int direction = 0; direction < 2; ++direction) {
        uvec4 carry = uvec4(0u);
        for (int i = 0; i < steps; ++i) {
            uvec4 found = laminaOutside[index];
            uvec4 reached = found;
            // What was reached is open.
            uvec4 candidates = carry & ~found;
            if (candidates != uvec4(0u)) {
                reached |= candidates & ~laminaTexels[index] & slices;
                if (reached != found) {
                    laminaOutside[index] = reached;
                    changed = true;
                }
            }
            carry = reached;
            // Back begins where the way there ended.
            if (i + 1 < steps)
                index += stride;
        }
        stride = 0u - stride;
    }
    // Whoever writes it writes the same.
    if (changed)
        laminaTally[LAMINA_TALLY_CHANGED] = 1u;
}
