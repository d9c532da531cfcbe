// Triangles of a MeshView or of a capture, read from storage buffers, in grid coordinates; and the
// words of the grid.
#include <lamina/shared/overlap_block.glsl>

layout(local_size_x = LAMINA_OVERLAP_GROUP_SIZE) in;

layout(std140, binding = LAMINA_OVERLAP_BLOCK_BINDING) uniform LaminaOverlapBlock {
    LaminaOverlapConstants laminaOverlap;
};
layout(std430, binding = LAMINA_OVERLAP_WORDS_BINDING) buffer LaminaGridWords {
    uint laminaWords[];
};
layout(std430, binding = LAMINA_OVERLAP_VERTEX_BINDING) readonly buffer LaminaVertexWords {
    uint laminaVertexWords[];
};
layout(std430, binding = LAMINA_OVERLAP_INDEX_BINDING) readonly buffer LaminaIndexWords {
    uint laminaIndexWords[];
};

uint laminaVertexIndex(uint corner) {
    uint index = laminaOverlap.source.y + corner;
    if (laminaOverlap.source.z == LAMINA_INDEX_UINT32)
        return laminaIndexWords[index];
    if (laminaOverlap.source.z == LAMINA_INDEX_UINT16)
        return (laminaIndexWords[index >> 1] >> ((index & 1u) * 16u)) & 0xffffu;
    return index;
}

// Vertices in grid coordinates, in double precision, so that they carry no float rounding.
// False if the triangle has an index out of range or a position that is not finite.
bool laminaFetchTriangle(uint triangle, out dvec3 corners[3]) {
    for (uint i = 0u; i < 3u; ++i) {
        uint index = laminaVertexIndex(triangle * 3u + i);
        if (index >= laminaOverlap.vertices.z)
            return false;
        uint word = laminaOverlap.vertices.x + index * laminaOverlap.vertices.y;
        vec3 local = uintBitsToFloat(uvec3(laminaVertexWords[word], laminaVertexWords[word + 1u],
                                           laminaVertexWords[word + 2u]));
        if (any(isnan(local)) || any(isinf(local)))
            return false;
        dvec3 position = dvec3(local);
        // The same numbers in every program and for every triangle of the vertex.
        precise dvec3 corner = dvec3(laminaOverlap.localToGrid[0].w, laminaOverlap.localToGrid[1].w, laminaOverlap.localToGrid[2].w);
        for (int row = 0; row < 3; ++row)
            corner[row] += laminaOverlap.localToGrid[row].x * position.x + laminaOverlap.localToGrid[row].y * position.y +
                           laminaOverlap.localToGrid[row].z * position.z;
        corners[i] = corner;
    }
    return true;
}

// Index of the word that holds slices [32 word, 32 word + 32) of a column of the part.
uint laminaWordIndex(int x, int y, int word) {
    uint layer = uint((word >> 2) - (laminaOverlap.low.z >> 7));
    uint texel = (layer * laminaOverlap.grid.y + uint(y - laminaOverlap.low.y)) * laminaOverlap.grid.x + uint(x);
    return (texel + uint(laminaOverlap.low.w)) * 4u + uint(word & 3);
}

// Voxels that a box overlaps, clipped to the part. Unused parts are empty: first > last.
struct LaminaVoxelBox {
    ivec3 first;
    ivec3 last;
};

// Voxels of the part that the triangle's bounding box touches, enlarged by `allowance`.
LaminaVoxelBox laminaVoxelsAround(dvec3 low, dvec3 high, double allowance) {
    dvec3 first = max(ceil(low - (1.0lf + allowance)), dvec3(laminaOverlap.low.xyz));
    dvec3 last = min(floor(high + allowance), dvec3(laminaOverlap.high.xyz));
    // Far-away boxes have bounds that no int holds.
    if (any(greaterThan(first, last)))
        return LaminaVoxelBox(ivec3(0), ivec3(-1));
    return LaminaVoxelBox(ivec3(first), ivec3(last));
}
