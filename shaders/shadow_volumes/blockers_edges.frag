// Texels that a silhouette crosses hide nothing: their centre does not speak for all of them. In the others
// a caster covers all or nothing. A silhouette ends nothing that the shadow map holds if it lies behind it,
// and belongs to another caster: within one, steep faces may lead from the nearest surface to it.
#include <shadow_volumes/columns_fragment.glsl>
#include <shadow_volumes/hidden.glsl>

layout(binding = LAMINA_SHADOW_BLOCKER_UNIT) uniform usampler2DArray laminaBlockers; // which casters

layout(location = 0) out float laminaEdge;

void main() {
    ivec3 texel = ivec3(gl_FragCoord.xy, int(laminaFragmentFace()));
    if (!laminaTouches(LAMINA_SHADOW_REACH))
        discard;
    if (laminaIsBehind() && texelFetch(laminaBlockers, texel, 0).x != laminaDraw.draw.x)
        discard;
    laminaEdge = 1.0;
}
