// Queries over a volume (VolumeGrid), for every shader stage of an engine.
//
//   #define LAMINA_VOLUME_BLOCK_BINDING 3   // uniform buffer (default 0)
//   #define LAMINA_VOLUME_TEXTURE_UNIT 5    // texture units 5 to 10 (default 0)
//   #include <lamina/volume.glsl>
//
// VolumeGrid::bind() puts the volume there. World points are in world units; voxels are (column x,
// column y, slice). Payloads that the volume does not hold answer as if no voxel were hit.
//
// Precision: single. A point within about 1e-6 of the grid's extent from a voxel's face may answer for
// the voxel on the other side.
#ifndef LAMINA_VOLUME_GLSL
#define LAMINA_VOLUME_GLSL

#include <lamina/shared/volume_block.glsl>

#ifndef LAMINA_VOLUME_BLOCK_BINDING
#define LAMINA_VOLUME_BLOCK_BINDING 0
#endif
#ifndef LAMINA_VOLUME_TEXTURE_UNIT
#define LAMINA_VOLUME_TEXTURE_UNIT 0
#endif

layout(std140, binding = LAMINA_VOLUME_BLOCK_BINDING) uniform LaminaVolumeBlock {
    LaminaVolumeConstants constants;
    vec4 boundaries[LAMINA_MAX_SLICE_BOUNDARIES / 4];
} laminaVolume;

layout(binding = LAMINA_VOLUME_TEXTURE_UNIT + LAMINA_VOLUME_UNIT_COUNT_R32UI) uniform usampler3D laminaVolumeCounts32;
layout(binding = LAMINA_VOLUME_TEXTURE_UNIT + LAMINA_VOLUME_UNIT_COUNT_R8) uniform sampler3D laminaVolumeCounts8;
layout(binding = LAMINA_VOLUME_TEXTURE_UNIT + LAMINA_VOLUME_UNIT_ABSORPTION) uniform sampler3D laminaVolumeAbsorptions;
layout(binding = LAMINA_VOLUME_TEXTURE_UNIT + LAMINA_VOLUME_UNIT_NORMAL) uniform sampler3D laminaVolumeNormals;
layout(binding = LAMINA_VOLUME_TEXTURE_UNIT + LAMINA_VOLUME_UNIT_COLOR) uniform sampler3D laminaVolumeColors;
layout(binding = LAMINA_VOLUME_TEXTURE_UNIT + LAMINA_VOLUME_UNIT_OPTICS) uniform sampler3D laminaVolumeOpticsSums;

// Columns in x, columns in y, slices.
uvec3 laminaVolumeSize() {
    return laminaVolume.constants.grid.size.xyz;
}

bool laminaVolumeHas(uint payload) {
    return (laminaVolume.constants.payload.x & payload) != 0u;
}

// Are a payload's texels means in 8 bits, not sums?
bool laminaVolumeIsMean(uint payload) {
    return (laminaVolume.constants.payload.y & payload) != 0u;
}

bool laminaVolumeHolds(ivec3 voxel) {
    return all(greaterThanEqual(voxel, ivec3(0))) && all(lessThan(voxel, ivec3(laminaVolumeSize())));
}

// Continuous slice coordinate of a depth in [0, slices]; clamped.
float laminaVolumeSliceCoordinate(float depth) {
    vec4 range = laminaVolume.constants.grid.depthRange;
    float fraction = clamp((depth - range.x) * range.z, 0.0, 1.0);
    if ((laminaVolume.constants.grid.size.w & LAMINA_GRID_CUSTOM_SLICES) == 0u)
        return fraction * range.w;
    int low = 0;
    int high = int(laminaVolume.constants.grid.size.z);
    while (high - low > 1) {
        int middle = (low + high) >> 1;
        if (laminaVolume.boundaries[middle >> 2][middle & 3] <= fraction)
            low = middle;
        else
            high = middle;
    }
    float front = laminaVolume.boundaries[low >> 2][low & 3];
    float back = laminaVolume.boundaries[(low + 1) >> 2][(low + 1) & 3];
    return float(low) + clamp((fraction - front) / (back - front), 0.0, 1.0);
}

