// What triangles leave in set voxels: 64-bit sums of colours and normals, weighted by the area of each
// triangle's part in the voxel; hits; and the material of the largest part.
//
// For each set voxel of the slices that a triangle meets:
//   1. its rank tells where its sums stand; voxels of other batches are left out;
//   2. the triangle is clipped to the voxel, which gives area and centroid;
//   3. colour and normal there, in 12 bits, times the area in LAMINA_WEIGHT_ONE-ths are added.
// Atomics, because other triangles meet the same voxel: an add that wraps around adds one to the high
// word, so sums never overflow, and they do not depend on the order. A part without area (a triangle
// that touches, a segment) weighs the least unit. Without LAMINA_ATTRIBUTE_COLORS all surfaces have one
// colour, whose sums nobody needs: an eighth of the time, on software GL.
#define LAMINA_GRID_BLOCK_BINDING LAMINA_PASS_GRID_BLOCK_BINDING
#include <lamina/voxel_rank.glsl>
#include <voxelize/attribute_surface.glsl>

layout(std430, binding = LAMINA_ATTRIBUTE_RECORDS_BINDING) buffer LaminaRecords {
    uint laminaRecords[];
};
layout(std430, binding = LAMINA_ATTRIBUTE_SUMS_LOW_BINDING) buffer LaminaSumsLow {
    uint laminaSumsLow[];
};
layout(std430, binding = LAMINA_ATTRIBUTE_SUMS_HIGH_BINDING) buffer LaminaSumsHigh {
    uint laminaSumsHigh[];
};

LaminaSurface laminaSurface;

void laminaBeginTriangle(uint triangle, dvec3 corners[3]) {
    laminaSurface = laminaSurfaceOf(triangle, corners);
}

void laminaAddTo(uint word, uint amount) {
    if (atomicAdd(laminaSumsLow[word], amount) > 0xffffffffu - amount)
        atomicAdd(laminaSumsHigh[word], 1u);
}

void laminaAddHit(uint slot, ivec3 voxel) {
    vec3 at;
    float area = laminaPartInVoxel(laminaSurface, voxel, at);
    uint weight = clamp(uint(area * float(LAMINA_WEIGHT_ONE) + 0.5), 1u, uint(LAMINA_WEIGHT_ONE));
    vec3 normal = laminaSurface.normals[0] * at.x + laminaSurface.normals[1] * at.y + laminaSurface.normals[2] * at.z;
    float size = length(normal);
    normal = size > 0.0 ? normal / size : vec3(0.0);
    uvec3 normalParts = uvec3(round(normal * float(LAMINA_NORMAL_ONE)) + float(LAMINA_NORMAL_ZERO));
    uint first = slot * uint(LAMINA_SUM_WORDS);
#if LAMINA_ATTRIBUTE_COLORS
    vec4 color = laminaSurface.colors[0] * at.x + laminaSurface.colors[1] * at.y + laminaSurface.colors[2] * at.z;
    uvec4 colorParts = uvec4(clamp(color, 0.0, 1.0) * float(LAMINA_COLOR_ONE) + 0.5);
    laminaAddTo(first, colorParts.r * weight);
    laminaAddTo(first + 1u, colorParts.g * weight);
    laminaAddTo(first + 2u, colorParts.b * weight);
    laminaAddTo(first + 3u, colorParts.a * weight);
#endif
    laminaAddTo(first + 4u, normalParts.x * weight);
    laminaAddTo(first + 5u, normalParts.y * weight);
    laminaAddTo(first + 6u, normalParts.z * weight);
    laminaAddTo(first + 7u, weight);
    uint record = slot * uint(LAMINA_RECORD_WORDS);
    atomicAdd(laminaRecords[record + uint(LAMINA_RECORD_HITS)], 1u);
    atomicMax(laminaRecords[record + uint(LAMINA_RECORD_MATERIAL)], (weight << uint(LAMINA_MATERIAL_BITS)) | laminaSurface.material);
}

void laminaVisitSlices(int x, int y, int first, int last) {
    uvec4 bits = uvec4(0u);
    uint before = 0u;
    int group = -1;
    for (int slice = first; slice <= last; ++slice) {
        if (slice >> 7 != group) {
            group = slice >> 7;
            bits = laminaColumnBits(0, ivec2(x, y), group);
            before = laminaTexelRank(ivec3(x, y, group));
        }
        // Ranks before the batch wrap around; LAMINA_NO_RANK is in no batch.
        uint slot = laminaRankInColumn(bits, before, slice) - laminaBatch.batch.x;
        if (slot < laminaBatch.batch.y)
            laminaAddHit(slot, ivec3(x, y, slice));
    }
}
