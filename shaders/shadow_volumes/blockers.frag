// The light's shadow map: of the nearest caster at the centre of each texel, which it is and how far its
// surface there reaches within the texel.
#include <shadow_volumes/columns_fragment.glsl>

layout(location = 0) out float laminaFar;
layout(location = 1) out uint laminaCaster;

void main() {
    if (!laminaTouches(0.0))
        discard;
    laminaFar = laminaFarness(1.0).y;
    laminaCaster = laminaDraw.draw.x;
    // Any depth that grows with farness serves: where two surfaces round to one, either may stay.
    gl_FragDepth = 0.5 + 0.5 * laminaFar / (1.0 + abs(laminaFar));
}
