// Numbers and buffer layouts of voxel attributes (VoxelAttributes). Valid GLSL and C++.
#ifndef LAMINA_SHARED_ATTRIBUTE_BLOCK
#define LAMINA_SHARED_ATTRIBUTE_BLOCK

#include <lamina/shared/constants.glsl>

// A rank is stored for each texel of 128 slices, relative to its block of so many texels; the blocks'
// own follow, then the number of set voxels.
#define LAMINA_RANK_BLOCK_TEXELS 1024
#define LAMINA_RANK_GROUP_SIZE 64
// The rank of a block that is beyond 32 bits.
#define LAMINA_RANK_OVERFLOW 0xffffffffu

// Words of a voxel's record: colour (RGBA8, red lowest), normal (octahedral, two signed 16-bit numbers,
// or LAMINA_NO_NORMAL, which packSnorm2x16() never makes), hits, material id.
#define LAMINA_RECORD_COLOR 0
#define LAMINA_RECORD_NORMAL 1
#define LAMINA_RECORD_HITS 2
#define LAMINA_RECORD_MATERIAL 3
#define LAMINA_RECORD_WORDS 4
#define LAMINA_NO_NORMAL 0x80008000u

// Sums of a voxel: red, green, blue, alpha, normal x, y, z, weight. Low words and high words stand in
// two buffers.
#define LAMINA_SUM_WORDS 8

// A hit's weight: the area of the triangle's part in the voxel, in units such that no part exceeds
// this; at least 1. Times a colour or normal component in 12 bits it fits a word.
#define LAMINA_WEIGHT_ONE 1048576
#define LAMINA_COLOR_ONE 4095
// Normal components lie in [1, 4095] around this zero.
#define LAMINA_NORMAL_ZERO 2048
#define LAMINA_NORMAL_ONE 2047
// While sums are built, a record's material holds area << this | id for the largest area so far.
#define LAMINA_MATERIAL_BITS 9

// Slices of a pass: bounds the loops of an invocation that owns 64 blocks of columns.
#define LAMINA_ATTRIBUTE_PART_SLICES 512

// Bindings of the attribute programs beside those of LAMINA_OVERLAP_*.
#define LAMINA_ATTRIBUTE_BLOCK_BINDING 3
#define LAMINA_ATTRIBUTE_RECORDS_BINDING 0
#define LAMINA_ATTRIBUTE_SUMS_LOW_BINDING 6
#define LAMINA_ATTRIBUTE_SUMS_HIGH_BINDING 7
#define LAMINA_ATTRIBUTE_BINDING_COUNT 8
#define LAMINA_ATTRIBUTE_UNIFORM_COUNT 4
// Of the rank programs.
#define LAMINA_RANK_TEXELS_BINDING 0
#define LAMINA_RANK_BLOCKS_BINDING 1
// Texture units of the passes: words, ranks.
#define LAMINA_ATTRIBUTE_PASS_UNITS 2

struct LaminaAttributeConstants {
    // Rows of the map from cross products in grid coordinates to those in the world, relative to the
    // largest section of a voxel.
    vec4 areaToWorld[3];
    // First voxel of the batch by rank, voxels of the batch, greatest material id, 1 if all surfaces have
    // the colour `color`, which then has no sums.
    uvec4 batch;
    vec4 color;
};

#endif
