// Transmittance of what the engine has drawn. One invocation a pixel:
// 1. The world point of the pixel from its depth; the background gets 1.
// 2. Its normal, from the engine's texture or from the depths of the neighbours.
// 3. laminaTransmittance().
// permute LAMINA_TRANSMITTANCE_NORMALS = LAMINA_TRANSMITTANCE_NORMALS_FROM_DEPTH LAMINA_TRANSMITTANCE_NORMALS_SIGNED LAMINA_TRANSMITTANCE_NORMALS_UNSIGNED
// permute LAMINA_TRANSMITTANCE_MODEL = LAMINA_TRANSMITTANCE_LEAF_COUNT LAMINA_TRANSMITTANCE_ABSORPTION
// permute LAMINA_TRANSMITTANCE_FACES = 1 6
// permute LAMINA_TRANSMITTANCE_CLASSES = 1 3
// permute LAMINA_TRANSMITTANCE_LOCAL_RANGES = 0 1
#define LAMINA_TRANSMITTANCE_BLOCK_BINDING LAMINA_TRANSMITTANCE_APPLY_BLOCK_BINDING
#define LAMINA_TRANSMITTANCE_TEXTURE_UNIT LAMINA_TRANSMITTANCE_APPLY_TEXTURE_UNIT
#include <lamina/transmittance.glsl>
#include <lamina/view.glsl>

layout(std140, binding = LAMINA_TRANSMITTANCE_APPLY_VIEW_BINDING) uniform LaminaTransmittanceViewBlock {
    LaminaViewConstants laminaView;
};
layout(binding = LAMINA_TRANSMITTANCE_APPLY_DEPTH_UNIT) uniform sampler2D laminaDepths;
layout(binding = LAMINA_TRANSMITTANCE_APPLY_NORMAL_UNIT) uniform sampler2D laminaNormals;

layout(location = 0) out vec4 laminaResult;

vec3 pointAt(ivec2 pixel) {
    return laminaWorldPoint(laminaView, vec2(pixel) + 0.5, texelFetch(laminaDepths, pixel, 0).r);
}

// From the point to the neighbour along `step` or against it, whichever is nearer: the other one may be
// of another surface.
vec3 tangent(ivec2 pixel, vec3 point, ivec2 step) {
    ivec2 last = ivec2(laminaView.size.xy) - 1;
    vec3 ahead = pointAt(min(pixel + step, last)) - point;
    vec3 behind = point - pointAt(max(pixel - step, ivec2(0)));
    float sizeAhead = dot(ahead, ahead);
    float sizeBehind = dot(behind, behind);
    return sizeBehind == 0.0 || (sizeAhead > 0.0 && sizeAhead < sizeBehind) ? ahead : behind;
}

vec3 normalAt(ivec2 pixel, vec3 point) {
#if LAMINA_TRANSMITTANCE_NORMALS == LAMINA_TRANSMITTANCE_NORMALS_FROM_DEPTH
    vec3 normal = cross(tangent(pixel, point, ivec2(1, 0)), tangent(pixel, point, ivec2(0, 1)));
    float size = length(normal);
    return size > 0.0 ? normal / size : vec3(0.0);
#elif LAMINA_TRANSMITTANCE_NORMALS == LAMINA_TRANSMITTANCE_NORMALS_SIGNED
    return texelFetch(laminaNormals, pixel, 0).xyz;
#else
    return texelFetch(laminaNormals, pixel, 0).xyz * 2.0 - 1.0;
#endif
}

void main() {
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    laminaResult = vec4(1.0);
    if (laminaIsBackground(laminaView, texelFetch(laminaDepths, pixel, 0).r))
        return;
    vec3 point = pointAt(pixel);
    laminaResult.rgb = laminaTransmittance(point, normalAt(pixel, point));
}