// Continuous grid coordinates of a world point: columns x, y, slice. z is clamped to [0, slices];
// `inside` tells whether the point lies in the grid.
vec3 laminaVolumeWorldToGrid(vec3 world, out bool inside) {
    LaminaGridConstants grid = laminaVolume.constants.grid;
    vec4 point = vec4(world, 1.0);
    float depth = dot(grid.worldToColumn[2], point);
    float w = (grid.size.w & LAMINA_GRID_PERSPECTIVE) != 0u ? depth : 1.0;
    vec2 column = vec2(dot(grid.worldToColumn[0], point), dot(grid.worldToColumn[1], point)) / w;
    inside = w > 0.0 && depth >= grid.depthRange.x && depth <= grid.depthRange.y &&
             all(greaterThanEqual(column, vec2(0.0))) && all(lessThanEqual(column, vec2(grid.size.xy)));
    return vec3(column, laminaVolumeSliceCoordinate(depth));
}

// The voxel of a world point; (-1,-1,-1), which all queries below take as not hit, outside the grid.
ivec3 laminaVolumeVoxelAt(vec3 world) {
    bool inside;
    vec3 point = laminaVolumeWorldToGrid(world, inside);
    return inside ? min(ivec3(floor(point)), ivec3(laminaVolumeSize()) - 1) : ivec3(-1);
}

// Hits of a voxel. R8 volumes count to 255.
uint laminaVolumeCount(ivec3 voxel) {
    if (!laminaVolumeHolds(voxel))
        return 0u;
    if (laminaVolumeHas(LAMINA_VOLUME_COUNT_R32UI))
        return texelFetch(laminaVolumeCounts32, voxel, 0).r;
    if (laminaVolumeHas(LAMINA_VOLUME_COUNT_R8))
        return uint(texelFetch(laminaVolumeCounts8, voxel, 0).r * 255.0 + 0.5);
    return 0u;
}

// Sum of the absorption of a voxel's hits.
float laminaVolumeAbsorption(ivec3 voxel) {
    if (!laminaVolumeHolds(voxel) || !laminaVolumeHas(LAMINA_VOLUME_ABSORPTION))
        return 0.0;
    return texelFetch(laminaVolumeAbsorptions, voxel, 0).r;
}

// Sum of the absorption in a column's slices nearer than `slice` ([CLN11] 3).
float laminaVolumeAbsorptionNearer(ivec2 column, int slice) {
    float sum = 0.0;
    int end = min(slice, int(laminaVolumeSize().z));
    for (int k = 0; k < end; ++k)
        sum += laminaVolumeAbsorption(ivec3(column, k));
    return sum;
}

// The mean that a texel stands for: 8-bit texels are means, others sums with the hits in alpha.
vec3 laminaVolumeMean(vec4 texel, uint payload) {
    return laminaVolumeIsMean(payload) || texel.a == 0.0 ? texel.rgb : texel.rgb / texel.a;
}

// Mean surface normal, world space, unit length; zero where nothing hits or normals cancel out.
vec3 laminaVolumeNormal(ivec3 voxel) {
    if (!laminaVolumeHolds(voxel) || !laminaVolumeHas(LAMINA_VOLUME_NORMAL))
        return vec3(0.0);
    vec4 texel = texelFetch(laminaVolumeNormals, voxel, 0);
    if (texel.a == 0.0)
        return vec3(0.0);
    vec3 mean = laminaVolumeMean(texel, LAMINA_VOLUME_NORMAL);
    if (laminaVolumeIsMean(LAMINA_VOLUME_NORMAL))
        mean = mean * 2.0 - 1.0;
    float size = length(mean);
    return size > LAMINA_VOLUME_CANCELLED_NORMAL ? mean / size : vec3(0.0);
}

// Mean surface colour; zero where nothing hits.
vec3 laminaVolumeColor(ivec3 voxel) {
    if (!laminaVolumeHolds(voxel) || !laminaVolumeHas(LAMINA_VOLUME_COLOR))
        return vec3(0.0);
    return laminaVolumeMean(texelFetch(laminaVolumeColors, voxel, 0), LAMINA_VOLUME_COLOR);
}

// Mean refractive index and transmission; (1,1) where nothing hits.
vec2 laminaVolumeOptics(ivec3 voxel) {
    if (!laminaVolumeHolds(voxel) || !laminaVolumeHas(LAMINA_VOLUME_OPTICS))
        return vec2(1.0);
    vec4 texel = texelFetch(laminaVolumeOpticsSums, voxel, 0);
    if (texel.a == 0.0)
        return vec2(1.0);
    vec2 mean = laminaVolumeMean(texel, LAMINA_VOLUME_OPTICS).xy;
    if (laminaVolumeIsMean(LAMINA_VOLUME_OPTICS))
        mean.x = 1.0 + mean.x * LAMINA_VOLUME_INDEX_RANGE;
    return mean;
}

#endif
