// Sets the bits of the layers that a receiver's triangle spans in a texel of the light's map. One fragment
// owns one texel and triangle:
//   1. rejects texels that the triangle does not touch;
//   2. bounds the layer coordinate of its part there by those of the texel's corners: it is a quotient of
//      affine functions, extreme at corners where the view's w is positive at all of them; elsewhere the
//      triangle's range stands;
//   3. ORs the bits (atomic: triangles share texels).
#define LAMINA_SHADOW_SLICEMAP_ACCESS
#include <shadow_volumes/columns_fragment.glsl>
#include <shadow_volumes/slicemap.glsl>

layout(location = 6) flat in vec3 laminaLayerPlane;
layout(location = 7) flat in vec3 laminaViewPlane;
layout(location = 8) flat in vec2 laminaLayerRange;

vec2 layersInTexel() {
    vec2 range = vec2(3.0e38, -3.0e38);
    for (int corner = 0; corner < 4; ++corner) {
        vec2 side = vec2((corner & 1) == 0 ? -1.0 : 1.0, (corner & 2) == 0 ? -1.0 : 1.0);
        vec3 at = vec3(gl_FragCoord.xy - laminaCorner + LAMINA_SHADOW_REACH * side, 1.0);
        float w = dot(laminaViewPlane, at);
        float layer = dot(laminaLayerPlane, at) / w;
        if (!(w > 0.0) || isnan(layer) || isinf(layer))
            return laminaLayerRange;
        range = vec2(min(range.x, layer), max(range.y, layer));
    }
    // Of two bounds the tighter one.
    return vec2(clamp(laminaLayerRange.x, range.x, range.y), clamp(laminaLayerRange.y, range.x, range.y));
}

void main() {
    if (!laminaTouches(LAMINA_SHADOW_REACH))
        discard;
    const float rounding = 1.0 / 64.0;
    vec2 range = layersInTexel() + vec2(-rounding, rounding);
    int count = int(laminaFrame.counts.x);
    int first = int(clamp(floor(range.x), 0.0, float(count)));
    int last = int(clamp(floor(range.y), -1.0, float(count - 1)));
    uint base = laminaSlicemapWord(laminaFragmentFace(), uvec2(gl_FragCoord.xy));
    for (int word = 0; word < int(laminaFrame.counts.y); ++word) {
        int low = clamp(first - 32 * word, 0, 32);
        int high = clamp(last + 1 - 32 * word, 0, 32);
        uint belowLow = low == 32 ? 0xffffffffu : (1u << low) - 1u;
        uint belowHigh = high == 32 ? 0xffffffffu : (1u << high) - 1u;
        uint bits = belowHigh & ~belowLow;
        if ((bits & ~laminaSlicemap[base + uint(word)]) != 0u)
            atomicOr(laminaSlicemap[base + uint(word)], bits);
    }
}
