// Single scattering of a point or directional light along an eye ray in a homogeneous medium, without
// shadows: the airlight integral in epipolar space ([WD13] 2.1, 2.6; Sun et al. 2005).
//
// In the triangle of eye E, light L and a point P of the ray, alpha is the angle at E, phi at L and
// psi = alpha + phi; psi also is the angle by which light turns at P. Along the ray phi grows from 0; with
// D = |L - E|, dt / r^2 = dphi / (D sin alpha) and t + r = D cos alpha + D sin alpha tan(psi / 2): all factors
// of the integrand are elementary functions of psi, smooth over any distance, and flat where the ray passes
// near the light, so a few nodes in phi integrate it.
//
// Precision: single; relative error of the integral below 0.5 % for |g| <= 0.6, 2 % up to 0.85.
#ifndef LAMINA_AIRLIGHT_GLSL
#define LAMINA_AIRLIGHT_GLSL

#include <lamina/shared/area_light_block.glsl>

// An eye ray and a light. For a point light psi = alpha + phi as above; for a directional light phi is the
// distance from the axis and the integrand an exponential of it.
struct LaminaAirlightRay {
    bool isDirectional;
    // Angle from ray to light, its sine and cosine.
    float alpha;
    float sinAlpha;
    float cosAlpha;
    // Extinction times D sin alpha; directional: extinction / sin alpha.
    float attenuation;
    // tan(alpha / 2): where the way of the light is shortest, D, at the eye. 0 for directional lights.
    float start;
    // What stands before the integral over phi.
    float factor;
    // Intensity of the emitter towards a point is max(0, dot(emission, vec3(1, cos psi, sin psi))).
    vec3 emission;
    // Stretch of phi to integrate over: from, to.
    vec2 range;
    // Henyey-Greenstein's g.
    float anisotropy;
};

const float kLaminaPi = 3.14159265358979;

// Henyey-Greenstein's phase function; `cosine` of the angle by which light turns, g > 0 scatters forward.
float laminaPhase(float g, float cosine) {
    float square = 1.0 + g * g - 2.0 * g * cosine;
    return (1.0 - g * g) / (4.0 * kLaminaPi) * inversesqrt(square) / square;
}

// The ray from the eye to `point` under a light.
// across: unit vector, at right angles to the axis from eye to light, on the point's side.
// along, apart: the point's coordinates along the axis and along `across`, from the eye.
// lightDistance: D; 0 for a directional light. normal: of a Lambertian emitter. isLambertian: 1 or 0.
// radius: the integrand is bounded as if the light were no nearer to the ray than this.
LaminaAirlightRay laminaAirlightRay(float extinction, float anisotropy, vec3 axis, vec3 across, float along,
                                    float apart, float lightDistance, vec3 normal, float isLambertian,
                                    float radius) {
    LaminaAirlightRay ray;
    float distance = sqrt(along * along + apart * apart);
    ray.isDirectional = lightDistance == 0.0;
    // On the axis itself the integral over phi would be 0 / 0.
    ray.sinAlpha = max(apart / distance, 1e-6);
    ray.cosAlpha = along / distance;
    ray.alpha = atan(apart, along);
    ray.anisotropy = anisotropy;
    ray.emission = vec3(1.0, 0.0, 0.0);
    if (ray.isDirectional) {
        ray.attenuation = extinction / ray.sinAlpha;
        ray.start = 0.0;
        ray.factor = laminaPhase(anisotropy, ray.cosAlpha) / ray.sinAlpha;
        ray.range = vec2(0.0, distance * ray.sinAlpha);
        return ray;
    }
    float offset = lightDistance * ray.sinAlpha;
    ray.attenuation = extinction * offset;
    ray.start = ray.cosAlpha > 0.0 ? ray.sinAlpha / (1.0 + ray.cosAlpha) : (1.0 - ray.cosAlpha) / ray.sinAlpha;
    // A light behind the eye or beyond the point is not near the ray, although near its line.
    float reached = lightDistance * ray.cosAlpha;
    float nearest = length(vec2(offset, reached - clamp(reached, 0.0, distance)));
    float bound = nearest < radius ? nearest / radius : 1.0;
    // t + r = D + D sin alpha (tan(psi / 2) - tan(alpha / 2)), of which no part is negative: no exponential of
    // either overflows, however far the light.
    ray.factor = exp(-extinction * lightDistance) * bound / offset * (1.0 - anisotropy * anisotropy) /
                 (4.0 * kLaminaPi);
    ray.range = vec2(0.0, atan(distance * ray.sinAlpha, lightDistance - along));
    if (isLambertian != 0.0) {
        // From light towards a point: cos phi (L -> E) + sin phi across.
        float front = -dot(normal, axis);
        float side = dot(normal, across);
        ray.emission = vec3(0.0, front * ray.cosAlpha - side * ray.sinAlpha,
                            front * ray.sinAlpha + side * ray.cosAlpha);
        // The half-turn of phi that the emitter sees.
        float middle = atan(side, front);
        middle += middle < -0.5 * kLaminaPi ? 2.0 * kLaminaPi : 0.0;
        ray.range = vec2(max(ray.range.x, middle - 0.5 * kLaminaPi), min(ray.range.y, middle + 0.5 * kLaminaPi));
        ray.range.y = max(ray.range.x, ray.range.y);
    }
    return ray;
}

