// Makes an 8-bit payload of a volume from its half-float sums.
//
// Launch: work groups of 8 x 8 x 1 over columns x, columns y, slices; one invocation owns one voxel:
// reads its sum, writes its mean (absorption: its sum, clamped). No two invocations share a texel.
// permute LAMINA_VOLUME_RESOLVED = LAMINA_VOLUME_ABSORPTION LAMINA_VOLUME_NORMAL LAMINA_VOLUME_COLOR LAMINA_VOLUME_OPTICS
#include <lamina/shared/volume_block.glsl>

layout(local_size_x = 8, local_size_y = 8) in;

#if LAMINA_VOLUME_RESOLVED == LAMINA_VOLUME_ABSORPTION
layout(binding = 0, r16f) uniform readonly restrict image3D laminaSums;
layout(binding = 1, r8) uniform writeonly restrict image3D laminaMeans;
#else
layout(binding = 0, rgba16f) uniform readonly restrict image3D laminaSums;
layout(binding = 1, rgba8) uniform writeonly restrict image3D laminaMeans;
#endif

void main() {
    ivec3 voxel = ivec3(gl_GlobalInvocationID);
    if (any(greaterThanEqual(voxel, imageSize(laminaMeans))))
        return;
    vec4 sum = imageLoad(laminaSums, voxel);
#if LAMINA_VOLUME_RESOLVED == LAMINA_VOLUME_ABSORPTION
    imageStore(laminaMeans, voxel, vec4(clamp(sum.r, 0.0, 1.0)));
#else
    vec4 texel = vec4(0.0);
    if (sum.a > 0.0) {
        vec3 mean = sum.rgb / sum.a;
#if LAMINA_VOLUME_RESOLVED == LAMINA_VOLUME_NORMAL
        float size = length(mean);
        mean = (size > LAMINA_VOLUME_CANCELLED_NORMAL ? mean / size : vec3(0.0)) * 0.5 + 0.5;
#elif LAMINA_VOLUME_RESOLVED == LAMINA_VOLUME_OPTICS
        mean = vec3((mean.x - 1.0) / LAMINA_VOLUME_INDEX_RANGE, mean.y, 0.0);
#endif
        texel = vec4(mean, min(sum.a, 255.0) / 255.0);
    }
    imageStore(laminaMeans, voxel, texel);
#endif
}
