// 1 where light reaches the visible surface, 0 in shadow; 1 where there is no surface.
#include <shadow_volumes/frame.glsl>

layout(binding = LAMINA_SHADOW_DEPTH_UNIT) uniform sampler2D laminaDepths;
layout(binding = LAMINA_SHADOW_STENCIL_UNIT) uniform usampler2D laminaVolumes;

layout(location = 0) out float laminaLit;

void main() {
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    bool isLit = texelFetch(laminaVolumes, pixel, 0).x == 0u || texelFetch(laminaDepths, pixel, 0).x == laminaFrame.depth.x;
    laminaLit = isLit ? 1.0 : 0.0;
}
