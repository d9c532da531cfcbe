// Adds the surfaces that a volume found looking along one axis to the volume that rays march through. Looking
// along three axes in turn, every surface is hit without gaps: one that an axis only grazes faces another.
//
// A voxel becomes the plane that the surface is in it: the sum of the normals that the axes found, and in alpha
// that of the distances of the voxel's centre outside the surfaces, in voxels. The axis knows where the surface
// crosses it, so that the plane is exact at that point, however coarse the voxels. Optics are those of the last
// axis that found the surface: sums of several materials would be none's.
//
// Launch: 8 x 8 x 1 groups over the voxels; one invocation owns a voxel, so that no two share a texel. The
// first pass writes, the others add: each is a dispatch of its own, with a barrier between. A voxel with
// hits marks the bricks of all voxels whose look-ups reach it; invocations that mark the same brick store the
// same value.
// permute LAMINA_MERGE_OPTICS = 0 1
#include <lamina/shared/refraction_block.glsl>
#include <lamina/volume.glsl>

layout(local_size_x = 8, local_size_y = 8) in;
layout(binding = 0, rgba16f) uniform restrict image3D laminaPlanes;
layout(binding = 1, rgba16f) uniform writeonly restrict image3D laminaOptics;
layout(binding = 2, r8) uniform writeonly restrict image3D laminaBricks;
layout(location = 0) uniform int laminaAxis;     // 0, 1, 2: x, y, z
layout(location = 1) uniform int laminaIsFirst;

void main() {
    ivec3 voxel = ivec3(gl_GlobalInvocationID);
    if (any(greaterThanEqual(voxel, imageSize(laminaPlanes))))
        return;
    ivec3 source = laminaAxis == 0 ? voxel.yzx : (laminaAxis == 1 ? voxel.zxy : voxel);
    // The sums themselves: most voxels hold nothing, and software GL runs the whole of every query.
    vec4 normals = texelFetch(laminaVolumeNormals, source, 0);
    float size = length(normals.xyz);
    bool isHit = size > LAMINA_VOLUME_CANCELLED_NORMAL * normals.a;
    bool isFirst = laminaIsFirst != 0;
    if (!isHit && !isFirst)
        return;
    vec4 optics = texelFetch(laminaVolumeOpticsSums, source, 0) / max(normals.a, 1.0);
    // A voxel counts once an axis, however finely the surface is divided into triangles.
    vec3 normal = normals.xyz / max(size, 1e-20);
    vec4 plane = isHit ? vec4(normal, -optics.z * normal[laminaAxis]) : vec4(0.0);
    imageStore(laminaPlanes, voxel, isFirst ? plane : plane + imageLoad(laminaPlanes, voxel));
#if LAMINA_MERGE_OPTICS
    vec3 color = laminaVolumeColor(source);
    imageStore(laminaOptics, voxel, isHit ? vec4(optics.x, optics.y * color) : vec4(0.0));
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
