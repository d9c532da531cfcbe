// Queries over the attributes of set voxels (VoxelAttributes), for every shader stage of an engine.
//
//   #define LAMINA_ATTRIBUTES_GRID 1           // number of their grid in lamina/grid.glsl (default 0)
//   #define LAMINA_ATTRIBUTES_TEXTURE_UNIT 6   // texture units 6 and 7 (default 1)
//   #include <lamina/attributes.glsl>          // includes lamina/grid.glsl, see its definitions
//
// VoxelGrid::bind() puts the grid, VoxelAttributes::bind() its attributes there. Voxels are (column x,
// column y, slice), world points in world units.
// permute LAMINA_GRID_BUFFER_STORE = 0 1
#ifndef LAMINA_ATTRIBUTES_GLSL
#define LAMINA_ATTRIBUTES_GLSL

#include <lamina/voxel_rank.glsl>

layout(binding = LAMINA_ATTRIBUTES_TEXTURE_UNIT + 1) uniform usamplerBuffer laminaVoxelRecords;

struct LaminaAttributes {
    vec4 color;    // Mean colour by area, RGBA in [0,1].
    vec3 normal;   // Mean normal by area, world space, unit length; zero where normals cancel out.
    uint hits;     // Triangles that touch the voxel; 0: no attributes.
    uint material; // Id of the triangle with the largest area in the voxel.
};

// The unit vector of an octahedral pair in [-1,1].
vec3 laminaOctahedral(vec2 p) {
    vec3 v = vec3(p, 1.0 - abs(p.x) - abs(p.y));
    float fold = max(-v.z, 0.0);
    v.xy -= mix(vec2(-fold), vec2(fold), greaterThanEqual(v.xy, vec2(0.0)));
    return normalize(v);
}

// What surfaces leave in a voxel. hits is 0, and all else zero, for voxels that are not set, that no
// triangle touches (the inside of solids), or beyond VoxelAttributesDesc::maxVoxels.
LaminaAttributes laminaVoxelAttributes(ivec3 voxel) {
    LaminaAttributes result = LaminaAttributes(vec4(0.0), vec3(0.0), 0u, 0u);
    uint rank = laminaVoxelRank(voxel);
    if (rank >= uint(textureSize(laminaVoxelRecords)))
        return result;
    uvec4 record = texelFetch(laminaVoxelRecords, int(rank));
    result.color = unpackUnorm4x8(record[LAMINA_RECORD_COLOR]);
    if (record[LAMINA_RECORD_NORMAL] != LAMINA_NO_NORMAL)
        result.normal = laminaOctahedral(unpackSnorm2x16(record[LAMINA_RECORD_NORMAL]));
    result.hits = record[LAMINA_RECORD_HITS];
    result.material = record[LAMINA_RECORD_MATERIAL];
    return result;
}

// The attributes at a world point; hits is 0 outside the grid.
LaminaAttributes laminaPointAttributes(vec3 world) {
    bool inside;
    vec3 point = laminaWorldToGrid(LAMINA_ATTRIBUTES_GRID, world, inside);
    return laminaVoxelAttributes(inside ? laminaVoxelOf(LAMINA_ATTRIBUTES_GRID, point) : ivec3(-1));
}

#endif
