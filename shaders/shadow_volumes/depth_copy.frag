// Copies the engine's depths, as visible_depth.glsl moves them.
#include <shadow_volumes/visible_depth.glsl>

void main() {
    float depth;
    laminaVisibleDepth(ivec2(gl_FragCoord.xy), depth);
    gl_FragDepth = depth;
}
