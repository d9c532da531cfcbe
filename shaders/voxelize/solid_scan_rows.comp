// The votes of the lines along x or y.
//
// One invocation owns one word of a row: 32 neighbouring lines.
//   1. Adds up the touched cells: the signed crossings of the whole lines.
//   2. From the first slot to the last, adds up those before each voxel, and votes (laminaVotes). Slots
//      without votes and touched cells are skipped, 32 at a time. The last part leaves the cells zero.
// No other invocation reads or writes its cells or votes for its voxels.
#include <voxelize/solid_axis.glsl>

void main() {
    uint index = (gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x) * LAMINA_OVERLAP_GROUP_SIZE + gl_LocalInvocationIndex;
    int word = int(index % uint(laminaLine.period.w));
    int row = int(index / uint(laminaLine.period.w)) + laminaLine.rows.x;
    if (row >= laminaLine.rows.x + laminaLine.rows.y)
        return;
    // Steps whose voxels lie in the part.
    bool isAlongX = laminaLine.rows.z == LAMINA_SOLID_ALONG_X;
    int begin = isAlongX ? 0 : laminaPart.low.y;
    int end = isAlongX ? laminaLine.grid.z : laminaPart.high.y + 1;
    bool isInPart = word >= laminaPart.low.z >> 5 && word <= laminaPart.high.z >> 5 &&
                    (!isAlongX || (row >= laminaPart.low.y && row <= laminaPart.high.y));
    if (!isInPart) {
        begin = end;
        if (laminaIsLastPart == 0)
            return;
    }
    uint touchedIndex = laminaTouchedIndex(row, word);
    uint firstCell = laminaCellIndex(row, 0, word);
    uvec4 total = uvec4(0u);
    for (int run = 0; run < laminaLine.rows.w; ++run)
        for (uint touched = laminaTouched[touchedIndex + uint(run)]; touched != 0u; touched &= touched - 1u) {
            uint slot = uint(run * 32 + findLSB(touched));
            total = laminaAddCounts(total, laminaCellCounts(laminaCells[firstCell + slot * uint(laminaLine.period.w)]), 0u);
        }
    if (total != uvec4(0u))
        laminaTally[LAMINA_TALLY_CLOSED] = 0u;
    uvec4 before = uvec4(0u);
    uvec2 votes = laminaVotes(before, total);
    for (int run = 0; run < laminaLine.rows.w; ++run) {
        uint touched = laminaTouched[touchedIndex + uint(run)];
        if (touched == 0u && votes == uvec2(0u))
            continue;
        if (touched != 0u && laminaIsLastPart != 0)
            laminaTouched[touchedIndex + uint(run)] = 0u;
        int firstSlot = run * 32;
        for (int slot = firstSlot; slot < min(firstSlot + 32, laminaLine.period.z); ++slot) {
            if (((touched >> uint(slot - firstSlot)) & 1u) != 0u) {
                uint cell = firstCell + uint(slot * laminaLine.period.w);
                before = laminaAddCounts(before, laminaCellCounts(laminaCells[cell]), 0u);
                votes = laminaVotes(before, total);
                if (laminaIsLastPart != 0)
                    laminaCells[cell] = uvec4(0u);
            }
            // The slot's crossings lie before the voxel of the same number.
            if (votes != uvec2(0u) && slot >= begin && slot < end)
                laminaAddVotes(isAlongX ? laminaPlaneWord(slot, row, word) : laminaPlaneWord(row, slot, word), votes);
        }
    }
}
