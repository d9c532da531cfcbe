// Queries over voxelized shadow volumes (VSVs), for every shader stage of an engine that may read
// storage buffers. [WD13] 2.6, 3.3 and appendix A.
//
//   #define LAMINA_EPIPOLAR_BLOCK_BINDING 3  // shader storage buffer (default 0)
//   #define LAMINA_EPIPOLAR_TEXTURE_UNIT 5   // texture unit (default 0)
//   #include <lamina/epipolar.glsl>
//
// EpipolarGrid::bind() fills both. Below, `vsv` is the index of a shadow volume in its grid, and
// "coordinates" are continuous voxel coordinates (alpha, theta, phi): voxel i of an axis covers [i, i+1).
// An eye ray has constant alpha and theta: its phi samples are the bits of one texel, in order.
//
// Queries about a world point clamp its coordinates to the volume. The grid's alpha and phi bias apply
// to all of them, and so does its epipole rule: within that angle of the light the point is taken to be
// what the eye sees, so it and all before it are lit exactly if it lies beyond the light.
//
// Precision: single. A point within about 1e-3 voxels of a voxel's face may answer for its neighbour.
#ifndef LAMINA_EPIPOLAR_GLSL
#define LAMINA_EPIPOLAR_GLSL

#include <lamina/bits.glsl>
#include <lamina/shared/epipolar_block.glsl>

#ifndef LAMINA_EPIPOLAR_BLOCK_BINDING
#define LAMINA_EPIPOLAR_BLOCK_BINDING 0
#endif
#ifndef LAMINA_EPIPOLAR_TEXTURE_UNIT
#define LAMINA_EPIPOLAR_TEXTURE_UNIT 0
#endif

layout(std430, binding = LAMINA_EPIPOLAR_BLOCK_BINDING) readonly buffer LaminaEpipolarBlock {
    LaminaEpipolarSpace laminaEpipolarSpaces[];
};

layout(binding = LAMINA_EPIPOLAR_TEXTURE_UNIT) uniform usampler2DArray laminaEpipolarWords;

// Voxels along alpha, theta, phi.
ivec3 laminaEpipolarSize(int vsv) {
    return ivec3(laminaEpipolarSpaces[vsv].size.xyz);
}

// Coordinates of a world point; not clamped, without bias.
vec3 laminaEpipolarCoordinates(int vsv, vec3 world) {
    vec4 eye = laminaEpipolarSpaces[vsv].eye;
    vec3 point = world - eye.xyz;
    float along = dot(point, laminaEpipolarSpaces[vsv].axis.xyz);
    vec2 across = vec2(dot(point, laminaEpipolarSpaces[vsv].u.xyz), dot(point, laminaEpipolarSpaces[vsv].v.xyz));
    float distance = length(across);
    bool isDirectional = (laminaEpipolarSpaces[vsv].size.w & LAMINA_EPIPOLAR_DIRECTIONAL) != 0u;
    vec3 angles = vec3(atan(distance, along), distance > 0.0 ? atan(across.y, across.x) : 0.0,
                       isDirectional ? distance : atan(distance, eye.w - along));
    return (angles - laminaEpipolarSpaces[vsv].origin.xyz) * laminaEpipolarSpaces[vsv].scale.xyz;
}

// The shadow bits of phi samples [n group, n group + n) of an eye ray, n = laminaEpipolarSpaces[vsv].tile.z:
// 1 is shadowed. alpha is clamped; theta wraps in a full circle, else it is clamped. `group` in range.
uvec4 laminaEpipolarBits(int vsv, ivec2 alphaTheta, int group) {
    uvec4 size = laminaEpipolarSpaces[vsv].size;
    ivec2 last = ivec2(size.xy) - 1;
    ivec2 place = alphaTheta;
    if ((size.w & LAMINA_EPIPOLAR_FULL_CIRCLE) != 0u)
        place.y = place.y < 0 ? place.y + last.y + 1 : (place.y > last.y ? place.y - last.y - 1 : place.y);
    place = clamp(place, ivec2(0), last);
    return texelFetch(laminaEpipolarWords, ivec3(place + ivec2(laminaEpipolarSpaces[vsv].tile.xy), group), 0);
}

