// Visible points, one an invocation.
layout(local_size_x = LAMINA_SHADOW_GROUP, local_size_y = LAMINA_SHADOW_GROUP) in;

#include <shadow_volumes/visible_depth.glsl>

// The point whose shadow the invocation's pixel shows, in origin space; false if it shows none.
bool laminaVisiblePoint(out vec3 point) {
    ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(uvec2(pixel), laminaFrame.size.xy)))
        return false;
    float depth;
    bool isVisible = laminaVisibleDepth(pixel, depth);
    vec4 found = laminaFrame.windowToOrigin * vec4(vec2(pixel) + 0.5, depth, 1.0);
    point = found.xyz / found.w;
    return isVisible && !any(isnan(point)) && !any(isinf(point));
}
