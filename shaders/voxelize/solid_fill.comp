// Fills the inside: each voxel becomes the parity of the crossings beyond its centre.
//
// One invocation owns one column of the part. From the last word to the first: a suffix XOR within the
// word by shifts, inverted if the words behind it hold an odd number of crossings. A part needs no
// other: crossings beyond it were toggled in its last slice. Then counts the column if it is odd or, with
// crossings that are checked, adds its changes to the sums of crossing_check.glsl.
// permute LAMINA_CROSSINGS = LAMINA_CROSSINGS_PARITY LAMINA_CROSSINGS_CHECKED
#include <voxelize/overlap_source.glsl>
#include <voxelize/solid_columns.glsl>
#include <voxelize/crossing_check.glsl>
#if LAMINA_CROSSINGS == LAMINA_CROSSINGS_CHECKED

// The changes at the toggled slices of a word: those of set voxels end a run of them.
uvec2 laminaChanges(int x, int y, int word, uint toggled, uint bits) {
    uvec2 sum = uvec2(0u);
    for (; toggled != 0u; toggled &= toggled - 1u) {
        int bit = findLSB(toggled);
        uvec2 number = laminaPlaceNumber(x, y, word * 32 + bit);
        sum += ((bits >> uint(bit)) & 1u) != 0u ? -number : number;
    }
    return sum;
}
#endif

void main() {
    uint column = (gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x) * LAMINA_OVERLAP_GROUP_SIZE +
                  gl_LocalInvocationIndex;
    int x = int(column % laminaOverlap.grid.x);
    int y = int(column / laminaOverlap.grid.x) + laminaOverlap.low.y;
    if (y > laminaOverlap.high.y)
        return;
    uint carry = 0u;
#if LAMINA_CROSSINGS == LAMINA_CROSSINGS_CHECKED
    uvec2 changes = uvec2(0u);
#endif
    for (int word = laminaOverlap.high.z >> 5; word >= laminaOverlap.low.z >> 5; --word) {
        uint index = laminaWordIndex(x, y, word);
        uint bits = laminaWords[index];
        if (bits == 0u && carry == 0u)
            continue;
        uint toggled = bits;
        bits ^= bits >> 1;
        bits ^= bits >> 2;
        bits ^= bits >> 4;
        bits ^= bits >> 8;
        bits ^= bits >> 16;
        bits ^= 0u - carry;
        laminaWords[index] = bits;
        carry = bits & 1u;
#if LAMINA_CROSSINGS == LAMINA_CROSSINGS_CHECKED
        changes += laminaChanges(x, y, word, toggled, bits);
#endif
    }
#if LAMINA_CROSSINGS == LAMINA_CROSSINGS_CHECKED
    if (carry != 0u)
        changes += laminaPlaceNumber(x, y, laminaOverlap.low.z - 1);
    laminaAddSum(LAMINA_SUM_CHANGES, column, changes);
#else
    if (laminaOverlap.low.z != 0)
        return;
    uint place = uint(y) * laminaOverlap.grid.x + uint(x);
    uint before = (laminaCrossedBefore[place >> 5] >> (place & 31u)) & 1u;
    if (carry != before)
        atomicAdd(laminaOddColumns, 1u);
#endif
}
