// Light of virtual point lights in a homogeneous medium, shadowed by voxelized shadow volumes, for the
// engine's own shaders: the sums that AreaLight::apply() gathers, light by light. [WD13] 2.1, 3.1.5, 3.3.
//
//   #define LAMINA_EPIPOLAR_BLOCK_BINDING 3     // shader storage buffer of the shadow volumes (default 0)
//   #define LAMINA_EPIPOLAR_TEXTURE_UNIT 5      // their texture unit (default 0)
//   #define LAMINA_AREA_LIGHT_BLOCK_BINDING 4   // shader storage buffer of the lights (default 1)
//   #include <lamina/area_light.glsl>
//
// AreaLight::bind() fills the three.
//
//   vec3 sum = vec3(0.0);
//   for (int i = 0; i < laminaVirtualLightCount(); ++i)    // light i owns shadow volume i
//       sum += laminaAirlight(i, i, laminaLightRay(i, i, world, normal));
//   color = color * laminaTransmittance(distance) + sum;
//
// Below, `light` is a virtual light, `vsv` its shadow volume, `world` the point that the eye sees.
#ifndef LAMINA_AREA_LIGHT_GLSL
#define LAMINA_AREA_LIGHT_GLSL

#include <lamina/airlight.glsl>
#include <lamina/epipolar.glsl>
#include <lamina/shared/area_light_block.glsl>

#ifndef LAMINA_AREA_LIGHT_BLOCK_BINDING
#define LAMINA_AREA_LIGHT_BLOCK_BINDING 1
#endif

layout(std430, binding = LAMINA_AREA_LIGHT_BLOCK_BINDING) readonly buffer LaminaAreaLightBlock {
    LaminaAreaLightConstants laminaAreaLight;
    LaminaVirtualLight laminaVirtualLights[];
};

int laminaVirtualLightCount() {
    return int(laminaAreaLight.counts.x);
}

bool laminaIsInterpolated() {
    return (laminaAreaLight.counts.y & LAMINA_AREA_LIGHT_INTERPOLATE) != 0u;
}

// The share of light that a stretch of the medium lets through.
float laminaTransmittance(float distance) {
    return exp(-laminaAreaLight.medium.w * distance);
}

// Weighted shadowed samples and weights of one word of phi samples: sums.x and sums.y. Weights are computed
// between groups of samples and interpolated for the halves of each.
// shares: of each sample's bit in the two texels of neighbouring theta. inside: samples of the word before the
// end of the ray, up to 32. psi, weight: cosine and sine of psi (or distance, x) at the word's begin, and
// the weight there; turn: from one group to the next.
void laminaWeighWord(LaminaAirlightRay ray, uvec2 words, vec2 shares, float inside, inout vec2 psi,
                     inout float weight, vec2 turn, inout vec2 sums) {
    const int kBits = LAMINA_AIRLIGHT_BITS_PER_WEIGHT;
    const int kHalf = kBits / 2;
    if (inside <= 0.0)
        return;
    int whole = int(inside);
    uvec2 kept = whole < 32 ? words & ((1u << uint(whole)) - 1u) : words;
    float last = whole < 32 ? (inside - float(whole)) * dot(vec2(words >> uint(whole) & 1u), shares) : 0.0;
    for (int shift = 0; shift < 32; shift += kBits) {
        float rest = inside - float(shift);
        if (rest <= 0.0)
            break;
        psi = ray.isDirectional ? psi + turn
                                : vec2(psi.x * turn.x - psi.y * turn.y, psi.y * turn.x + psi.x * turn.y);
        float next = laminaAirlightDensity(ray, psi);
        vec2 weights = vec2(mix(weight, next, 0.25), mix(weight, next, 0.75));
        weight = next;
        vec2 counts = clamp(vec2(rest, rest - float(kHalf)), 0.0, float(kHalf));
        vec2 shadowed;
        shadowed.x = dot(vec2(bitCount(bitfieldExtract(kept, shift, kHalf))), shares);
        shadowed.y = dot(vec2(bitCount(bitfieldExtract(kept, shift + kHalf, kHalf))), shares);
        // The sample that the ray ends in.
        shadowed.x += rest <= float(kHalf) ? last : 0.0;
        shadowed.y += rest > float(kHalf) && rest <= float(kBits) ? last : 0.0;
        sums += vec2(dot(weights, shadowed), dot(weights, counts));
    }
}

