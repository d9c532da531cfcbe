// Queries over voxel grids, for every shader stage of an engine.
//
//   #define LAMINA_GRID_COUNT 2            // grids in use, 1 (default) to 8
//   #define LAMINA_GRID_BLOCK_BINDING 3    // uniform buffers 3, 4 (default 0)
//   #define LAMINA_GRID_TEXTURE_UNIT 5     // texture units 5, 6 (default 0)
//   #define LAMINA_GRID_BUFFER_STORE 1     // all of them in buffers (VoxelGrid::store()), default 0
//   #define LAMINA_GRID_LOCAL_RANGES 1     // some may have local ranges (near/far maps), default 0
//   #define LAMINA_GRID_RANGE_UNIT 9       // their texture units 9, 10 (default: 8 after those above)
//   #include <lamina/grid.glsl>
//
// VoxelGrid::bind() puts grid number g on uniform buffer LAMINA_GRID_BLOCK_BINDING + g, texture unit
// LAMINA_GRID_TEXTURE_UNIT + g and, with local ranges, LAMINA_GRID_RANGE_UNIT + g. Below, `grid` is that number g: a constant or dynamically uniform
// expression. World points are in world units, columns in pixels of the grid's camera.
//
// Precision: single. A point within about 1e-6 of the grid's extent from a voxel's face may answer for
// the voxel on the other side; where a column's own range is shorter than that,
// its slices cannot be told apart.
// permute LAMINA_GRID_BUFFER_STORE = 0 1
// permute LAMINA_GRID_LOCAL_RANGES = 0 1
#ifndef LAMINA_GRID_GLSL
#define LAMINA_GRID_GLSL

#include <lamina/bits.glsl>
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
#ifndef LAMINA_GRID_LOCAL_RANGES
#define LAMINA_GRID_LOCAL_RANGES 0
#endif
#ifndef LAMINA_GRID_RANGE_UNIT
#define LAMINA_GRID_RANGE_UNIT (LAMINA_GRID_TEXTURE_UNIT + LAMINA_GRID_DEFAULT_RANGE_UNIT)
#endif

layout(std140, binding = LAMINA_GRID_BLOCK_BINDING) uniform LaminaGridBlock {
    LaminaGridConstants constants;
    vec4 boundaries[LAMINA_MAX_SLICE_BOUNDARIES / 4];
} laminaGrid[LAMINA_GRID_COUNT];

#if LAMINA_GRID_BUFFER_STORE
layout(binding = LAMINA_GRID_TEXTURE_UNIT) uniform usamplerBuffer laminaGridWords[LAMINA_GRID_COUNT];
#else
layout(binding = LAMINA_GRID_TEXTURE_UNIT) uniform usampler2DArray laminaGridWords[LAMINA_GRID_COUNT];
#endif

#if LAMINA_GRID_LOCAL_RANGES
layout(binding = LAMINA_GRID_RANGE_UNIT) uniform sampler2D laminaGridRanges[LAMINA_GRID_COUNT];
#endif

// Columns in x, columns in y, slices.
uvec3 laminaGridSize(int grid) {
    return laminaGrid[grid].constants.size.xyz;
}

