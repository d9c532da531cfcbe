// What the fragment stages over texels of the light's map share.
#include <shadow_volumes/draw.glsl>

layout(location = 0) flat in vec3 laminaEdges[3];
layout(location = 3) flat in vec4 laminaBox;
layout(location = 4) flat in vec3 laminaFarPlane;
layout(location = 5) flat in vec3 laminaFarRange;
layout(location = 9) flat in vec2 laminaCorner;

uint laminaFragmentFace() {
    return uint(laminaFarRange.z);
}

// Does the triangle come within `reach` of the texel's centre, in x and in y? Never no where it does.
bool laminaTouches(float reach) {
    vec2 at = gl_FragCoord.xy - laminaCorner;
    if (any(lessThan(at + reach, laminaBox.xy)) || any(greaterThan(at - reach, laminaBox.zw)))
        return false;
    for (int i = 0; i < 3; ++i)
        if (dot(laminaEdges[i], vec3(at, 1.0)) + reach * (abs(laminaEdges[i].x) + abs(laminaEdges[i].y)) < 0.0)
            return false;
    return true;
}

// Least and greatest farness of the triangle's part within `reach` of the texel's centre, or bounds of it.
// A plane through the light has no farness of its own (0 / 0): its corners' range stands.
vec2 laminaFarness(float reach) {
    float middle = dot(laminaFarPlane, vec3(gl_FragCoord.xy - laminaCorner, 1.0));
    float change = reach * (abs(laminaFarPlane.x) + abs(laminaFarPlane.y));
    vec2 range = laminaFarRange.xy;
    if (isnan(middle) || isnan(change) || isinf(change))
        return range;
    return vec2(clamp(middle - change, range.x, range.y), clamp(middle + change, range.x, range.y));
}
