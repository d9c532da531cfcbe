// Settles the voxels on which the axes agree, and lists the tiles that hold others.
//
// One invocation owns one texel, a work group a tile.
//   1. Six votes set the voxel, none leaves it clear; anything between is contested. A contested voxel
//      keeps its count, to which the diagonals add; its bit in the grid is the count's highest. If the
//      mesh is closed, all lines say the same: those along z alone have voted.
//   2. The first invocation lists the tile if any has found a contested voxel; hence the barrier.
#include <voxelize/solid_tiles.glsl>

#include <voxelize/solid_votes.glsl>
layout(std430, binding = LAMINA_SOLID_CONTESTED_BINDING) writeonly buffer LaminaContested {
    uvec4 laminaContested[];
};

shared uint laminaTileIsContested;

void main() {
    if (gl_LocalInvocationIndex == 0u)
        laminaTileIsContested = 0u;
    barrier();
    ivec3 place;
    if (laminaPartPlace(place)) {
        uint index = laminaPartIndex(place.x, place.y, place.z);
        uvec4 ones = laminaVotePlanes[0].laminaVotes[index];
        uvec4 twos = laminaVotePlanes[1].laminaVotes[index];
        uvec4 fours = laminaVotePlanes[2].laminaVotes[index];
        bool isClosed = laminaTally[LAMINA_TALLY_CLOSED] != 0u;
        uvec4 votes = ones | twos | fours;
        uvec4 agreed = isClosed ? votes : twos & fours;
        uvec4 contested = votes & ~agreed;
        laminaTexels[index] = agreed;
        laminaContested[index] = contested;
        if (contested != uvec4(0u)) {
            laminaTileIsContested = 1u;
        } else if (votes != uvec4(0u)) {
            for (int plane = 0; plane < 3; ++plane)
                laminaVotePlanes[plane].laminaVotes[index] = uvec4(0u);
        }
    }
    barrier();
    if (gl_LocalInvocationIndex == 0u && laminaTileIsContested != 0u) {
        laminaListTile();
        laminaTally[LAMINA_TALLY_CONTESTED] = 1u;
    }
}