// The sample of a texel's eye ray from which on its bits are no shadows on a ray that ends at phi coordinate
// `end`, but those of the very surface that this ray reaches: a bit is the visibility at its voxel's centre, and
// the ray through the centres meets the surface elsewhere, at `surface`. Counted as shadows they would darken
// all light by a part of a voxel, 5 to 10 % of the strength of weak shadows at 128 samples.
// So a last run of shadowed samples that begins behind `surface` is lit; one that begins before is a shadow.
// The plane seen in a pixel says little about what is more than a few samples away.
int laminaOwnShadow(int vsv, ivec2 at, float end, float surface) {
    int bitsPerTexel = int(laminaEpipolarSpaces[vsv].tile.z);
    int samples = int(ceil(end));
    int least = max(samples - LAMINA_AIRLIGHT_OWN_SHADOW, 0);
    int begin = samples;
    for (int group = (samples - 1) / bitsPerTexel; group >= 0 && begin > least; --group) {
        int first = group * bitsPerTexel;
        int last = laminaEpipolarLastClearBelow(laminaEpipolarBits(vsv, at, group), min(samples - first, bitsPerTexel));
        begin = first + last + 1;
        if (last >= 0)
            break;
    }
    return float(begin) + 0.5 < surface ? samples : max(begin, least);
}

// The shadowed share in [0,1] of the airlight between the eye and phi coordinate `end` (samples): of all
// samples alike (the paper's factored average), or each group of samples by its part in the unshadowed
// airlight, which makes the product of both the integral of the voxelized visibility.
// at: texel; shares: of it and of its neighbour in theta. ends: samples from which on they count as lit.
float laminaShadowedShare(int vsv, LaminaAirlightRay ray, ivec2 at, vec2 shares, float end, ivec2 ends) {
    int bitsPerTexel = int(laminaEpipolarSpaces[vsv].tile.z);
    float phiStep = 1.0 / laminaEpipolarSpaces[vsv].scale.z;
    float phiZero = laminaEpipolarSpaces[vsv].origin.z;
    bool isWeighted = (laminaAreaLight.counts.y & LAMINA_AREA_LIGHT_FACTORED) == 0u;
    bool isInterpolated = shares.y != 0.0;
    int groups = int(ceil(end / float(bitsPerTexel)));
    vec2 sums = vec2(0.0);
    for (int group = 0; group < groups; ++group) {
        float first = float(group * bitsPerTexel);
        uvec4 low = laminaEpipolarBits(vsv, at, group);
        low &= laminaMaskBelow(ends.x - group * bitsPerTexel);
        uvec4 high = isInterpolated ? laminaEpipolarBits(vsv, at + ivec2(0, 1), group) : low;
        high &= laminaMaskBelow(ends.y - group * bitsPerTexel);
        float inside = min(end - first, float(bitsPerTexel));
        uvec4 set = low | high;
        if (group == 0 && groups == 1 && (set.x | set.y | set.z | set.w) == 0u)
            return 0.0;
        if (isWeighted) {
            vec2 psi = laminaAirlightPsi(ray, phiZero + first * phiStep);
            float weight = laminaAirlightDensity(ray, psi);
            float angle = float(LAMINA_AIRLIGHT_BITS_PER_WEIGHT) * phiStep;
            vec2 turn = ray.isDirectional ? vec2(angle, 0.0) : vec2(cos(angle), sin(angle));
            vec4 parts = clamp(inside - vec4(0.0, 32.0, 64.0, 96.0), 0.0, 32.0);
            laminaWeighWord(ray, uvec2(low.x, high.x), shares, parts.x, psi, weight, turn, sums);
            laminaWeighWord(ray, uvec2(low.y, high.y), shares, parts.y, psi, weight, turn, sums);
            laminaWeighWord(ray, uvec2(low.z, high.z), shares, parts.z, psi, weight, turn, sums);
            laminaWeighWord(ray, uvec2(low.w, high.w), shares, parts.w, psi, weight, turn, sums);
        } else {
            int whole = int(inside);
            vec2 counts = vec2(laminaEpipolarCountBelow(low, whole), laminaEpipolarCountBelow(high, whole));
            int last = min(whole, bitsPerTexel - 1);
            counts += (inside - float(whole)) * vec2(laminaEpipolarBit(low, last), laminaEpipolarBit(high, last));
            sums += vec2(dot(counts, shares), inside);
        }
    }
    return sums.y > 0.0 ? sums.x / sums.y : 0.0;
}

