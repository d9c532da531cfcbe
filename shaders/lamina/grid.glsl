// Queries over voxel grids, for every shader stage of an engine.
//
//   #define LAMINA_GRID_COUNT 2            // grids in use, 1 (default) to 8
//   #define LAMINA_GRID_BLOCK_BINDING 3    // uniform buffers 3, 4 (default 0)
//   #define LAMINA_GRID_TEXTURE_UNIT 5     // texture units 5, 6 (default 0)
//   #define LAMINA_GRID_BUFFER_STORE 1     // all of them in buffers (VoxelGrid::store()), default 0
//   #include <lamina/grid.glsl>
//
// VoxelGrid::bind() puts grid number g on uniform buffer LAMINA_GRID_BLOCK_BINDING + g and texture
// unit LAMINA_GRID_TEXTURE_UNIT + g. Below, `grid` is that number g: a constant or dynamically uniform
// expression. World points are in world units, columns in pixels of the grid's camera.
//
// Precision: single. A point within about 1e-6 of the grid's extent from a voxel's face may answer for
// the voxel on the other side.
// permute LAMINA_GRID_BUFFER_STORE = 0 1
#ifndef LAMINA_GRID_GLSL
#define LAMINA_GRID_GLSL

#include <lamina/shared/grid_block.glsl>

#ifndef LAMINA_GRID_COUNT
#define LAMINA_GRID_COUNT 1
#endif
#ifndef LAMINA_GRID_BLOCK_BINDING
#define LAMINA_GRID_BLOCK_BINDING 0
#endif
#ifndef LAMINA_GRID_TEXTURE_UNIT
#define LAMINA_GRID_TEXTURE_UNIT 0
#endif
#ifndef LAMINA_GRID_BUFFER_STORE
#define LAMINA_GRID_BUFFER_STORE 0
#endif

layout(std140, binding = LAMINA_GRID_BLOCK_BINDING) uniform LaminaGridBlock {
    LaminaGridConstants constants;
    vec4 boundaries[LAMINA_MAX_SLICE_BOUNDARIES / 4];
} laminaGrid[LAMINA_GRID_COUNT];

#if LAMINA_GRID_BUFFER_STORE
layout(binding = LAMINA_GRID_TEXTURE_UNIT) uniform usamplerBuffer laminaGridWords[LAMINA_GRID_COUNT];
#define LAMINA_FETCH_WORD(words) texelFetch(words, texel)
#else
layout(binding = LAMINA_GRID_TEXTURE_UNIT) uniform usampler2DArray laminaGridWords[LAMINA_GRID_COUNT];
#define LAMINA_FETCH_WORD(words) texelFetch(words, texel, 0)
#endif

// Columns in x, columns in y, slices.
uvec3 laminaGridSize(int grid) {
    return laminaGrid[grid].constants.size.xyz;
}

// Continuous slice coordinate of a depth in [0, slices]; clamped.
float laminaSliceCoordinate(int grid, float depth) {
    vec4 range = laminaGrid[grid].constants.depthRange;
    float fraction = clamp((depth - range.x) * range.z, 0.0, 1.0);
    if ((laminaGrid[grid].constants.size.w & LAMINA_GRID_CUSTOM_SLICES) == 0u)
        return fraction * range.w;
    int low = 0;
    int high = int(laminaGrid[grid].constants.size.z);
    while (high - low > 1) {
        int middle = (low + high) >> 1;
        if (laminaGrid[grid].boundaries[middle >> 2][middle & 3] <= fraction)
            low = middle;
        else
            high = middle;
    }
    float front = laminaGrid[grid].boundaries[low >> 2][low & 3];
    float back = laminaGrid[grid].boundaries[(low + 1) >> 2][(low + 1) & 3];
    return float(low) + clamp((fraction - front) / (back - front), 0.0, 1.0);
}

// Continuous grid coordinates of a world point: columns x, y, slice. z is clamped to [0, slices];
// `inside` tells whether the point lies in the grid.
vec3 laminaWorldToGrid(int grid, vec3 world, out bool inside) {
    LaminaGridConstants constants = laminaGrid[grid].constants;
    vec4 point = vec4(world, 1.0);
    float depth = dot(constants.worldToColumn[2], point);
    float w = (constants.size.w & LAMINA_GRID_PERSPECTIVE) != 0u ? depth : 1.0;
    vec2 column = vec2(dot(constants.worldToColumn[0], point), dot(constants.worldToColumn[1], point)) / w;
    vec2 columns = vec2(constants.size.xy);
    inside = w > 0.0 && depth >= constants.depthRange.x && depth <= constants.depthRange.y &&
             all(greaterThanEqual(column, vec2(0.0))) && all(lessThanEqual(column, columns));
    return vec3(column, laminaSliceCoordinate(grid, depth));
}

