// A fragment of a shadow volume: counts in the stencil buffer if its pixel lies in a kept layer. All
// polygons of a volume ask the same question of a pixel, so that it gets all or none of them.
#include <shadow_volumes/draw.glsl>

layout(std430, binding = LAMINA_SHADOW_CASTER_BINDING) readonly buffer LaminaShadowCasters {
    LaminaShadowCaster laminaCasters[];
};

layout(location = 0) out float laminaFragments; // of the overdraw map; no output of the stencil pass

void main() {
    if ((laminaDraw.draw.y & LAMINA_SHADOW_WHOLE) == 0u &&
        !laminaShadowLayerSet(laminaCasters[laminaDraw.draw.x].layers, laminaShadowLayer(gl_FragCoord.xy)))
        discard;
    laminaFragments = 1.0;
}