// The integrand per unit of phi, without `factor`, which holds what does not change along the ray, at cosine and
// sine of psi (point light) or at a distance from the axis (directional, in x).
float laminaAirlightDensity(LaminaAirlightRay ray, vec2 psi) {
    if (ray.isDirectional)
        return exp(-ray.attenuation * psi.x);
    float emitted = max(0.0, ray.emission.x + ray.emission.y * psi.x + ray.emission.z * psi.y);
    // One division for the phase function and for tan(psi / 2), whose pole is at psi = pi, where every ray
    // ends.
    float g = ray.anisotropy;
    float square = 1.0 + g * g - 2.0 * g * psi.x;
    float cube = square * sqrt(square);
    float side = max(1.0 + psi.x, 1e-9);
    float inverse = 1.0 / (side * cube);
    float tangent = psi.y > 0.0 ? psi.y * cube * inverse : 1e9;
    return emitted * exp(-ray.attenuation * max(0.0, tangent - ray.start)) * (side * inverse);
}

// What laminaAirlightDensity() takes, at phi.
vec2 laminaAirlightPsi(LaminaAirlightRay ray, float phi) {
    return ray.isDirectional ? vec2(phi, 0.0) : vec2(cos(ray.alpha + phi), sin(ray.alpha + phi));
}

// laminaAirlightPsi() an offset of at most a quarter turn away, by a rotation: sine and cosine of the offset by
// their series, to 3e-5.
vec2 laminaAirlightTurned(LaminaAirlightRay ray, vec2 psi, float offset) {
    if (ray.isDirectional)
        return vec2(psi.x + offset, 0.0);
    float square = offset * offset;
    float cosine = 1.0 + square * (-0.5 + square * (1.0 / 24.0 + square * (-1.0 / 720.0 + square / 40320.0)));
    float sine = offset * (1.0 + square * (-1.0 / 6.0 + square * (1.0 / 120.0 + square * (-1.0 / 5040.0 + square / 362880.0))));
    return vec2(psi.x * cosine - psi.y * sine, psi.y * cosine + psi.x * sine);
}

// The part of the ray's stretch that its extinction leaves to see.
vec2 laminaAirlightSeen(LaminaAirlightRay ray) {
    if (ray.isDirectional)
        return vec2(ray.range.x, min(ray.range.y, ray.range.x + LAMINA_AIRLIGHT_DEPTH / max(ray.attenuation, 1e-30)));
    float start = tan(0.5 * (ray.alpha + ray.range.x));
    float end = 2.0 * atan(start + LAMINA_AIRLIGHT_DEPTH / max(ray.attenuation, 1e-30)) - ray.alpha;
    return vec2(ray.range.x, max(ray.range.x, min(ray.range.y, end)));
}

// Airlight of the whole ray without shadows, per unit of scattering and intensity.
// Gauss and Legendre's nodes in phi, drawn to the end where the phase function has its peak.
float laminaAirlightUnshadowed(LaminaAirlightRay ray) {
    const float kNodes[6] = float[](0.125233408511469, 0.367831498998180, 0.587317954286617, 0.769902674194305,
                                    0.904117256370475, 0.981560634246719);
    const float kWeights[6] = float[](0.249147045813403, 0.233492536538355, 0.203167426723066, 0.160078328543346,
                                      0.106939325995318, 0.047175336386512);
    vec2 range = laminaAirlightSeen(ray);
    float extent = range.y - range.x;
    float evenness = ray.isDirectional ? 1.0 : 1.0 - 0.85 * abs(ray.anisotropy);
    bool isMirrored = ray.anisotropy < 0.0;
    vec2 middle = laminaAirlightPsi(ray, 0.5 * (range.x + range.y));
    float sum = 0.0;
    for (int i = 0; i < 2 * LAMINA_AIRLIGHT_NODE_PAIRS; ++i) {
        float place = 0.5 + ((i & 1) == 0 ? 0.5 : -0.5) * kNodes[i >> 1];
        float drawn = place * (evenness + (1.0 - evenness) * place);
        float offset = extent * (isMirrored ? 0.5 - drawn : drawn - 0.5);
        float spacing = evenness + 2.0 * (1.0 - evenness) * place;
        sum += kWeights[i >> 1] * spacing * laminaAirlightDensity(ray, laminaAirlightTurned(ray, middle, offset));
    }
    return 0.5 * ray.factor * extent * sum;
}

#endif