// One bit of 128: is it in shadow?
uint laminaEpipolarBit(uvec4 bits, int index) {
    return laminaBit(bits, index);
}

// Number of bits set below `count` (clamped to [0, 128]).
int laminaEpipolarCountBelow(uvec4 bits, int count) {
    return laminaBitCount(bits & laminaMaskBelow(count));
}

// Index of the last bit not set below `count` (clamped to [0, 128]); -1 for none.
int laminaEpipolarLastClearBelow(uvec4 bits, int count) {
    uvec4 clear = ~bits & laminaMaskBelow(count);
    if ((clear.z | clear.w) != 0u)
        return clear.w != 0u ? 96 + findMSB(clear.w) : 64 + findMSB(clear.z);
    return clear.y != 0u ? 32 + findMSB(clear.y) : findMSB(clear.x);
}

// Is a voxel shadowed? Clamped to the volume.
bool laminaEpipolarVoxelShadowed(int vsv, ivec3 voxel) {
    int bitsPerTexel = int(laminaEpipolarSpaces[vsv].tile.z);
    int phi = clamp(voxel.z, 0, int(laminaEpipolarSpaces[vsv].size.z) - 1);
    uvec4 bits = laminaEpipolarBits(vsv, voxel.xy, phi / bitsPerTexel);
    return laminaEpipolarBit(bits, phi % bitsPerTexel) != 0u;
}

// Does the epipole rule decide this point? Then `isLit` is its answer.
bool laminaEpipoleRule(int vsv, vec3 world, out bool isLit) {
    vec3 point = world - laminaEpipolarSpaces[vsv].eye.xyz;
    vec4 axis = laminaEpipolarSpaces[vsv].axis;
    float along = dot(point, axis.xyz);
    isLit = along >= laminaEpipolarSpaces[vsv].u.w;
    return atan(length(point - along * axis.xyz), along) < axis.w;
}

// Biased coordinates, clamped in alpha and phi.
vec3 laminaEpipolarPlace(int vsv, vec3 world) {
    vec3 place = laminaEpipolarCoordinates(vsv, world) + laminaEpipolarSpaces[vsv].bias.xyz;
    vec3 size = vec3(laminaEpipolarSpaces[vsv].size.xyz);
    return vec3(clamp(place.x, 0.0, size.x), place.y, clamp(place.z, 0.0, size.z));
}

// Is a world point lit? The answer of the voxel that holds it.
bool laminaEpipolarLit(int vsv, vec3 world) {
    bool isLit;
    if (laminaEpipoleRule(vsv, world, isLit))
        return isLit;
    return !laminaEpipolarVoxelShadowed(vsv, ivec3(floor(laminaEpipolarPlace(vsv, world))));
}

// laminaEpipolarLitInterpolated() at biased coordinates, alpha and phi within the volume.
float laminaEpipolarLitInterpolatedAt(int vsv, vec3 place) {
    vec2 low = floor(place.yz - 0.5);
    vec2 weight = place.yz - 0.5 - low;
    int bitsPerTexel = int(laminaEpipolarSpaces[vsv].tile.z);
    int last = int(laminaEpipolarSpaces[vsv].size.z) - 1;
    ivec2 phi = clamp(ivec2(low.y, low.y + 1.0), 0, last);
    ivec2 group = phi / bitsPerTexel;
    ivec2 bit = phi - group * bitsPerTexel;
    ivec2 at = ivec2(floor(place.x), low.x);
    uvec4 first = laminaEpipolarBits(vsv, at, group.x);
    uvec4 second = laminaEpipolarBits(vsv, at + ivec2(0, 1), group.x);
    uvec4 shadowed;
    shadowed.xy = uvec2(laminaEpipolarBit(first, bit.x), laminaEpipolarBit(second, bit.x));
    if (group.y != group.x) {
        first = laminaEpipolarBits(vsv, at, group.y);
        second = laminaEpipolarBits(vsv, at + ivec2(0, 1), group.y);
    }
    shadowed.zw = uvec2(laminaEpipolarBit(first, bit.y), laminaEpipolarBit(second, bit.y));
    float both = weight.x * weight.y;
    vec4 weights = vec4(1.0 - weight.x - weight.y + both, weight.x - both, weight.y - both, both);
    return dot(mix(weights, vec4(0.0), greaterThan(shadowed, uvec4(0u))), vec4(1.0));
}

