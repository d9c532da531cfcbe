// Counts the contested voxels whose votes were close, leaves the mark on them alone, and the planes of
// the votes zero. One invocation owns one texel of a listed tile.
#include <voxelize/solid_tiles.glsl>

#include <voxelize/solid_votes.glsl>
layout(std430, binding = LAMINA_SOLID_CONTESTED_BINDING) buffer LaminaContested {
    uvec4 laminaContested[];
};

void main() {
    ivec3 place;
    if (!laminaTilePlace(place))
        return;
    uint index = laminaPartIndex(place.x, place.y, place.z);
    uvec4 ones = laminaVotePlanes[0].laminaVotes[index];
    uvec4 twos = laminaVotePlanes[1].laminaVotes[index];
    uvec4 fours = laminaVotePlanes[2].laminaVotes[index];
    uvec4 eights = laminaTexels[index];
    // 5, 6, 7 or 8, 9 votes of 14: see LAMINA_SOLID_DOUBTFUL_VOTES.
    uvec4 close = (~eights & fours & (ones | twos)) | (eights & ~fours & ~twos);
    uvec4 doubtful = close & laminaContested[index];
    laminaContested[index] = doubtful;
    for (int plane = 0; plane < 3; ++plane)
        laminaVotePlanes[plane].laminaVotes[index] = uvec4(0u);
    laminaTallyAdd(LAMINA_TALLY_DOUBTFUL, uint(laminaBitCount(doubtful)));
}