// Evaluates FETCH(g) for the constant g that equals `grid`. Samplers are chosen by comparisons: llvmpipe
// (Mesa 22.3) fetches wrongly by a dynamic sampler index (it changes bits of integer texels that form a
// signalling NaN, and with two arrays of samplers takes the wrong one).
#if LAMINA_GRID_COUNT > 8
#error "lamina/grid.glsl: LAMINA_GRID_COUNT is at most 8"
#endif
#define LAMINA_RETURN_IF_GRID_1(FETCH) return FETCH(0);
#if LAMINA_GRID_COUNT > 1
#define LAMINA_RETURN_IF_GRID_2(FETCH) if (grid == 1) return FETCH(1); LAMINA_RETURN_IF_GRID_1(FETCH)
#else
#define LAMINA_RETURN_IF_GRID_2(FETCH) LAMINA_RETURN_IF_GRID_1(FETCH)
#endif
#if LAMINA_GRID_COUNT > 2
#define LAMINA_RETURN_IF_GRID_3(FETCH) if (grid == 2) return FETCH(2); LAMINA_RETURN_IF_GRID_2(FETCH)
#else
#define LAMINA_RETURN_IF_GRID_3(FETCH) LAMINA_RETURN_IF_GRID_2(FETCH)
#endif
#if LAMINA_GRID_COUNT > 3
#define LAMINA_RETURN_IF_GRID_4(FETCH) if (grid == 3) return FETCH(3); LAMINA_RETURN_IF_GRID_3(FETCH)
#else
#define LAMINA_RETURN_IF_GRID_4(FETCH) LAMINA_RETURN_IF_GRID_3(FETCH)
#endif
#if LAMINA_GRID_COUNT > 4
#define LAMINA_RETURN_IF_GRID_5(FETCH) if (grid == 4) return FETCH(4); LAMINA_RETURN_IF_GRID_4(FETCH)
#else
#define LAMINA_RETURN_IF_GRID_5(FETCH) LAMINA_RETURN_IF_GRID_4(FETCH)
#endif
#if LAMINA_GRID_COUNT > 5
#define LAMINA_RETURN_IF_GRID_6(FETCH) if (grid == 5) return FETCH(5); LAMINA_RETURN_IF_GRID_5(FETCH)
#else
#define LAMINA_RETURN_IF_GRID_6(FETCH) LAMINA_RETURN_IF_GRID_5(FETCH)
#endif
#if LAMINA_GRID_COUNT > 6
#define LAMINA_RETURN_IF_GRID_7(FETCH) if (grid == 6) return FETCH(6); LAMINA_RETURN_IF_GRID_6(FETCH)
#else
#define LAMINA_RETURN_IF_GRID_7(FETCH) LAMINA_RETURN_IF_GRID_6(FETCH)
#endif
#if LAMINA_GRID_COUNT > 7
#define LAMINA_RETURN_IF_GRID_8(FETCH) if (grid == 7) return FETCH(7); LAMINA_RETURN_IF_GRID_7(FETCH)
#else
#define LAMINA_RETURN_IF_GRID_8(FETCH) LAMINA_RETURN_IF_GRID_7(FETCH)
#endif

// One texel of a grid: column (x, y), layer z.
uvec4 laminaFetchWord(int grid, ivec3 place) {
#if LAMINA_GRID_BUFFER_STORE
    ivec2 columns = ivec2(laminaGrid[grid].constants.size.xy);
    int texel = (place.z * columns.y + place.y) * columns.x + place.x;
#define LAMINA_FETCH_WORD(g) texelFetch(laminaGridWords[g], texel)
#else
#define LAMINA_FETCH_WORD(g) texelFetch(laminaGridWords[g], place, 0)
#endif
    LAMINA_RETURN_IF_GRID_8(LAMINA_FETCH_WORD)
}

#if LAMINA_GRID_LOCAL_RANGES
// One texel of a grid's near/far map.
vec2 laminaFetchRange(int grid, ivec2 column) {
#define LAMINA_FETCH_RANGE(g) texelFetch(laminaGridRanges[g], column, 0).xy
    LAMINA_RETURN_IF_GRID_8(LAMINA_FETCH_RANGE)
}
#endif

// The depths that the slices of a column divide, near and far; near > far in an empty column of a grid
// with local ranges, and outside the columns of such a grid.
vec2 laminaColumnRange(int grid, ivec2 column) {
    LaminaGridConstants constants = laminaGrid[grid].constants;
#if LAMINA_GRID_LOCAL_RANGES
    if ((constants.size.w & LAMINA_GRID_LOCAL) != 0u) {
        if (any(lessThan(column, ivec2(0))) || any(greaterThanEqual(column, ivec2(constants.size.xy))))
            return vec2(1.0, -1.0) * LAMINA_EMPTY_COLUMN;
        return vec2(1.0, -1.0) * laminaFetchRange(grid, column);
    }
#endif
    return constants.depthRange.xy;
}

