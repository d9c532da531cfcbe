// The votes of the lines along the words of the grid, z.
//
// One invocation owns one column.
//   1. Adds up the touched cells: the signed crossings of the whole line.
//   2. From the first word to the last, each number becomes the sum of those up to it, which lie before
//      its voxel's centre: within a word by doubling shifts, from word to word by a carry. The sums
//      vote. The last part leaves the cells zero.
// No other invocation reads or writes its cells or votes for its voxels.
#include <voxelize/solid_axis.glsl>

// All bits of each plane as its last bit.
uvec4 laminaLastOfWord(uvec4 counts) {
    return uvec4(0u) - (counts >> 31);
}

uvec4 laminaSumsOfWord(uvec4 counts) {
    for (int shift = 1; shift < 32; shift *= 2)
        counts = laminaAddCounts(counts, counts << shift, 0u);
    return counts;
}

// The sum of the 32 numbers, in all bits.
uvec4 laminaTotalOfWord(uvec4 counts) {
    uint sum = uint(bitCount(counts.x) + 2 * bitCount(counts.y) + 4 * bitCount(counts.z) + 8 * bitCount(counts.w));
    return uvec4(0u) - ((uvec4(sum) >> uvec4(0, 1, 2, 3)) & 1u);
}

// Of slices of the grid, in a word.
uint laminaSlicesOfWord(int word) {
    int slices = laminaLine.grid.z - word * 32;
    return slices >= 32 ? 0xffffffffu : slices <= 0 ? 0u : 0xffffffffu >> uint(32 - slices);
}

void main() {
    uint index = (gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x) * LAMINA_OVERLAP_GROUP_SIZE + gl_LocalInvocationIndex;
    int slot = int(index % uint(laminaLine.period.z));
    int row = int(index / uint(laminaLine.period.z)) + laminaLine.rows.x;
    if (row >= laminaLine.rows.x + laminaLine.rows.y)
        return;
    int begin = laminaPart.low.z >> 5;
    int end = (laminaPart.high.z >> 5) + 1;
    if (row < laminaPart.low.y || row > laminaPart.high.y) {
        begin = end;
        if (laminaIsLastPart == 0)
            return;
    }
    uint touchedIndex = laminaTouchedIndex(row, slot);
    uint firstCell = laminaCellIndex(row, slot, 0);
    uvec4 total = uvec4(0u);
    for (int run = 0; run < laminaLine.rows.w; ++run)
        for (uint touched = laminaTouched[touchedIndex + uint(run)]; touched != 0u; touched &= touched - 1u) {
            uint word = uint(run * 32 + findLSB(touched));
            total = laminaAddCounts(total, laminaTotalOfWord(laminaCellCounts(laminaCells[firstCell + word])), 0u);
        }
    if (total != uvec4(0u))
        laminaTally[LAMINA_TALLY_CLOSED] = 0u;
    uvec4 carry = uvec4(0u);
    for (int word = 0; word < laminaLine.period.w; ++word) {
        uint touchedWord = touchedIndex + uint(word >> 5);
        bool isTouched = ((laminaTouched[touchedWord] >> uint(word & 31)) & 1u) != 0u;
        uvec4 before = carry;
        if (isTouched) {
            uvec4 sums = laminaSumsOfWord(laminaCellCounts(laminaCells[firstCell + uint(word)]));
            before = laminaAddCounts(sums, carry, 0u);
            carry = laminaLastOfWord(before);
            if (laminaIsLastPart != 0)
                laminaCells[firstCell + uint(word)] = uvec4(0u);
        }
        if (word < begin || word >= end)
            continue;
        uvec2 votes = laminaVotes(before, total) & laminaSlicesOfWord(word);
        if (votes != uvec2(0u))
            laminaAddVotes(laminaPlaneWord(slot, row, word), votes);
    }
    if (laminaIsLastPart != 0)
        for (int run = 0; run < laminaLine.rows.w; ++run)
            laminaTouched[touchedIndex + uint(run)] = 0u;
}