// The lit share in [0,1] of a world point, interpolated between the centres of its four neighbours in
// theta and phi. alpha is never interpolated: along it visibility changes once, at the occluder.
float laminaEpipolarLitInterpolated(int vsv, vec3 world) {
    bool isLit;
    if (laminaEpipoleRule(vsv, world, isLit))
        return float(isLit);
    return laminaEpipolarLitInterpolatedAt(vsv, laminaEpipolarPlace(vsv, world));
}

// Shadowed phi samples of the eye ray of texel `at` before phi coordinate `end` in [0, phi samples], the
// last one in part, divided by `end`. Interpolated: the bits are values at the samples' centres, linear
// between them.
float laminaEpipolarFractionOfRay(int vsv, ivec2 at, float end, bool interpolate) {
    int bitsPerTexel = int(laminaEpipolarSpaces[vsv].tile.z);
    int last = int(laminaEpipolarSpaces[vsv].size.z) - 1;
    int whole = clamp(int(floor(interpolate ? end - 0.5 : end)), 0, last);
    int count = 0;
    uvec4 bits = uvec4(0u);
    int lastGroup = whole / bitsPerTexel;
    for (int group = 0; group <= lastGroup; ++group) {
        bits = laminaEpipolarBits(vsv, at, group);
        count += laminaEpipolarCountBelow(bits, min(whole - group * bitsPerTexel, bitsPerTexel));
    }
    float value = float(laminaEpipolarBit(bits, whole - lastGroup * bitsPerTexel));
    const float kLeast = 1.0 / 1024.0;
    if (end < kLeast)
        return value;
    if (!interpolate)
        return (float(count) + (end - float(whole)) * value) / end;
    if (end < 0.5)
        return value;
    int next = min(whole + 1, last);
    if (next / bitsPerTexel != lastGroup)
        bits = laminaEpipolarBits(vsv, at, next / bitsPerTexel);
    float nextValue = float(laminaEpipolarBit(bits, next % bitsPerTexel));
    float part = end - 0.5 - float(whole);
    return (float(count) + (0.5 + part) * value + 0.5 * part * part * (nextValue - value)) / end;
}

// The shadowed share in [0,1] of the eye ray from the eye to a world point, in equal steps of phi: for a
// directional light that is the share of its length, for a point light each stretch counts as it is lit
// (by the inverse square of its distance to the light).
float laminaEpipolarShadowedFraction(int vsv, vec3 world) {
    bool isLit;
    if (laminaEpipoleRule(vsv, world, isLit))
        return float(!isLit);
    vec3 place = laminaEpipolarPlace(vsv, world);
    return laminaEpipolarFractionOfRay(vsv, ivec2(floor(place.xy)), place.z, false);
}

// The same, interpolated in theta and phi.
float laminaEpipolarShadowedFractionInterpolated(int vsv, vec3 world) {
    bool isLit;
    if (laminaEpipoleRule(vsv, world, isLit))
        return float(!isLit);
    vec3 place = laminaEpipolarPlace(vsv, world);
    float low = floor(place.y - 0.5);
    ivec2 at = ivec2(floor(place.x), low);
    return mix(laminaEpipolarFractionOfRay(vsv, at, place.z, true),
               laminaEpipolarFractionOfRay(vsv, at + ivec2(0, 1), place.z, true), place.y - 0.5 - low);
}

#endif
