// Filters the gathered sums to full resolution and puts airlight and surface light over the engine's colours
// ([WD13] 3.4): color * T + albedo * surface * T + airlight, T the transmittance of the eye ray.
//
// A fragment owns a pixel of the view:
//   1. its sums: its own; the mean of the 3 x 3 pixels that share the lights (interleaved); or those of the
//      nearest four pixels of the sums, bilinear (quarter resolution). The latter two leave out what lies at
//      another distance or (on surfaces) faces another way, so that edges stay;
//   2. the composite.
// permute LAMINA_AREA_LIGHT_FILTER = LAMINA_AREA_LIGHT_FILTER_NONE LAMINA_AREA_LIGHT_FILTER_INTERLEAVED LAMINA_AREA_LIGHT_FILTER_UPSAMPLE
#include <area_light/pass_blocks.glsl>

layout(std430, binding = LAMINA_AREA_LIGHT_PASS_LIGHT_BINDING) readonly buffer LaminaAreaLightBlock {
    LaminaAreaLightConstants laminaAreaLight;
};

layout(binding = LAMINA_AREA_LIGHT_PASS_ALBEDO_UNIT) uniform sampler2D laminaAlbedos;
layout(binding = LAMINA_AREA_LIGHT_PASS_COLOR_UNIT) uniform sampler2D laminaColors;
layout(binding = LAMINA_AREA_LIGHT_PASS_AIRLIGHT_UNIT) uniform sampler2D laminaAirlightSums;
layout(binding = LAMINA_AREA_LIGHT_PASS_SURFACE_UNIT) uniform sampler2D laminaSurfaceSums;

layout(location = 0) out vec4 laminaResult;

// What a filter compares pixels by.
struct Seen {
    float distance;
    bool isSky;
    vec3 normal;
};

Seen seenAt(ivec2 pixel) {
    Seen seen;
    vec3 world = laminaSeenPoint(pixel, seen.isSky);
    seen.distance = distance(world, laminaView.viewpoint.xyz);
    seen.normal = laminaHas(LAMINA_AREA_LIGHT_HAS_NORMALS) && !seen.isSky ? laminaSeenNormal(pixel) : vec3(0.0);
    return seen;
}

// In [0,1], small for pixels of different surfaces: airlight (x) of one says nothing about the other if they
// are apart, surface light (y) neither if they face different ways. tolerance: of relative distance.
vec2 likeness(Seen a, Seen b, float tolerance, float sharpness) {
    if (a.isSky != b.isSky)
        return vec2(0.0);
    float apart = abs(a.distance - b.distance) / (tolerance * min(a.distance, b.distance));
    // Pixels without a normal, of glowing things, go together.
    bool hasNormals = a.normal != vec3(0.0) || b.normal != vec3(0.0);
    float facing = hasNormals ? max(dot(a.normal, b.normal), 0.0) : 1.0;
    return exp(-apart * apart) * vec2(1.0, pow(facing, sharpness));
}

struct Sums {
    vec3 airlight;
    vec3 surface;
    vec2 weights;
};

void add(inout Sums sums, ivec2 cell, vec2 weights) {
    sums.airlight += weights.x * texelFetch(laminaAirlightSums, cell, 0).rgb;
    sums.surface += weights.y * texelFetch(laminaSurfaceSums, cell, 0).rgb;
    sums.weights += weights;
}

Sums filtered(ivec2 pixel, Seen seen) {
    Sums sums = Sums(vec3(0.0), vec3(0.0), vec2(0.0));
#if LAMINA_AREA_LIGHT_FILTER == LAMINA_AREA_LIGHT_FILTER_NONE
    add(sums, pixel, vec2(1.0));
#else
    const float kSharpness = 8.0;
    float tolerance = laminaGather.numbers.y;
    ivec2 last = ivec2(laminaGather.pixels.xy) - 1;
    ivec2 viewLast = ivec2(laminaView.size.xy) - 1;
#if LAMINA_AREA_LIGHT_FILTER == LAMINA_AREA_LIGHT_FILTER_INTERLEAVED
    // At the border the window moves inwards, so that it always holds all nine subsets.
    ivec2 corner = clamp(pixel - 1, ivec2(0), max(last - 2, ivec2(0)));
    for (int i = 0; i < 9; ++i) {
        ivec2 cell = min(corner + ivec2(i % 3, i / 3), last);
        add(sums, cell, cell == pixel ? vec2(1.0) : likeness(seen, seenAt(cell), tolerance, kSharpness));
    }
#else
    int scale = int(laminaGather.pixels.z);
    ivec2 base = pixel / scale;
    vec2 part = vec2(pixel - base * scale) / float(scale);
    for (int i = 0; i < 4; ++i) {
        ivec2 offset = ivec2(i & 1, i >> 1);
        ivec2 cell = min(base + offset, last);
        vec2 near = mix(1.0 - part, part, equal(offset, ivec2(1)));
        add(sums, cell, near.x * near.y * likeness(seen, seenAt(min(cell * scale, viewLast)), tolerance, kSharpness));
    }
    // A thing too thin for the sums' pixels takes airlight from what comes nearest to it in distance around,
    // and surface light from what is roughly alike; if nothing is, it stays dark: it may well look away from
    // the light that others have.
    const float kLeastWeight = 0.02;
    if (min(sums.weights.x, sums.weights.y) < kLeastWeight) {
        float least = 1e30;
        ivec2 nearest = base;
        Sums around = Sums(vec3(0.0), vec3(0.0), vec2(0.0));
        for (int i = 0; i < 16; ++i) {
            ivec2 cell = clamp(base - 1 + ivec2(i & 3, i >> 2), ivec2(0), last);
            Seen other = seenAt(min(cell * scale, viewLast));
            float apart = abs(log(other.distance / seen.distance));
            nearest = apart < least ? cell : nearest;
            least = min(apart, least);
            add(around, cell, vec2(0.0, likeness(seen, other, 6.0 * tolerance, 2.0).y));
        }
        if (sums.weights.x < kLeastWeight) {
            sums.airlight = texelFetch(laminaAirlightSums, nearest, 0).rgb;
            sums.weights.x = 1.0;
        }
        if (sums.weights.y < kLeastWeight) {
            sums.surface = around.surface;
            sums.weights.y = max(around.weights.y, 0.2);
        }
    }
#endif
#endif
    return sums;
}

void main() {
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    Seen seen = seenAt(pixel);
    Sums sums = filtered(pixel, seen);
    vec3 airlight = sums.airlight / sums.weights.x;
    vec3 surface = sums.surface / sums.weights.y;
    if (laminaHas(LAMINA_AREA_LIGHT_HAS_ALBEDO))
        surface *= texelFetch(laminaAlbedos, pixel, 0).rgb;
    vec4 color = laminaHas(LAMINA_AREA_LIGHT_HAS_COLOR) ? texelFetch(laminaColors, pixel, 0) : vec4(0.0, 0.0, 0.0, 1.0);
    float transmittance = exp(-laminaAreaLight.medium.w * seen.distance);
    laminaResult = vec4((color.rgb + surface) * transmittance + airlight, color.a);
}
