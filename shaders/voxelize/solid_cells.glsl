// Cells: signed counts of crossings along the lines of one direction, 32 numbers modulo 16 to a cell, in
// four bit planes. The planes weigh 1, -2, 4, -8: adding 1 to 0 then changes one plane, subtracting two.
//
// A cell belongs to a row, a slot and a word. Along x and y, the slot is the step along the line plus 1,
// and the row and the bits are the line itself, so counting along it is word-parallel. For the diagonals
// row and bits are (p, q) modulo the grid's periods: a line keeps them from step to step, and the table
// is no larger than the grid with a margin of a voxel, because a row takes up the next line where one
// has left the grid. The margin holds what a line crosses before its first and after its last voxel.
// Along z, the row and the slot are the column, and the bits are the steps plus 1.
//
// Of the axes' cells few are not zero. A bit for each, in a run of words for each row and word (along z:
// column), tells which have been touched. All cells and bits are zero between two calls.
#include <lamina/shared/solid_block.glsl>

layout(std140, binding = LAMINA_SOLID_LINE_BINDING) uniform LaminaSolidLineBlock {
    LaminaSolidLine laminaLine;
};

// Row, slot and bit of the voxel at P, Q and step s; each may lie one outside the grid.
ivec3 laminaCellPlace(int p, int q, int s) {
    int slot = s + 1;
    if (laminaLine.rows.z == LAMINA_SOLID_ALONG_Z)
        return ivec3(p, q, slot);
    if (laminaLine.slope.xy == ivec2(0))
        return ivec3(p, slot, q);
    ivec2 line = ivec2(p, q) + 1 - laminaLine.slope.xy * slot + laminaLine.slope.zw;
    return ivec3(line.x % laminaLine.period.x, slot, line.y % laminaLine.period.y);
}

// The row must be one that the binding holds.
uint laminaCellIndex(int row, int slot, int word) {
    uint place = uint(row - laminaLine.rows.x) * uint(laminaLine.period.z) + uint(slot);
    return place * uint(laminaLine.period.w) + uint(word);
}

// The run of touched bits of a row and a word or, along z, a slot.
uint laminaTouchedIndex(int row, int slotOrWord) {
    int perRow = laminaLine.rows.z == LAMINA_SOLID_ALONG_Z ? laminaLine.period.z : laminaLine.period.w;
    return (uint(row - laminaLine.rows.x) * uint(perRow) + uint(slotOrWord)) * uint(laminaLine.rows.w);
}

// a + b + carry in each of 32 numbers modulo 16; carry: a bit for each.
uvec4 laminaAddCounts(uvec4 a, uvec4 b, uint carry) {
    uvec4 either = a ^ b;
    uvec4 both = a & b;
    uvec4 sum;
    sum.x = either.x ^ carry;
    carry = both.x | (either.x & carry);
    sum.y = either.y ^ carry;
    carry = both.y | (either.y & carry);
    sum.z = either.z ^ carry;
    carry = both.z | (either.z & carry);
    sum.w = either.w ^ carry;
    return sum;
}

// The counts of a cell in planes that weigh 1, 2, 4, 8.
uvec4 laminaCellCounts(uvec4 cell) {
    return laminaAddCounts(uvec4(cell.x, 0u, cell.z, 0u), ~uvec4(0u, cell.y, 0u, cell.w), 0xffffffffu);
}

// The two votes of a line on 32 voxels, from the signed crossings before the centres and on the whole
// line. A ray votes for inside if what it crosses does not cancel (non-zero winding). A line whose
// crossings come in pairs but do not cancel has met triangles of the wrong orientation: there signs say
// nothing, and parity decides.
uvec2 laminaVotes(uvec4 before, uvec4 total) {
    uvec4 beyond = laminaAddCounts(total, ~before, 0xffffffffu);
    uint byParity = (total.y | total.z | total.w) & ~total.x;
    uint first = before.x | (~byParity & (before.y | before.z | before.w));
    uint second = beyond.x | (~byParity & (beyond.y | beyond.z | beyond.w));
    return uvec2(first, second);
}
