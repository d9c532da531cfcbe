// Packs the hit counts of a volume to bits: a voxel is set if anything hits it.
//
// Launch: work groups of 8 x 8 x 1 over columns x, columns y and groups of 128 slices; one invocation
// owns one texel of the grid, reads its counts and writes its 128 bits. No two share a texel.
#include <lamina/shared/constants.glsl>

layout(local_size_x = 8, local_size_y = 8) in;

layout(binding = 0) uniform sampler3D laminaCounts;
layout(binding = 0, rgba32ui) uniform writeonly restrict uimage2DArray laminaWords;

void main() {
    ivec3 place = ivec3(gl_GlobalInvocationID);
    ivec3 size = textureSize(laminaCounts, 0);
    if (any(greaterThanEqual(place.xy, size.xy)))
        return;
    uvec4 bits = uvec4(0u);
    for (int word = 0; word < 4; ++word) {
        int first = place.z * LAMINA_SLICES_PER_GROUP + word * 32;
        int end = min(first + 32, size.z);
        for (int slice = first; slice < end; ++slice)
            if (texelFetch(laminaCounts, ivec3(place.xy, slice), 0).r > 0.0)
                bits[word] |= 1u << uint(slice - first);
    }
    imageStore(laminaWords, place, bits);
}
