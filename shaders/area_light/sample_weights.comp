// Weighs triangles for point samples, area over squared distance from the light, and sums the weights of each
// block of triangles ([WD13] 3.1.2).
//
// Launch: a work group a block of LAMINA_SAMPLE_BLOCK_TRIANGLES captured triangles. An invocation owns four:
//   1. copies them to world space, beside those of the other sources, and weighs them; triangles that were not
//      drawn (NaN) or have no area weigh nothing;
//   2. barrier: the group sums the invocations' weights by halving steps, a barrier after each;
//   3. stores the sum up to and with each triangle; the last invocation the block's.
#include <lamina/shared/imperfect_block.glsl>

layout(local_size_x = LAMINA_SAMPLE_GROUP_SIZE) in;

layout(std140, binding = LAMINA_SAMPLE_UNIFORM_BINDING) uniform LaminaSampleBlock {
    LaminaSampleConstants laminaSample;
};
layout(std430, binding = LAMINA_SAMPLE_CAPTURE_BINDING) readonly buffer LaminaCaptureBlock {
    float laminaCaptured[];
};
layout(std430, binding = LAMINA_SAMPLE_TRIANGLE_BINDING) writeonly buffer LaminaTriangleBlock {
    float laminaTriangles[];
};
layout(std430, binding = LAMINA_SAMPLE_WEIGHT_BINDING) writeonly buffer LaminaWeightBlock {
    float laminaWeights[];
};
layout(std430, binding = LAMINA_SAMPLE_BLOCK_BINDING) writeonly buffer LaminaBlockBlock {
    float laminaBlocks[];
};

shared float laminaSums[LAMINA_SAMPLE_GROUP_SIZE];

float weigh(uint captured, uint index) {
    if (captured >= laminaSample.counts.x)
        return 0.0;
    vec3 corners[3];
    for (int i = 0; i < 3; ++i) {
        uint word = captured * 9u + uint(i) * 3u;
        vec3 place = vec3(laminaCaptured[word], laminaCaptured[word + 1u], laminaCaptured[word + 2u]);
        corners[i] = (laminaSample.toWorld * vec4(place, 1.0)).xyz;
        for (int axis = 0; axis < 3; ++axis)
            laminaTriangles[index * 9u + uint(i * 3 + axis)] = corners[i][axis];
    }
    float area = 0.5 * length(cross(corners[1] - corners[0], corners[2] - corners[0]));
    vec3 away = (corners[0] + corners[1] + corners[2]) / 3.0 - laminaSample.light.xyz;
    float least = laminaSample.light.w;
    float weight = least > 0.0 ? area / max(dot(away, away), least * least) : area;
    return weight < 1e30 ? weight : 0.0;
}

void main() {
    const uint kOwn = uint(LAMINA_SAMPLE_BLOCK_TRIANGLES / LAMINA_SAMPLE_GROUP_SIZE);
    uint local = gl_LocalInvocationID.x * kOwn;
    uint block = laminaSample.counts.y + gl_WorkGroupID.x;
    float weights[kOwn];
    float sum = 0.0;
    for (uint i = 0u; i < kOwn; ++i) {
        uint offset = local + i;
        sum += weigh(gl_WorkGroupID.x * uint(LAMINA_SAMPLE_BLOCK_TRIANGLES) + offset,
                     block * uint(LAMINA_SAMPLE_BLOCK_TRIANGLES) + offset);
        weights[i] = sum;
    }
    uint self = gl_LocalInvocationID.x;
    laminaSums[self] = sum;
    barrier();
    for (uint reach = 1u; reach < uint(LAMINA_SAMPLE_GROUP_SIZE); reach *= 2u) {
        float before = self >= reach ? laminaSums[self - reach] : 0.0;
        barrier();
        laminaSums[self] += before;
        barrier();
    }
    float before = self > 0u ? laminaSums[self - 1u] : 0.0;
    for (uint i = 0u; i < kOwn; ++i)
        laminaWeights[block * uint(LAMINA_SAMPLE_BLOCK_TRIANGLES) + local + i] = before + weights[i];
    if (self == uint(LAMINA_SAMPLE_GROUP_SIZE) - 1u)
        laminaBlocks[block] = laminaSums[self];
}
