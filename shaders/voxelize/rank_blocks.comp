// Turns the counts of rank.comp's blocks into ranks, and appends the number of set voxels.
//
// One work group owns them all, an invocation a run of consecutive blocks:
//   1. sum up its run and share the sum;
//   2. after the barrier, sum up the invocations before it, and replace each count by what comes before.
// Sums beyond 32 bits stay at LAMINA_RANK_OVERFLOW.
#include <lamina/shared/attribute_block.glsl>

layout(local_size_x = LAMINA_RANK_GROUP_SIZE) in;

layout(location = 0) uniform int laminaBlockEnd;

layout(std430, binding = LAMINA_RANK_BLOCKS_BINDING) buffer LaminaBlockCounts {
    uint laminaBlockCounts[];
};

shared uint laminaSums[LAMINA_RANK_GROUP_SIZE];

uint laminaAdd(uint a, uint b) {
    uint carry;
    uint sum = uaddCarry(a, b, carry);
    return carry != 0u ? LAMINA_RANK_OVERFLOW : sum;
}

void main() {
    int run = (laminaBlockEnd + LAMINA_RANK_GROUP_SIZE - 1) / LAMINA_RANK_GROUP_SIZE;
    int begin = min(int(gl_LocalInvocationIndex) * run, laminaBlockEnd);
    int end = min(begin + run, laminaBlockEnd);
    uint sum = 0u;
    for (int i = begin; i < end; ++i)
        sum = laminaAdd(sum, laminaBlockCounts[i]);
    laminaSums[gl_LocalInvocationIndex] = sum;
    barrier();
    uint before = 0u;
    for (uint i = 0u; i < gl_LocalInvocationIndex; ++i)
        before = laminaAdd(before, laminaSums[i]);
    for (int i = begin; i < end; ++i) {
        uint count = laminaBlockCounts[i];
        laminaBlockCounts[i] = before;
        before = laminaAdd(before, count);
    }
    if (gl_LocalInvocationIndex == uint(LAMINA_RANK_GROUP_SIZE - 1))
        laminaBlockCounts[laminaBlockEnd] = before;
}
