// The layers that hold receivers in the columns of a caster ([ED06] 3.2): one fragment owns one texel of
// the light's map and one triangle:
//   1. rejects texels that the triangle does not touch;
//   2. rejects what the light does not see: behind the shadow map in the texel and all those around it
//      (Figure 8, left); without that test it only notes whether the light sees any part;
//   3. ideal: adds the texel's bits to the caster's (atomic: all fragments of the caster share one mask;
//      few reach it, since known bits are skipped); practical: drops the fragment unless the queried
//      layer's bit is set, for an occlusion query. A query for LAMINA_SHADOW_ANY_LAYER asks for step 2
//      alone.
// permute LAMINA_SHADOW_QUERY = 0 1
#include <shadow_volumes/columns_fragment.glsl>
#include <shadow_volumes/hidden.glsl>
#define LAMINA_SHADOW_SLICEMAP_ACCESS readonly
#include <shadow_volumes/slicemap.glsl>
#if LAMINA_SHADOW_QUERY
layout(location = LAMINA_SHADOW_QUERIED_LAYER) uniform uint laminaQueriedLayer;
#else
layout(std430, binding = LAMINA_SHADOW_CASTER_BINDING) buffer LaminaShadowCasters {
    LaminaShadowCaster laminaCasters[];
};
#endif

layout(binding = LAMINA_SHADOW_EDGE_UNIT) uniform sampler2DArray laminaLightEdges; // 1: a silhouette crosses

bool isHidden() {
    ivec3 texel = ivec3(gl_FragCoord.xy, int(laminaFragmentFace()));
    return texelFetch(laminaLightEdges, texel, 0).x == 0.0 && laminaIsBehind();
}

void main() {
    if (!laminaTouches(LAMINA_SHADOW_REACH))
        discard;
    bool isSeen = !isHidden();
    uint word = laminaSlicemapWord(laminaFragmentFace(), uvec2(gl_FragCoord.xy));
    bool counts = isSeen || (laminaFrame.counts.w & LAMINA_SHADOW_DEPTH_TEST) == 0u;
#if LAMINA_SHADOW_QUERY
    uint layer = laminaQueriedLayer;
    if (layer == LAMINA_SHADOW_ANY_LAYER ? !isSeen : !counts || ((laminaSlicemap[word + (layer >> 5)] >> (layer & 31u)) & 1u) == 0u)
        discard;
#else
    uint caster = laminaDraw.draw.x;
    if (isSeen && laminaCasters[caster].state.x == 0u)
        laminaCasters[caster].state.x = 1u;
    if (!counts)
        return;
    for (uint i = 0u; i < laminaFrame.counts.y; ++i) {
        uint bits = laminaSlicemap[word + i];
        if ((bits & ~laminaCasters[caster].layers[i]) != 0u)
            atomicOr(laminaCasters[caster].layers[i], bits);
    }
#endif
}
