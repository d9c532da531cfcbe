// Refraction through an object that the engine has drawn into a G-buffer. One invocation a pixel: the
// world point from the depth, the normal, laminaRefraction(); pixels of other objects and of the
// background are left as they are. Rays that tell of an open surface are counted for the report: an atomic,
// since all invocations share the number; few pixels need it.
// permute LAMINA_REFRACTION_MODEL = LAMINA_REFRACTION_VOLUME_INTEGRAL LAMINA_REFRACTION_TWO_SURFACES LAMINA_REFRACTION_MANY_SURFACES
#include <lamina/shared/refraction_block.glsl>
#define LAMINA_REFRACTION_BLOCK_BINDING LAMINA_REFRACTION_APPLY_BLOCK_BINDING
#define LAMINA_REFRACTION_TEXTURE_UNIT LAMINA_REFRACTION_APPLY_TEXTURE_UNIT
#include <lamina/refraction.glsl>

layout(binding = LAMINA_REFRACTION_APPLY_DEPTH_UNIT) uniform sampler2D laminaDepths;
layout(binding = LAMINA_REFRACTION_APPLY_NORMAL_UNIT) uniform sampler2D laminaNormals;
layout(binding = LAMINA_REFRACTION_APPLY_OBJECT_UNIT) uniform usampler2D laminaObjects;

layout(std430, binding = LAMINA_REFRACTION_APPLY_REPORT_BINDING) buffer LaminaRefractionReport {
    LaminaRefractionCounts laminaReport;
};

layout(location = 0) out vec4 laminaResult;

void main() {
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    float depth = texelFetch(laminaDepths, pixel, 0).r;
    LaminaRefractionConstants block = laminaRefractionBlock;
    if (laminaIsBackground(block.view, depth))
        discard;
    if ((block.modes.x & LAMINA_REFRACTION_OBJECTS) != 0u && texelFetch(laminaObjects, pixel, 0).r != block.sizes.y)
        discard;
    vec3 normal = texelFetch(laminaNormals, pixel, 0).xyz;
    if ((block.modes.x & LAMINA_REFRACTION_UNSIGNED_NORMALS) != 0u)
        normal = normal * 2.0 - 1.0;
    vec3 world = laminaWorldPoint(block.view, gl_FragCoord.xy, depth);
    LaminaRefracted ray;
    laminaResult = laminaRefraction(world, normal, gl_FragCoord.xy, ray);
    if (ray.isOpen)
        atomicAdd(laminaReport.openPixels, 1u);
}
