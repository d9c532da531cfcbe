// The place of set voxels in a grid's order (BitGrid::forEachSet), for every shader stage.
//
//   #define LAMINA_ATTRIBUTES_GRID 1           // number of the grid in lamina/grid.glsl (default 0)
//   #define LAMINA_ATTRIBUTES_TEXTURE_UNIT 6   // (default 1)
//   #include <lamina/voxel_rank.glsl>
//
// VoxelAttributes::bind() puts the ranks on texture unit LAMINA_ATTRIBUTES_TEXTURE_UNIT.
// permute LAMINA_GRID_BUFFER_STORE = 0 1
#ifndef LAMINA_VOXEL_RANK_GLSL
#define LAMINA_VOXEL_RANK_GLSL

#include <lamina/grid.glsl>
#include <lamina/shared/attribute_block.glsl>

#ifndef LAMINA_ATTRIBUTES_GRID
#define LAMINA_ATTRIBUTES_GRID 0
#endif
#ifndef LAMINA_ATTRIBUTES_TEXTURE_UNIT
#define LAMINA_ATTRIBUTES_TEXTURE_UNIT 1
#endif

layout(binding = LAMINA_ATTRIBUTES_TEXTURE_UNIT) uniform usamplerBuffer laminaVoxelRanks;

// What laminaVoxelRank() gives for voxels that are not set.
#define LAMINA_NO_RANK 0xffffffffu

// Number of set voxels before the 128 slices of a column of the grid.
uint laminaTexelRank(ivec3 place) {
    ivec3 size = ivec3(laminaGridSize(LAMINA_ATTRIBUTES_GRID));
    int groups = (size.z + LAMINA_SLICES_PER_GROUP - 1) / LAMINA_SLICES_PER_GROUP;
    int texel = (place.z * size.y + place.y) * size.x + place.x;
    int blocks = (size.x * size.y * groups + LAMINA_RANK_BLOCK_TEXELS - 1) / LAMINA_RANK_BLOCK_TEXELS;
    int block = texel / LAMINA_RANK_BLOCK_TEXELS;
    uint before = texelFetch(laminaVoxelRanks, blocks * LAMINA_RANK_BLOCK_TEXELS + block).r;
    return before == LAMINA_RANK_OVERFLOW ? LAMINA_NO_RANK : before + texelFetch(laminaVoxelRanks, texel).r;
}

// The rank of a voxel, given its column's bits and their rank: LAMINA_NO_RANK unless it is set.
uint laminaRankInColumn(uvec4 bits, uint before, int slice) {
    int k = slice & (LAMINA_SLICES_PER_GROUP - 1);
    uvec4 below = laminaMaskBelow(k);
    bool isSet = any(notEqual(bits & (laminaMaskBelow(k + 1) ^ below), uvec4(0u)));
    return isSet && before != LAMINA_NO_RANK ? before + uint(laminaBitCount(bits & below)) : LAMINA_NO_RANK;
}

// Number of set voxels before this one; LAMINA_NO_RANK unless it is set.
uint laminaVoxelRank(ivec3 voxel) {
    if (voxel.z < 0)
        return LAMINA_NO_RANK;
    uvec4 bits = laminaColumnBits(LAMINA_ATTRIBUTES_GRID, voxel.xy, voxel.z >> 7);
    if (bits == uvec4(0u))
        return LAMINA_NO_RANK;
    return laminaRankInColumn(bits, laminaTexelRank(ivec3(voxel.xy, voxel.z >> 7)), voxel.z);
}

#endif