// Continuous slice coordinate of a depth in [0, slices], clamped, where the slices divide `range`, a
// laminaColumnRange(); 0 in a range of no extent.
float laminaSliceCoordinate(int grid, vec2 range, float depth) {
    float extent = range.y - range.x;
    float fraction = extent > 0.0 ? clamp((depth - range.x) / extent, 0.0, 1.0) : 0.0;
    if ((laminaGrid[grid].constants.size.w & LAMINA_GRID_CUSTOM_SLICES) == 0u)
        return fraction * laminaGrid[grid].constants.depthRange.w;
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

// The same in a column without a range of its own.
float laminaSliceCoordinate(int grid, float depth) {
    return laminaSliceCoordinate(grid, laminaGrid[grid].constants.depthRange.xy, depth);
}

// Where a world point stands in a grid.
struct LaminaGridPoint {
    vec2 column;    // Continuous.
    float depth;    // World units.
    vec2 range;     // laminaColumnRange() of the column.
    bool isInside;  // Within the columns, and in front of a perspective grid's eye.
};

LaminaGridPoint laminaGridPoint(int grid, vec3 world) {
    LaminaGridConstants constants = laminaGrid[grid].constants;
    vec4 point = vec4(world, 1.0);
    LaminaGridPoint place;
    place.depth = dot(constants.worldToColumn[2], point);
    float w = (constants.size.w & LAMINA_GRID_PERSPECTIVE) != 0u ? place.depth : 1.0;
    place.column = vec2(dot(constants.worldToColumn[0], point), dot(constants.worldToColumn[1], point)) / w;
    vec2 columns = vec2(constants.size.xy);
    place.isInside = w > 0.0 && all(greaterThanEqual(place.column, vec2(0.0))) &&
                     all(lessThanEqual(place.column, columns));
    vec2 inner = clamp(floor(place.column), vec2(0.0), columns - 1.0);
    place.range = laminaColumnRange(grid, ivec2(inner));
    return place;
}

// Continuous grid coordinates of a world point: columns x, y, slice. z is clamped to [0, slices];
// `inside` tells whether the point lies in the grid, and in the column's own range where it has one.
vec3 laminaWorldToGrid(int grid, vec3 world, out bool inside) {
    LaminaGridPoint place = laminaGridPoint(grid, world);
    inside = place.isInside && place.depth >= place.range.x && place.depth <= place.range.y;
    return vec3(place.column, laminaSliceCoordinate(grid, place.range, place.depth));
}

// The 128 bits of slices [128 group, 128 group + 128) of a column: bit (k & 31) of component
// (k >> 5) & 3 is slice k. Zero outside the grid.
// map: of a host that keeps several maps of one place, one after the other in the grid's texture, the
// number of one of them; of a VoxelGrid 0, which the functions without it mean.
uvec4 laminaColumnBits(int grid, int map, ivec2 column, int group) {
    uvec3 size = laminaGrid[grid].constants.size.xyz;
    if (any(lessThan(column, ivec2(0))) || any(greaterThanEqual(column, ivec2(size.xy))) || group < 0 ||
        group * LAMINA_SLICES_PER_GROUP >= int(size.z))
        return uvec4(0u);
    int groups = (int(size.z) + LAMINA_SLICES_PER_GROUP - 1) / LAMINA_SLICES_PER_GROUP;
    return laminaFetchWord(grid, ivec3(column, map * groups + group));
}

uvec4 laminaColumnBits(int grid, ivec2 column, int group) {
    return laminaColumnBits(grid, 0, column, group);
}

// Is this voxel set? False outside the grid.
bool laminaVoxelSet(int grid, int map, ivec3 voxel) {
    if (voxel.z < 0)
        return false;
    return laminaBit(laminaColumnBits(grid, map, voxel.xy, voxel.z >> 7), voxel.z & 127) != 0u;
}

bool laminaVoxelSet(int grid, ivec3 voxel) {
    return laminaVoxelSet(grid, 0, voxel);
}

// Set voxels of a column in slices nearer than `slice` (clamped to the grid's slices).
int laminaCountNearer(int grid, int map, ivec2 column, int slice) {
    int limit = min(slice, int(laminaGrid[grid].constants.size.z));
    int count = 0;
    for (int group = 0; group * LAMINA_SLICES_PER_GROUP < limit; ++group) {
        uvec4 bits = laminaColumnBits(grid, map, column, group);
        count += laminaBitCount(bits & laminaMaskBelow(limit - group * LAMINA_SLICES_PER_GROUP));
    }
    return count;
}

int laminaCountNearer(int grid, ivec2 column, int slice) {
    return laminaCountNearer(grid, 0, column, slice);
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
// column ([ED06] 3.1). 0 for points before the column's near depth or outside the columns, without
// reading a voxel; all of the column's voxels for points beyond its far depth.
int laminaPointCountNearer(int grid, vec3 world) {
    LaminaGridPoint place = laminaGridPoint(grid, world);
    if (!place.isInside || place.depth < place.range.x || place.range.x > place.range.y)
        return 0;
    float slice = laminaSliceCoordinate(grid, place.range, place.depth);
    ivec3 voxel = laminaVoxelOf(grid, vec3(place.column, slice));
    return laminaCountNearer(grid, voxel.xy,
                             place.depth > place.range.y ? int(laminaGrid[grid].constants.size.z) : voxel.z);
}

#endif
