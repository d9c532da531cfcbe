// Corners of a caster's shadow volume, and its polygons. The volume reaches to infinity, away from the
// light (Everitt & Kilgard 2002).
//
// Where the draw asks for it, clip distances bound the polygons to the strip from the first to the last
// kept layer and a pixel more. Otherwise the polygons that are drawn of a caster are the same whatever
// layers it keeps, so that rasterization, too, is the same to the last pixel of an edge.
#include <shadow_volumes/facing.glsl>

layout(std430, binding = LAMINA_SHADOW_CASTER_BINDING) readonly buffer LaminaShadowCasters {
    LaminaShadowCaster laminaCasters[];
};

out gl_PerVertex {
    vec4 gl_Position;
    float gl_ClipDistance[2];
};

struct LaminaVolumeCorner {
    vec4 position; // clip space
    vec2 clip;     // negative: before the first kept layer, beyond the last
};

vec2 keptLayers;

// Before anything else.
void laminaFindKeptLayers() {
    keptLayers = vec2(-1.0e6, 1.0e6);
    if ((laminaDraw.draw.y & LAMINA_SHADOW_CLIPPED) == 0u)
        return;
    uvec4 layers = laminaCasters[laminaDraw.draw.x].layers;
    ivec4 low = findLSB(layers) + ivec4(0, 32, 64, 96);
    ivec4 high = findMSB(layers) + ivec4(0, 32, 64, 96);
    int first = layers.x != 0u ? low.x : layers.y != 0u ? low.y : layers.z != 0u ? low.z : low.w;
    int last = layers.w != 0u ? high.w : layers.z != 0u ? high.z : layers.y != 0u ? high.y : high.x;
    float pixel = length(laminaFrame.layerAxis.xy);
    // Pixels beyond the ends count as in the first or the last layer.
    keptLayers = vec2(first == 0 ? -1.0e6 : float(first) - pixel,
                      last + 1 == int(laminaFrame.counts.x) ? 1.0e6 : float(last + 1) + pixel);
}

LaminaVolumeCorner laminaVolumeCorner(vec4 origin) {
    LaminaVolumeCorner corner;
    // `precise`: sides and caps, of different programs, must meet in the same corners.
    mat4 m = laminaFrame.originToClip;
    precise vec4 position = m[0] * origin.x + m[1] * origin.y + m[2] * origin.z + m[3] * origin.w;
    corner.position = position;
    vec2 layer = laminaShadowClipLayer(corner.position);
    corner.clip = vec2(layer.x - keptLayers.x * layer.y, keptLayers.y * layer.y - layer.x);
    return corner;
}

LaminaVolumeCorner laminaNearCorner(vec3 origin) {
    return laminaVolumeCorner(vec4(origin, 1.0));
}

// Where a corner's shadow ends.
LaminaVolumeCorner laminaFarCorner(vec3 origin) {
    return laminaVolumeCorner(vec4(laminaIsPointLight() ? origin - laminaFrame.light.xyz : -laminaFrame.light.xyz, 0.0));
}

void laminaEmit(LaminaVolumeCorner corner) {
    gl_Position = corner.position;
    gl_ClipDistance[0] = corner.clip.x;
    gl_ClipDistance[1] = corner.clip.y;
    EmitVertex();
}

void laminaEmitTriangle(LaminaVolumeCorner a, LaminaVolumeCorner b, LaminaVolumeCorner c) {
    laminaEmit(a);
    laminaEmit(b);
    laminaEmit(c);
    EndPrimitive();
}