// What the eye ray to `world` means to a light: shared by airlight and surface.
struct LaminaLightRay {
    LaminaAirlightRay air;
    // Continuous coordinates in the shadow volume, without bias.
    vec3 place;
    // Does the epipole rule decide, and how?
    bool isRuled;
    bool isLit;
    // Phi samples by which the surface seen recedes along eye rays of one voxel more alpha, and theta.
    vec2 slope;
};

// By how much phi grows on a plane with alpha, and with theta (radians; phi of a directional light: world units).
// normal: along the axis, along the ray's side of it, and at right angles to both; of any length. along, apart: the
// point, from the eye. Along an eye ray w the plane's distance is c / dot(normal, w).
vec2 laminaPlaneSlope(LaminaAirlightRay ray, vec3 normal, float along, float apart, float lightDistance) {
    float square = along * along + apart * apart;
    float range = sqrt(square);
    float towards = normal.x * ray.cosAlpha + normal.y * ray.sinAlpha;
    towards += (towards < 0.0 ? -1e-3 : 1e-3) * length(normal);
    vec2 farther = range / towards * vec2(normal.x * ray.sinAlpha - normal.y * ray.cosAlpha, -normal.z * ray.sinAlpha);
    if (ray.isDirectional)
        return vec2(along, 0.0) + ray.sinAlpha * farther;
    vec2 turned = vec2(lightDistance * along - square, 0.0) + lightDistance * ray.sinAlpha * farther;
    return turned / (square + lightDistance * (lightDistance - 2.0 * along));
}

// normal: of the surface seen at `world`, of any length and side; zero for none.
LaminaLightRay laminaLightRay(int light, int vsv, vec3 world, vec3 normal) {
    LaminaLightRay ray;
    vec4 eye = laminaEpipolarSpaces[vsv].eye;
    vec3 axis = laminaEpipolarSpaces[vsv].axis.xyz;
    vec3 point = world - eye.xyz;
    float along = dot(point, axis);
    vec3 u = laminaEpipolarSpaces[vsv].u.xyz;
    vec3 v = laminaEpipolarSpaces[vsv].v.xyz;
    vec2 sides = vec2(dot(point, u), dot(point, v));
    float apart = length(sides);
    vec2 unit = apart > 0.0 ? sides / apart : vec2(1.0, 0.0);
    vec3 across = unit.x * u + unit.y * v;
    ray.air = laminaAirlightRay(laminaAreaLight.medium.w, laminaAreaLight.phase.x, axis, across,
                                along, apart, eye.w, laminaVirtualLights[light].normal.xyz,
                                laminaVirtualLights[light].intensity.w, laminaVirtualLights[light].normal.w);
    bool isDirectional = eye.w == 0.0;
    float phi = isDirectional ? apart : atan(apart, eye.w - along);
    vec3 angles = vec3(ray.air.alpha, atan(unit.y, unit.x), phi);
    ray.place = (angles - laminaEpipolarSpaces[vsv].origin.xyz) * laminaEpipolarSpaces[vsv].scale.xyz;
    ray.isRuled = ray.air.alpha < laminaEpipolarSpaces[vsv].axis.w;
    // A light that lies on the surface seen is not behind it.
    ray.isLit = along * 1.001 >= laminaEpipolarSpaces[vsv].u.w;
    ray.slope = vec2(0.0);
    if (normal != vec3(0.0))
        ray.slope = laminaPlaneSlope(ray.air, vec3(dot(normal, axis), dot(normal, across), dot(normal, cross(axis, across))),
                                     along, apart, eye.w) *
                    laminaEpipolarSpaces[vsv].scale.z / laminaEpipolarSpaces[vsv].scale.xy;
    return ray;
}

