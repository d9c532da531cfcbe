// Receivers as the viewer sees them: each visible point sets the bit of its layer in its texel of the
// light's map ([ED06] 3.2, the litmap of Figure 8). Nothing else sets a bit, and none is missing.
//
// Launch: the view's pixels in groups of 16 x 16; an invocation owns one. Atomic: many pixels share a
// texel; most find their bit set and skip it.
#define LAMINA_SHADOW_BOUNDS_ACCESS readonly
#define LAMINA_SHADOW_SLICEMAP_ACCESS
#include <shadow_volumes/bounds.glsl>
#include <shadow_volumes/slicemap.glsl>
#include <shadow_volumes/pixel.glsl>

void main() {
    vec3 point;
    if (!laminaVisiblePoint(point))
        return;
    uint face = laminaFaceOf(point);
    if (laminaFaceEmpty(face))
        return;
    vec3 at = laminaToTexel(laminaFaceMap(face), laminaFacePoint(face, point).position);
    uvec2 texel = uvec2(clamp(ivec2(floor(at.xy / at.z)), ivec2(0), ivec2(laminaFrame.size.z) - 1));
    uint layer = laminaShadowLayer(vec2(gl_GlobalInvocationID.xy) + 0.5);
    uint word = laminaSlicemapWord(face, texel) + (layer >> 5);
    uint bit = 1u << (layer & 31u);
    if ((laminaSlicemap[word] & bit) == 0u)
        atomicOr(laminaSlicemap[word], bit);
}
