// Fills the inside: each voxel becomes the parity of the crossings beyond its centre.
//
// One invocation owns one column of the part. From the last word to the first: a suffix XOR within the
// word by shifts, inverted if the words behind it hold an odd number of crossings. A part needs no
// other: crossings beyond it were toggled in its last slice.
#include <voxelize/overlap_source.glsl>
#include <voxelize/solid_columns.glsl>

void main() {
    uint column = (gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x) * LAMINA_OVERLAP_GROUP_SIZE +
                  gl_LocalInvocationIndex;
    int x = int(column % laminaOverlap.grid.x);
    int y = int(column / laminaOverlap.grid.x) + laminaOverlap.low.y;
    if (y > laminaOverlap.high.y)
        return;
    uint carry = 0u;
    for (int word = laminaOverlap.high.z >> 5; word >= laminaOverlap.low.z >> 5; --word) {
        uint index = laminaWordIndex(x, y, word);
        uint bits = laminaWords[index];
        if (bits == 0u && carry == 0u)
            continue;
        bits ^= bits >> 1;
        bits ^= bits >> 2;
        bits ^= bits >> 4;
        bits ^= bits >> 8;
        bits ^= bits >> 16;
        bits ^= 0u - carry;
        laminaWords[index] = bits;
        carry = bits & 1u;
    }
    if (laminaOverlap.low.z != 0)
        return;
    uint place = uint(y) * laminaOverlap.grid.x + uint(x);
    uint before = (laminaCrossedBefore[place >> 5] >> (place & 31u)) & 1u;
    if (carry != before)
        atomicAdd(laminaOddColumns, 1u);
}
