// Adds the hits of a volume that looks along one axis to the volume that rays march through. Looking along
// three axes in turn, every surface is hit without gaps: one that an axis only grazes faces another.
//
// Launch: 8 x 8 x 1 groups over the voxels; one invocation owns a voxel, so that no two share a texel. The
// first pass writes, the others add: each is a dispatch of its own, with a barrier between. A voxel with
// hits marks the bricks of all voxels whose filtered look-ups reach it; invocations that mark the same brick
// store the same value.
// permute LAMINA_MERGE_OPTICS = 0 1
#include <lamina/shared/refraction_block.glsl>
#include <lamina/volume.glsl>

layout(local_size_x = 8, local_size_y = 8) in;
layout(binding = 0, rgba16f) uniform restrict image3D laminaNormals;
layout(binding = 1, rgba16f) uniform restrict image3D laminaOptics;
layout(binding = 2, r8) uniform writeonly restrict image3D laminaBricks;
layout(location = 0) uniform int laminaAxis;     // 0, 1, 2: x, y, z
layout(location = 1) uniform int laminaIsFirst;

void main() {
    ivec3 voxel = ivec3(gl_GlobalInvocationID);
    if (any(greaterThanEqual(voxel, imageSize(laminaNormals))))
        return;
    ivec3 source = laminaAxis == 0 ? voxel.yzx : (laminaAxis == 1 ? voxel.zxy : voxel);
    vec3 normal = laminaVolumeNormal(source);
    bool isHit = normal != vec3(0.0);
    bool isFirst = laminaIsFirst != 0;
    if (!isHit && !isFirst)
        return;
    // A voxel counts once an axis, however finely the surface is divided into triangles.
    vec4 sum = isHit ? vec4(normal, 1.0) : vec4(0.0);
    imageStore(laminaNormals, voxel, isFirst ? sum : sum + imageLoad(laminaNormals, voxel));
#if LAMINA_MERGE_OPTICS
    vec4 optics = vec4(0.0);
    if (isHit) {
        vec2 body = laminaVolumeOptics(source);
        optics = vec4(body.x, body.y * laminaVolumeColor(source));
    }
    imageStore(laminaOptics, voxel, isFirst ? optics : optics + imageLoad(laminaOptics, voxel));
#endif
    if (!isHit)
        return;
    ivec3 low = max(voxel - 1, 0) / LAMINA_REFRACTION_BRICK;
    ivec3 high = min((voxel + 1) / LAMINA_REFRACTION_BRICK, imageSize(laminaBricks) - 1);
    for (int z = low.z; z <= high.z; ++z)
        for (int y = low.y; y <= high.y; ++y)
            for (int x = low.x; x <= high.x; ++x)
                imageStore(laminaBricks, ivec3(x, y, z), vec4(1.0));
}
