// Texels of a part of the grid: 128 slices of a column each. Work groups are laid over columns x, columns
// y and layers, so that no invocation divides.
#include <lamina/shared/solid_block.glsl>

layout(local_size_x = LAMINA_OVERLAP_GROUP_SIZE) in;

layout(std140, binding = LAMINA_SOLID_PART_BINDING) uniform LaminaSolidPartBlock {
    LaminaSolidPart laminaPart;
};

layout(std430, binding = LAMINA_OVERLAP_WORDS_BINDING) buffer LaminaGridTexels {
    uvec4 laminaTexels[];
};

// Columns x, columns y and layers of 128 slices in the part.
ivec3 laminaPartCounts() {
    return ivec3(laminaPart.size.x, laminaPart.high.y - laminaPart.low.y + 1, (laminaPart.high.z >> 7) - (laminaPart.low.z >> 7) + 1);
}

// Index in the bindings of a column's texel; all three from the part's first on.
uint laminaPartIndex(int x, int y, int layer) {
    ivec3 counts = laminaPartCounts();
    return (uint(layer) * uint(counts.y) + uint(y)) * uint(counts.x) + uint(x) + uint(laminaPart.low.w);
}

// Column x, column y and layer of this invocation, from the part's first on; false outside the part.
bool laminaPartPlace(out ivec3 place) {
    place = ivec3(gl_GlobalInvocationID);
    return place.x < laminaPart.size.x;
}

// The bits of a layer that stand for slices of the grid.
uvec4 laminaSliceBits(int layer) {
    ivec4 counts = clamp(laminaPart.size.z - laminaPart.low.z - layer * 128 - ivec4(0, 32, 64, 96), ivec4(0), ivec4(32));
    // A shift by 32 is undefined.
    return mix(uvec4(0xffffffffu) >> uvec4((32 - counts) & 31), uvec4(0u), equal(counts, ivec4(0)));
}
