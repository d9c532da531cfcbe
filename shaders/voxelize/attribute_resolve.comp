// Makes the records of a batch of voxels from their sums.
//
// One invocation owns one voxel: divides its sums by the weights' and packs the means. Doubles hold the
// 64-bit sums. Voxels without hits keep a record of zeros, with no normal.
#include <lamina/shared/attribute_block.glsl>
#include <lamina/shared/volume_block.glsl>

layout(local_size_x = 64) in;

layout(std140, binding = LAMINA_ATTRIBUTE_BLOCK_BINDING) uniform LaminaAttributeBlock {
    LaminaAttributeConstants laminaBatch;
};
layout(std430, binding = LAMINA_ATTRIBUTE_RECORDS_BINDING) buffer LaminaRecords {
    uint laminaRecords[];
};
layout(std430, binding = LAMINA_ATTRIBUTE_SUMS_LOW_BINDING) readonly buffer LaminaSumsLow {
    uint laminaSumsLow[];
};
layout(std430, binding = LAMINA_ATTRIBUTE_SUMS_HIGH_BINDING) readonly buffer LaminaSumsHigh {
    uint laminaSumsHigh[];
};

double laminaSum(uint word) {
    return double(laminaSumsHigh[word]) * 4294967296.0lf + double(laminaSumsLow[word]);
}

// The octahedral pair of a unit vector, in [-1,1].
vec2 laminaOctahedralOf(vec3 v) {
    v /= abs(v.x) + abs(v.y) + abs(v.z);
    vec2 folded = (1.0 - abs(v.yx)) * mix(vec2(-1.0), vec2(1.0), greaterThanEqual(v.xy, vec2(0.0)));
    return v.z >= 0.0 ? v.xy : folded;
}

void main() {
    uint slot = (gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x) * gl_WorkGroupSize.x + gl_LocalInvocationIndex;
    if (slot >= laminaBatch.batch.y)
        return;
    uint record = slot * uint(LAMINA_RECORD_WORDS);
    uint first = slot * uint(LAMINA_SUM_WORDS);
    double weight = laminaSum(first + 7u);
    if (weight == 0.0lf) {
        laminaRecords[record + uint(LAMINA_RECORD_NORMAL)] = LAMINA_NO_NORMAL;
        return;
    }
    vec4 color;
    for (int i = 0; i < 4; ++i)
        color[i] = laminaBatch.batch.w != 0u ? laminaBatch.color[i] : float(laminaSum(first + uint(i)) / (weight * double(LAMINA_COLOR_ONE)));
    vec3 normal;
    for (int i = 0; i < 3; ++i)
        normal[i] = float((laminaSum(first + 4u + uint(i)) / weight - double(LAMINA_NORMAL_ZERO)) / double(LAMINA_NORMAL_ONE));
    float size = length(normal);
    laminaRecords[record + uint(LAMINA_RECORD_COLOR)] = packUnorm4x8(color);
    laminaRecords[record + uint(LAMINA_RECORD_NORMAL)] =
        size > LAMINA_VOLUME_CANCELLED_NORMAL ? packSnorm2x16(laminaOctahedralOf(normal / size)) : LAMINA_NO_NORMAL;
    laminaRecords[record + uint(LAMINA_RECORD_MATERIAL)] &= (1u << uint(LAMINA_MATERIAL_BITS)) - 1u;
}
