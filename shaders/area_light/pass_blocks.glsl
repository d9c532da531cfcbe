// What the gather and composite passes read of the engine's frame.
#include <lamina/shared/area_light_block.glsl>
#include <lamina/view.glsl>

layout(std140, binding = LAMINA_AREA_LIGHT_PASS_VIEW_BINDING) uniform LaminaViewBlock {
    LaminaViewConstants laminaView;
};
layout(std140, binding = LAMINA_AREA_LIGHT_PASS_GATHER_BINDING) uniform LaminaGatherBlock {
    LaminaGatherConstants laminaGather;
};

layout(binding = LAMINA_AREA_LIGHT_PASS_DEPTH_UNIT) uniform sampler2D laminaDepths;
layout(binding = LAMINA_AREA_LIGHT_PASS_NORMAL_UNIT) uniform sampler2D laminaNormals;

bool laminaHas(uint flag) {
    return (laminaGather.pixels.w & flag) != 0u;
}

// World point that a pixel shows; the sky is a point at the sky's distance.
vec3 laminaSeenPoint(ivec2 pixel, out bool isSky) {
    float depth = texelFetch(laminaDepths, pixel, 0).r;
    isSky = laminaIsBackground(laminaView, depth);
    vec2 center = vec2(pixel) + 0.5;
    if (!isSky)
        return laminaWorldPoint(laminaView, center, depth);
    // Half way in depth lies a finite point of every projection.
    vec3 direction = -laminaTowardsViewer(laminaView, laminaWorldPoint(laminaView, center, 0.5));
    return laminaView.viewpoint.xyz + laminaGather.numbers.x * direction;
}

// World normal of a pixel; of any length where the host's is none.
vec3 laminaSeenNormal(ivec2 pixel) {
    vec3 normal = texelFetch(laminaNormals, pixel, 0).xyz;
    if (laminaHas(LAMINA_AREA_LIGHT_UNSIGNED_NORMALS))
        normal = 2.0 * normal - 1.0;
    float square = dot(normal, normal);
    return square > 0.0 ? normal * inversesqrt(square) : normal;
}

// A vector at right angles to the surface that a pixel shows, by the points of its neighbours; of any length.
vec3 laminaSeenPlane(ivec2 pixel, vec3 world) {
    ivec2 last = ivec2(laminaView.size.xy) - 1;
    vec3 steps[2];
    for (int axis = 0; axis < 2; ++axis) {
        ivec2 offset = ivec2(1 - axis, axis);
        bool isSky;
        vec3 before = laminaSeenPoint(max(pixel - offset, ivec2(0)), isSky) - world;
        vec3 after = laminaSeenPoint(min(pixel + offset, last), isSky) - world;
        // The nearer of the two is on the same surface, if one is.
        vec2 squares = vec2(dot(before, before), dot(after, after));
        steps[axis] = squares.y == 0.0 || (squares.x > 0.0 && squares.x < squares.y) ? -before : after;
    }
    return cross(steps[0], steps[1]);
}
