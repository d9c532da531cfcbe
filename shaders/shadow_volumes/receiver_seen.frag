// Receiver culling: a fragment that is not behind the engine's depth buffer marks its receiver as seen.
// One fragment owns one pixel and triangle. All that write, write the same: no atomic.
#include <shadow_volumes/visible_depth.glsl>
#include <shadow_volumes/draw.glsl>
#include <shadow_volumes/receiver_flags.glsl>

void main() {
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    float depth = texelFetch(laminaDepths, pixel, 0).x;
    // Its own surface, drawn by the engine with other rounding, must not hide it.
    float slack = fwidth(gl_FragCoord.z) + 4.0 * (laminaFrame.bias.y + laminaFrame.bias.z * depth);
    if ((gl_FragCoord.z - depth) * laminaFrame.depth.y <= slack)
        laminaReceivers[laminaDraw.draw.x] = 1u;
}
