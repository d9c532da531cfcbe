// The part of each face of the light's map that holds visible points: least x and y, greatest x and y, as
// integers in the order of the floats, for atomics.
#include <shadow_volumes/frame.glsl>

layout(std430, binding = LAMINA_SHADOW_BOUNDS_BINDING) LAMINA_SHADOW_BOUNDS_ACCESS buffer LaminaShadowBounds {
    uvec4 laminaBounds[];
};

uint laminaOrdered(float value) {
    uint bits = floatBitsToUint(value);
    return (bits & 0x80000000u) != 0u ? ~bits : bits | 0x80000000u;
}

float laminaUnordered(uint bits) {
    return uintBitsToFloat((bits & 0x80000000u) != 0u ? bits & 0x7fffffffu : ~bits);
}

bool laminaFaceEmpty(uint face) {
    return laminaBounds[face].x > laminaBounds[face].z;
}

// Texels of the map from face coordinates: (position - corner) * scale + 1, a rim of one texel around.
struct LaminaFaceMap {
    vec2 corner;
    vec2 scale;
};

LaminaFaceMap laminaFaceMap(uint face) {
    uvec4 bounds = laminaBounds[face];
    vec2 least = vec2(laminaUnordered(bounds.x), laminaUnordered(bounds.y));
    vec2 greatest = vec2(laminaUnordered(bounds.z), laminaUnordered(bounds.w));
    vec2 extent = max(greatest - least, 1e-6 * max(max(abs(least), abs(greatest)), 1e-20));
    return LaminaFaceMap(least, (float(laminaFrame.size.z) - 2.0) / extent);
}

// Texel coordinates, homogeneous.
vec3 laminaToTexel(LaminaFaceMap map, vec3 position) {
    return vec3((position.xy - map.corner * position.z) * map.scale + position.z, position.z);
}
