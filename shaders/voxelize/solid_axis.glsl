// The cells of one axis and the votes of its lines, word by word of the part; for
// solid_scan_rows.comp and solid_scan_columns.comp.
#include <voxelize/solid_part.glsl>
#include <voxelize/solid_cells.glsl>
#include <voxelize/solid_tally.glsl>

layout(std430, binding = LAMINA_SOLID_CELLS_BINDING) buffer LaminaSolidCells {
    uvec4 laminaCells[];
};
layout(std430, binding = LAMINA_SOLID_TOUCHED_BINDING) buffer LaminaSolidTouched {
    uint laminaTouched[];
};
layout(std430, binding = LAMINA_SOLID_VOTES_BINDING) buffer LaminaVotePlane {
    uint laminaVotes[];
} laminaVotePlanes[3];

layout(location = 0) uniform int laminaIsLastPart; // Which leaves the cells zero.

// Index of a word of the part in a plane; x, y and word of the whole grid.
uint laminaPlaneWord(int x, int y, int word) {
    return laminaPartIndex(x, y - laminaPart.low.y, (word >> 2) - (laminaPart.low.z >> 7)) * 4u + uint(word & 3);
}

// Adds the votes of both ends of a line. No other invocation has votes for the word.
void laminaAddVotes(uint index, uvec2 votes) {
    uint carry = votes.x & votes.y;
    uint one = votes.x ^ votes.y;
    if (one != 0u) {
        uint plane = laminaVotePlanes[0].laminaVotes[index];
        laminaVotePlanes[0].laminaVotes[index] = plane ^ one;
        // Two votes, or one and one from before: never both.
        carry |= plane & one;
    }
    uint plane = laminaVotePlanes[1].laminaVotes[index];
    laminaVotePlanes[1].laminaVotes[index] = plane ^ carry;
    carry &= plane;
    if (carry != 0u)
        laminaVotePlanes[2].laminaVotes[index] ^= carry;
}