// The ray to a point of which no surface is known.
LaminaLightRay laminaLightRay(int light, int vsv, vec3 world) {
    return laminaLightRay(light, vsv, world, vec3(0.0));
}

// Phi coordinates of the surface seen, on the rays through the centres of a texel and of its neighbour in theta.
vec2 laminaPlanePhi(LaminaLightRay ray, ivec2 at) {
    vec2 across = vec2(0.0, 1.0) + float(at.y) + 0.5 - ray.place.y;
    return ray.place.z + ray.slope.x * (float(at.x) + 0.5 - ray.place.x) + ray.slope.y * across;
}

// The lit share in [0,1] of the surface point that the ray ends at, with the grid's biases.
float laminaSurfaceVisibility(int vsv, LaminaLightRay ray) {
    if (ray.isRuled)
        return float(ray.isLit);
    vec3 size = vec3(laminaEpipolarSpaces[vsv].size.xyz);
    vec3 place = ray.place + laminaEpipolarSpaces[vsv].bias.xyz;
    place = vec3(clamp(place.x, 0.0, size.x), place.y, clamp(place.z, 0.0, size.z));
    return laminaIsInterpolated() ? laminaEpipolarLitInterpolatedAt(vsv, place)
                                  : float(!laminaEpipolarVoxelShadowed(vsv, ivec3(floor(place))));
}

float laminaAirlightVisibility(int vsv, LaminaLightRay ray) {
    if (ray.isRuled)
        return float(ray.isLit);
    vec3 size = vec3(laminaEpipolarSpaces[vsv].size.xyz);
    float alpha = floor(clamp(ray.place.x, 0.0, size.x));
    float end = clamp(ray.place.z, 1e-3, size.z);
    bool isInterpolated = laminaIsInterpolated();
    float theta = isInterpolated ? ray.place.y - 0.5 : ray.place.y;
    float low = floor(theta);
    float share = isInterpolated ? theta - low : 0.0;
    ivec2 at = ivec2(alpha, low);
    vec2 surface = laminaPlanePhi(ray, at);
    ivec2 ends = ivec2(laminaOwnShadow(vsv, at, end, surface.x), laminaOwnShadow(vsv, at + ivec2(0, 1), end, surface.y));
    return 1.0 - laminaShadowedShare(vsv, ray.air, at, vec2(1.0 - share, share), end, ends);
}

// Airlight of one light between the eye and `world`, shadowed. RGB radiance.
vec3 laminaAirlight(int light, int vsv, LaminaLightRay ray) {
    vec3 strength = laminaAreaLight.medium.rgb * laminaVirtualLights[light].intensity.rgb;
    return strength * (laminaAirlightUnshadowed(ray.air) * laminaAirlightVisibility(vsv, ray));
}

vec3 laminaAirlight(int light, int vsv, vec3 world) {
    return laminaAirlight(light, vsv, laminaLightRay(light, vsv, world));
}

// Irradiance that one light brings to a surface at right angles to `toLight`, attenuated by the medium and
// shadowed. Zero behind a Lambertian emitter. ray: to `world`.
vec3 laminaLightIrradiance(int light, int vsv, LaminaLightRay ray, vec3 world, out vec3 toLight) {
    vec4 position = laminaVirtualLights[light].position;
    vec4 normal = laminaVirtualLights[light].normal;
    vec4 intensity = laminaVirtualLights[light].intensity;
    if (position.w == 0.0) {
        toLight = position.xyz;
        return intensity.rgb * laminaSurfaceVisibility(vsv, ray);
    }
    vec3 offset = position.xyz - world;
    float distance = length(offset);
    toLight = offset / distance;
    float emitted = intensity.w != 0.0 ? max(0.0, -dot(normal.xyz, toLight)) : 1.0;
    if (emitted == 0.0)
        return vec3(0.0);
    float nearest = max(distance, normal.w);
    return intensity.rgb *
           (laminaSurfaceVisibility(vsv, ray) * emitted * laminaTransmittance(distance) / (nearest * nearest));
}

vec3 laminaLightIrradiance(int light, int vsv, vec3 world, out vec3 toLight) {
    return laminaLightIrradiance(light, vsv, laminaLightRay(light, vsv, world), world, toLight);
}

#endif
