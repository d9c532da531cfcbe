// Turns the blocks' weights into sums up to and with each block.
//
// Launch: one work group. An invocation owns a run of blocks:
//   1. sums its run; barrier;
//   2. the group sums the runs by halving steps, a barrier after each;
//   3. each stores its run's sums.
#include <lamina/shared/imperfect_block.glsl>

layout(local_size_x = LAMINA_SAMPLE_GROUP_SIZE) in;

layout(std140, binding = LAMINA_SAMPLE_UNIFORM_BINDING) uniform LaminaSampleBlock {
    LaminaSampleConstants laminaSample;
};
layout(std430, binding = LAMINA_SAMPLE_BLOCK_BINDING) buffer LaminaBlockBlock {
    float laminaBlocks[];
};

shared float laminaSums[LAMINA_SAMPLE_GROUP_SIZE];

void main() {
    uint count = laminaSample.counts.z;
    uint self = gl_LocalInvocationID.x;
    uint run = (count + uint(LAMINA_SAMPLE_GROUP_SIZE) - 1u) / uint(LAMINA_SAMPLE_GROUP_SIZE);
    uint first = min(self * run, count);
    uint end = min(first + run, count);
    float sum = 0.0;
    for (uint i = first; i < end; ++i)
        sum += laminaBlocks[i];
    laminaSums[self] = sum;
    barrier();
    for (uint reach = 1u; reach < uint(LAMINA_SAMPLE_GROUP_SIZE); reach *= 2u) {
        float before = self >= reach ? laminaSums[self - reach] : 0.0;
        barrier();
        laminaSums[self] += before;
        barrier();
    }
    float before = self > 0u ? laminaSums[self - 1u] : 0.0;
    for (uint i = first; i < end; ++i) {
        before += laminaBlocks[i];
        laminaBlocks[i] = before;
    }
}
