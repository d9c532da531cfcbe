// Adds the votes of one diagonal to those of the contested voxels.
//
// One invocation owns one texel of a listed tile. Its votes of either end stand in a run of cells, one
// more than it has words because cells have a margin.
#include <voxelize/solid_tiles.glsl>
#include <voxelize/solid_cells.glsl>

layout(std430, binding = LAMINA_SOLID_CELLS_BINDING) readonly buffer LaminaSolidCells {
    uvec4 laminaCells[];
};
#include <voxelize/solid_votes.glsl>
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
    if (!laminaTilePlace(place))
        return;
    // Diagonals step along x: (P, Q, S) is (y, z, x).
    ivec3 voxel = laminaPart.low.xyz + ivec3(place.xy, place.z * 128);
    ivec3 start = laminaCellPlace(voxel.y, voxel.z, voxel.x);
    if (start.x < laminaLine.rows.x || start.x >= laminaLine.rows.x + laminaLine.rows.y)
        return;
    uint index = laminaPartIndex(place.x, place.y, place.z);
    uvec4 voters = laminaContested[index];
    if (voters == uvec4(0u))
        return;
    uvec4 first, second;
    laminaGatherVotes(start, first, second);
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
    laminaTexels[index] ^= carry & plane;
}
