// Adds the votes of one direction to those of the voxels: of all, or, for a diagonal, of the contested.
//
// One invocation owns one texel of the grid. Its votes of either end stand in a run of cells, one more
// than it has words because cells have a margin; they are added to counts of four bits, whose planes
// are the three vote buffers and, the highest, the grid itself: a majority is there when the last
// direction has voted.
// permute LAMINA_SOLID_VOTERS = LAMINA_SOLID_VOTERS_AXES LAMINA_SOLID_VOTERS_DIAGONALS
#include <voxelize/solid_tiles.glsl>
#include <voxelize/solid_cells.glsl>

layout(std430, binding = LAMINA_SOLID_CELLS_BINDING) readonly buffer LaminaSolidCells {
    uvec4 laminaCells[];
};
layout(std430, binding = LAMINA_SOLID_VOTES_BINDING) buffer LaminaVotePlane {
    uvec4 laminaVotes[];
} laminaVotePlanes[3];

layout(std430, binding = LAMINA_SOLID_CONTESTED_BINDING) readonly buffer LaminaContested {
    uvec4 laminaContested[];
};

// The votes of each end on the four words from this place on.
void laminaGatherVotes(ivec3 start, out uvec4 first, out uvec4 second) {
    first = uvec4(0u);
    second = uvec4(0u);
    int word = start.z >> 5;
    int shift = start.z & 31;
    uint row = laminaCellIndex(start.x, start.y, 0);
    uvec2 low = laminaCells[row + uint(word)].xy;
    for (int i = 0; i < 4; ++i) {
        if (++word == laminaLine.period.w)
            word = 0;
        uvec2 high = laminaCells[row + uint(word)].xy;
        // A shift by 32 is undefined: in two steps.
        uvec2 votes = (low >> shift) | ((high << (31 - shift)) << 1);
        first[i] = votes.x;
        second[i] = votes.y;
        low = high;
    }
}

void main() {
    ivec3 place;
#if LAMINA_SOLID_VOTERS == LAMINA_SOLID_VOTERS_AXES
    if (!laminaPartPlace(place))
        return;
#else
    if (!laminaTilePlace(place))
        return;
#endif
    ivec3 voxel = laminaPart.low.xyz + ivec3(place.xy, place.z * 128);
    ivec3 pqs = laminaLine.rows.z == LAMINA_SOLID_ALONG_X ? voxel.yzx : laminaLine.rows.z == LAMINA_SOLID_ALONG_Y ? voxel.xzy : voxel.yxz;
    ivec3 start = laminaCellPlace(pqs.x, pqs.y, pqs.z);
    if (start.x < laminaLine.rows.x || start.x >= laminaLine.rows.x + laminaLine.rows.y)
        return;
    uvec4 first, second;
    laminaGatherVotes(start, first, second);
    uint index = laminaPartIndex(place.x, place.y, place.z);
#if LAMINA_SOLID_VOTERS == LAMINA_SOLID_VOTERS_AXES
    uvec4 voters = laminaSliceBits(place.z);
#else
    uvec4 voters = laminaContested[index];
#endif
    first &= voters;
    second &= voters;
    if ((first | second) == uvec4(0u))
        return;
    uvec4 plane = laminaVotePlanes[0].laminaVotes[index];
    laminaVotePlanes[0].laminaVotes[index] = plane ^ first ^ second;
    // Two votes, or one and one from before: never both.
    uvec4 carry = (first & second) | (plane & (first ^ second));
    plane = laminaVotePlanes[1].laminaVotes[index];
    laminaVotePlanes[1].laminaVotes[index] = plane ^ carry;
    carry &= plane;
    plane = laminaVotePlanes[2].laminaVotes[index];
    laminaVotePlanes[2].laminaVotes[index] = plane ^ carry;
#if LAMINA_SOLID_VOTERS == LAMINA_SOLID_VOTERS_DIAGONALS
    laminaTexels[index] ^= carry & plane;
#endif
}
