// The votes of the lines of one diagonal.
//
// One invocation owns one word of a row: 32 neighbouring lines, and those that take their bits over.
//   1. From the first slot to the last, each cell's signed crossings become the sum of those before the
//      cell's voxel. Where a line leaves the grid, its margin is left with the sum of the whole line,
//      and the next line begins.
//   2. Back again, each sum becomes votes (laminaVotes) in planes x and y, nothing in the margin. The
//      margin met last tells the line's total.
// No other invocation reads or writes its cells.
#include <voxelize/solid_cells.glsl>

layout(local_size_x = LAMINA_OVERLAP_GROUP_SIZE) in;

layout(std430, binding = LAMINA_SOLID_CELLS_BINDING) buffer LaminaSolidCells {
    uvec4 laminaCells[];
};

// Bits [low, high) of those from 0 to 31.
uint laminaBitRange(int low, int high) {
    low = clamp(low, 0, 32);
    high = clamp(high, 0, 32);
    if (low >= high)
        return 0u;
    return (0xffffffffu >> uint(32 - high)) & (0xffffffffu << uint(low));
}

// Which of the word's lines are inside the grid, from slot to slot. Outside along Q is a run of bits,
// cyclic, from the margin behind the last voxel to that before the first.
struct LaminaLinePlace {
    int p;     // The voxel along P, 0 in the margin.
    int begin; // Of the run, from the word's first bit on.
};

LaminaLinePlace laminaLinePlace(int row, int slot, int word) {
    int begin = laminaLine.grid.y + 1 - laminaLine.slope.y * slot + laminaLine.slope.w + laminaLine.period.y - word * 32;
    int p = row + laminaLine.slope.x * slot + laminaLine.slope.z;
    return LaminaLinePlace(p % laminaLine.period.x, begin % laminaLine.period.y);
}

int laminaWrapped(int value, int period) {
    return value < 0 ? value + period : value >= period ? value - period : value;
}

// The place one slot on (1) or back (-1).
void laminaMove(inout LaminaLinePlace place, int slots) {
    place.p = laminaWrapped(place.p + laminaLine.slope.x * slots, laminaLine.period.x);
    place.begin = laminaWrapped(place.begin - laminaLine.slope.y * slots, laminaLine.period.y);
}

uvec4 laminaBitsInGrid(LaminaLinePlace place, int slot) {
    if (slot < 1 || slot > laminaLine.grid.z || place.p < 1 || place.p > laminaLine.grid.x)
        return uvec4(0u);
    int period = laminaLine.period.y;
    int end = place.begin + period - laminaLine.grid.y;
    return uvec4(~(laminaBitRange(place.begin, end) | laminaBitRange(place.begin - period, end - period)));
}

void main() {
    uint index = (gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x) * LAMINA_OVERLAP_GROUP_SIZE + gl_LocalInvocationIndex;
    int word = int(index % uint(laminaLine.period.w));
    int row = int(index / uint(laminaLine.period.w)) + laminaLine.rows.x;
    if (row >= laminaLine.rows.x + laminaLine.rows.y)
        return;
    LaminaLinePlace place = laminaLinePlace(row, 0, word);
    uint cell = laminaCellIndex(row, 0, word);
    uvec4 before = uvec4(0u);
    for (int slot = 0; slot < laminaLine.period.z; ++slot) {
        uvec4 crossed = laminaCellCounts(laminaCells[cell]);
        if ((before | crossed) != uvec4(0u)) {
            uvec4 inGrid = laminaBitsInGrid(place, slot);
            laminaCells[cell] = before;
            before = laminaAddCounts(before & inGrid, crossed, 0u);
        }
        cell += uint(laminaLine.period.w);
        laminaMove(place, 1);
    }
    uvec4 total = uvec4(0u);
    for (int slot = laminaLine.period.z - 1; slot >= 0; --slot) {
        cell -= uint(laminaLine.period.w);
        laminaMove(place, -1);
        before = laminaCells[cell];
        if ((before | total) == uvec4(0u))
            continue;
        uvec4 inGrid = laminaBitsInGrid(place, slot);
        total = (total & inGrid) | (before & ~inGrid);
        uvec2 votes = laminaVotes(before, total) & inGrid.xy;
        laminaCells[cell].xy = votes;
    }
}
