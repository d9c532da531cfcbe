// Counts the set voxels of a grid: a rank for each texel of 128 slices, relative to its block of
// LAMINA_RANK_BLOCK_TEXELS texels, and the number of set voxels of each block.
//
// One work group owns one block, an invocation 16 consecutive texels:
//   1. count its bits and share the sum;
//   2. after the barrier, sum up the invocations before it, and store each texel's rank.
// No atomics: equal grids give equal ranks.
// permute LAMINA_GRID_BUFFER_STORE = 0 1
#define LAMINA_GRID_BLOCK_BINDING LAMINA_PASS_GRID_BLOCK_BINDING
#include <lamina/grid.glsl>
#include <lamina/shared/attribute_block.glsl>

layout(local_size_x = LAMINA_RANK_GROUP_SIZE) in;

layout(location = 0) uniform int laminaFirstBlock; // Of this dispatch and of the binding.
layout(location = 1) uniform int laminaBlockEnd;

layout(std430, binding = LAMINA_RANK_TEXELS_BINDING) writeonly buffer LaminaTexelRanks {
    uint laminaTexelRanks[];
};
layout(std430, binding = LAMINA_RANK_BLOCKS_BINDING) writeonly buffer LaminaBlockCounts {
    uint laminaBlockCounts[];
};

const int kTexels = LAMINA_RANK_BLOCK_TEXELS / LAMINA_RANK_GROUP_SIZE;
shared uint laminaCounts[LAMINA_RANK_GROUP_SIZE];

// Texels past the last one, in the last block, are empty: laminaColumnBits() sees to it.
uint laminaTexelCount(int texel) {
    ivec2 columns = ivec2(laminaGridSize(0).xy);
    int row = texel / columns.x;
    return uint(laminaBitCount(laminaColumnBits(0, ivec2(texel - row * columns.x, row % columns.y), row / columns.y)));
}

void main() {
    int block = laminaFirstBlock + int(gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x);
    int first = block * LAMINA_RANK_BLOCK_TEXELS + int(gl_LocalInvocationIndex) * kTexels;
    bool isNeeded = block < laminaBlockEnd;
    uint own[kTexels];
    uint sum = 0u;
    for (int i = 0; i < kTexels; ++i) {
        own[i] = isNeeded ? laminaTexelCount(first + i) : 0u;
        sum += own[i];
    }
    laminaCounts[gl_LocalInvocationIndex] = sum;
    barrier();
    uint before = 0u;
    for (uint i = 0u; i < gl_LocalInvocationIndex; ++i)
        before += laminaCounts[i];
    if (!isNeeded)
        return;
    for (int i = 0; i < kTexels; ++i) {
        laminaTexelRanks[first - laminaFirstBlock * LAMINA_RANK_BLOCK_TEXELS + i] = before;
        before += own[i];
    }
    if (gl_LocalInvocationIndex == uint(LAMINA_RANK_GROUP_SIZE - 1))
        laminaBlockCounts[block] = before;
}
