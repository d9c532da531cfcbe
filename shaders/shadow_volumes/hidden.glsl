// What the light does not see.
layout(binding = LAMINA_SHADOW_LIGHT_UNIT) uniform sampler2DArray laminaLightMap; // least farness

// Is the triangle, where it comes within reach of the fragment's texel, behind all that the shadow map
// holds there and around? Relief of a nearer surface between the centres of texels is not known.
bool laminaIsBehind() {
    ivec3 texel = ivec3(gl_FragCoord.xy, int(laminaFragmentFace()));
    float blocker = -3.0e38;
    for (int y = -1; y <= 1; ++y)
        for (int x = -1; x <= 1; ++x) {
            ivec2 at = clamp(texel.xy + ivec2(x, y), ivec2(0), ivec2(laminaFrame.size.z) - 1);
            blocker = max(blocker, texelFetch(laminaLightMap, ivec3(at, texel.z), 0).x);
        }
    return laminaFarness(LAMINA_SHADOW_REACH).x > blocker + 1e-5 * abs(blocker);
}
