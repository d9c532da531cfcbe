// Fills holes of imperfect shadow maps by a pyramid of all maps at once ([WD13] 3.1.2: push and pull).
//
// Pull (LAMINA_FILL_PUSH 0): an invocation owns a texel of a level; if three of the four finer texels have a
// value, so has it: the mean of those that belong to the nearest surface among them. With less it might be a
// gap between thin things.
// Push (1): an invocation owns a texel of a finer level; if it is empty it takes the bilinear mean of the four
// nearest texels of the coarser level, but only if all of them have a value, so that outlines do not grow.
// Launch: ceil(side of the level / 8) in x and y, maps in z work groups.
// permute LAMINA_FILL_PUSH = 0 1
#include <lamina/shared/imperfect_block.glsl>

layout(local_size_x = 8, local_size_y = 8) in;

layout(std140, binding = LAMINA_SPLAT_UNIFORM_BINDING) uniform LaminaSplatBlock {
    LaminaSplatConstants laminaSplat;
};
layout(r32ui, binding = LAMINA_SPLAT_IMAGE) uniform uimage2DArray laminaImage;

float otherAt(ivec2 texel, int layer) {
    ivec2 inside = clamp(texel, ivec2(0), ivec2(laminaSplat.other.x) - 1);
    return uintBitsToFloat(imageLoad(laminaImage, ivec3(inside + ivec2(laminaSplat.other.yz), layer)).r);
}

void main() {
    ivec2 texel = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(texel, ivec2(laminaSplat.level.y))))
        return;
    int layer = int(gl_WorkGroupID.z);
    ivec3 place = ivec3(texel + ivec2(laminaSplat.level.zw), layer);
    const float kEmpty = uintBitsToFloat(LAMINA_SPLAT_EMPTY);
#if LAMINA_FILL_PUSH
    if (imageLoad(laminaImage, place).r != LAMINA_SPLAT_EMPTY)
        return;
    ivec2 towards = ivec2((texel & 1) * 2 - 1);
    ivec2 own = texel / 2;
    vec4 values = vec4(otherAt(own, layer), otherAt(own + ivec2(towards.x, 0), layer),
                       otherAt(own + ivec2(0, towards.y), layer), otherAt(own + towards, layer));
    float value = any(equal(values, vec4(kEmpty))) ? kEmpty : dot(values, vec4(9.0, 3.0, 3.0, 1.0) / 16.0);
#else
    ivec2 finer = texel * 2;
    vec4 values = vec4(otherAt(finer, layer), otherAt(finer + ivec2(1, 0), layer),
                       otherAt(finer + ivec2(0, 1), layer), otherAt(finer + ivec2(1, 1), layer));
    float nearest = min(min(values.x, values.y), min(values.z, values.w));
    float value = kEmpty;
    vec4 full = vec4(notEqual(values, vec4(kEmpty)));
    if (dot(full, vec4(1.0)) > 2.5) {
        // Surfaces farther than this behind the nearest one are others.
        const float kSameSurface = 1.1;
        vec4 counts = vec4(lessThanEqual(values, vec4(nearest * kSameSurface)));
        value = dot(mix(vec4(0.0), values, greaterThan(counts, vec4(0.5))), vec4(1.0)) / dot(counts, vec4(1.0));
    }
#endif
    imageStore(laminaImage, place, uvec4(floatBitsToUint(value)));
}
