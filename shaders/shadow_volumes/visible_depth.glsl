// The engine's depths, a little nearer to the viewer.
//
// The shadow of a visible point is asked for just in front of its surface, against acne: a caster's lit
// side is an end of its own volume. To move the point rather than the volume keeps volumes closed, and
// each pixel's count that of one point.
#include <shadow_volumes/frame.glsl>

layout(binding = LAMINA_SHADOW_DEPTH_UNIT) uniform sampler2D laminaDepths;

// Smaller of the depth's changes to the pixel's two neighbours along `step`: the surface's own slope,
// unless it ends on both sides.
float laminaSlope(ivec2 pixel, ivec2 step, float depth) {
    ivec2 last = ivec2(laminaFrame.size.xy) - 1;
    float before = texelFetch(laminaDepths, max(pixel - step, ivec2(0)), 0).x;
    float after = texelFetch(laminaDepths, min(pixel + step, last), 0).x;
    float down = any(lessThan(pixel - step, ivec2(0))) ? abs(after - depth) : abs(depth - before);
    float up = any(greaterThan(pixel + step, last)) ? abs(depth - before) : abs(after - depth);
    return min(down, up);
}

vec3 laminaPointAt(vec2 pixel, float depth) {
    vec4 point = laminaFrame.windowToOrigin * vec4(pixel, depth, 1.0);
    return point.xyz / point.w;
}

// The depth to find the shadow at. False, and the depth as it is, where there is no surface.
bool laminaVisibleDepth(ivec2 pixel, out float depth) {
    depth = texelFetch(laminaDepths, pixel, 0).x;
    if (depth == laminaFrame.depth.x)
        return false;
    float slope = max(laminaSlope(pixel, ivec2(1, 0), depth), laminaSlope(pixel, ivec2(0, 1), depth));
    // No slope but a gap, if it is steeper than surfaces are that a pixel can show well.
    const float steepest = 32.0;
    vec2 middle = vec2(pixel) + 0.5;
    vec3 point = laminaPointAt(middle, depth);
    float width = distance(laminaPointAt(middle + vec2(1.0, 0.0), depth), point);
    float climb = distance(laminaPointAt(middle, depth - laminaFrame.depth.y * slope), point);
    if (climb > steepest * width)
        slope *= steepest * width / climb;
    precise float bias = laminaFrame.bias.x * slope + laminaFrame.bias.y + laminaFrame.bias.z * depth;
    precise float nearer = depth - laminaFrame.depth.y * bias;
    // Behind the near plane by the least step: what lies before it is drawn at its depth, and must not count
    // as behind the point.
    const float gap = 1.0 / 16777216.0;
    float least = laminaFrame.depth.z + (laminaFrame.depth.y > 0.0 ? gap : 0.0);
    float greatest = laminaFrame.depth.w - (laminaFrame.depth.y > 0.0 ? 0.0 : gap);
    depth = clamp(nearer, least, greatest);
    return true;
}