// One texel of a grid: column (x, y), layer z. The sampler is chosen by comparisons: llvmpipe (Mesa
// 22.3) changes bits of integer texels, where they form a signalling NaN, fetched by a dynamic sampler
// index.
uvec4 laminaFetchWord(int grid, ivec3 place) {
#if LAMINA_GRID_COUNT > 8
#error "lamina/grid.glsl: LAMINA_GRID_COUNT is at most 8"
#endif
#if LAMINA_GRID_BUFFER_STORE
    ivec2 columns = ivec2(laminaGrid[grid].constants.size.xy);
    int texel = (place.z * columns.y + place.y) * columns.x + place.x;
#else
    ivec3 texel = place;
#endif
#if LAMINA_GRID_COUNT > 7
    if (grid == 7)
        return LAMINA_FETCH_WORD(laminaGridWords[7]);
#endif
#if LAMINA_GRID_COUNT > 6
    if (grid == 6)
        return LAMINA_FETCH_WORD(laminaGridWords[6]);
#endif
#if LAMINA_GRID_COUNT > 5
    if (grid == 5)
        return LAMINA_FETCH_WORD(laminaGridWords[5]);
#endif
#if LAMINA_GRID_COUNT > 4
    if (grid == 4)
        return LAMINA_FETCH_WORD(laminaGridWords[4]);
#endif
#if LAMINA_GRID_COUNT > 3
    if (grid == 3)
        return LAMINA_FETCH_WORD(laminaGridWords[3]);
#endif
#if LAMINA_GRID_COUNT > 2
    if (grid == 2)
        return LAMINA_FETCH_WORD(laminaGridWords[2]);
#endif
#if LAMINA_GRID_COUNT > 1
    if (grid == 1)
        return LAMINA_FETCH_WORD(laminaGridWords[1]);
#endif
    return LAMINA_FETCH_WORD(laminaGridWords[0]);
}

// The 128 bits of slices [128 group, 128 group + 128) of a column: bit (k & 31) of component
// (k >> 5) & 3 is slice k. Zero outside the grid.
uvec4 laminaColumnBits(int grid, ivec2 column, int group) {
    uvec3 size = laminaGrid[grid].constants.size.xyz;
    if (any(lessThan(column, ivec2(0))) || any(greaterThanEqual(column, ivec2(size.xy))) || group < 0 ||
        group * LAMINA_SLICES_PER_GROUP >= int(size.z))
        return uvec4(0u);
    return laminaFetchWord(grid, ivec3(column, group));
}

// A mask of the bits below `bit` in a 128-bit word; all of them from 128 on, none up to 0.
uvec4 laminaMaskBelow(int bit) {
    ivec4 count = clamp(ivec4(bit) - ivec4(0, 32, 64, 96), ivec4(0), ivec4(32));
    // A shift by 32 is undefined: the full words are chosen by comparison.
    return mix((uvec4(1u) << uvec4(count & 31)) - 1u, uvec4(0xffffffffu), equal(count, ivec4(32)));
}

// Number of set bits.
int laminaBitCount(uvec4 bits) {
    ivec4 counts = bitCount(bits);
    return counts.x + counts.y + counts.z + counts.w;
}

// Is this voxel set? False outside the grid.
bool laminaVoxelSet(int grid, ivec3 voxel) {
    if (voxel.z < 0)
        return false;
    uvec4 bits = laminaColumnBits(grid, voxel.xy, voxel.z >> 7);
    int word = (voxel.z >> 5) & 3;
    uint chosen = word < 2 ? (word == 0 ? bits.x : bits.y) : (word == 2 ? bits.z : bits.w);
    return ((chosen >> uint(voxel.z & 31)) & 1u) != 0u;
}

// Set voxels of a column in slices nearer than `slice` (clamped to the grid's slices).
int laminaCountNearer(int grid, ivec2 column, int slice) {
    int limit = min(slice, int(laminaGrid[grid].constants.size.z));
    int count = 0;
    for (int group = 0; group * LAMINA_SLICES_PER_GROUP < limit; ++group) {
        uvec4 bits = laminaColumnBits(grid, column, group);
        count += laminaBitCount(bits & laminaMaskBelow(limit - group * LAMINA_SLICES_PER_GROUP));
    }
    return count;
}

// The voxel of grid coordinates inside the grid; its upper bounds belong to the last voxel.
ivec3 laminaVoxelOf(int grid, vec3 gridPoint) {
    return min(ivec3(floor(gridPoint)), ivec3(laminaGrid[grid].constants.size.xyz) - 1);
}

// Is this world point in a set voxel? False outside the grid.
bool laminaPointSet(int grid, vec3 world) {
    bool inside;
    vec3 point = laminaWorldToGrid(grid, world, inside);
    return inside && laminaVoxelSet(grid, laminaVoxelOf(grid, point));
}

// Set voxels nearer to the grid's camera than the slice that holds a world point, in the point's
// column ([ED06] 3.1). 0 for points before the near depth or outside the columns; all of the column's
// voxels for points beyond the far depth.
int laminaPointCountNearer(int grid, vec3 world) {
    LaminaGridConstants constants = laminaGrid[grid].constants;
    bool inside;
    vec3 point = laminaWorldToGrid(grid, world, inside);
    float depth = dot(constants.worldToColumn[2], vec4(world, 1.0));
    if (depth < constants.depthRange.x || any(lessThan(point.xy, vec2(0.0))) ||
        any(greaterThan(point.xy, vec2(constants.size.xy))))
        return 0;
    ivec3 voxel = laminaVoxelOf(grid, point);
    int slice = depth > constants.depthRange.y ? int(constants.size.z) : voxel.z;
    return laminaCountNearer(grid, voxel.xy, slice);
}

#endif
