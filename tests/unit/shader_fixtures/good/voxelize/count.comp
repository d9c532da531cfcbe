#version 450 core
#include <lamina/bits.glsl>
layout(local_size_x = 64) in;
layout(std430, binding = 0) buffer Counts { uint counts[]; };

void main() {
    atomicAdd(counts[gl_GlobalInvocationID.x], bitOf(int(gl_LocalInvocationIndex)));
}
