// Sums the absorption of each column from the light on, so that a look-up reads a few voxels and not
// all before the point ([CLN11] 3). One invocation owns a column of one face: it walks its slices,
// nearest first, and writes each partial sum to the face's part of the sums. No two invocations share a
// texel: no atomics, no barriers.
layout(local_size_x = 8, local_size_y = 8) in;

#include <lamina/shared/transmittance_block.glsl>

layout(binding = 0) uniform sampler3D laminaAbsorption;
layout(binding = 0, r32f) uniform writeonly image3D laminaSums;
layout(location = 0) uniform int laminaFirstSlice;

void main() {
    ivec3 size = textureSize(laminaAbsorption, 0);
    ivec2 column = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(column, size.xy)))
        return;
    float sum = 0.0;
    for (int k = 0; k < size.z; ++k) {
        sum += texelFetch(laminaAbsorption, ivec3(column, k), 0).r;
        imageStore(laminaSums, ivec3(column, laminaFirstSlice + k), vec4(sum));
    }
}
