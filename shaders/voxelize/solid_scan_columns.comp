// solid_scan.comp for the direction along the words of the grid, z.
//
// One invocation owns one column.
//   1. From the first word to the last, each number becomes the sum of all before it: within a word by
//      doubling shifts, from word to word by a carry.
//   2. Again, each sum becomes votes.
#include <voxelize/solid_cells.glsl>

layout(local_size_x = LAMINA_OVERLAP_GROUP_SIZE) in;

layout(std430, binding = LAMINA_SOLID_CELLS_BINDING) buffer LaminaSolidCells {
    uvec4 laminaCells[];
};

// All bits of each plane as its last bit.
uvec4 laminaLastOfWord(uvec4 counts) {
    return uvec4(0u) - (counts >> 31);
}

void main() {
    uint index = (gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x) * LAMINA_OVERLAP_GROUP_SIZE + gl_LocalInvocationIndex;
    int slot = int(index % uint(laminaLine.period.z));
    int row = int(index / uint(laminaLine.period.z)) + laminaLine.rows.x;
    if (row >= laminaLine.rows.x + laminaLine.rows.y)
        return;
    uvec4 carry = uvec4(0u);
    for (int word = 0; word < laminaLine.period.w; ++word) {
        uint cell = laminaCellIndex(row, slot, word);
        uvec4 sums = laminaCells[cell];
        if (sums == uvec4(0u)) {
            laminaCells[cell] = carry;
            continue;
        }
        for (int shift = 1; shift < 32; shift *= 2)
            sums = laminaAddCounts(sums, sums << shift, 0u);
        laminaCells[cell] = laminaAddCounts(sums << 1, carry, 0u);
        carry = laminaAddCounts(laminaLastOfWord(sums), carry, 0u);
    }
    for (int word = 0; word < laminaLine.period.w; ++word) {
        uint cell = laminaCellIndex(row, slot, word);
        laminaCells[cell].xy = laminaVotes(laminaCells[cell], carry);
    }
}
