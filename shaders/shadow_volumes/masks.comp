// Settles what is drawn of each caster's volume, and writes the draws' commands, so that the host need not
// know.
//
// Launch: the casters in groups of 64; an invocation owns one caster:
//   1. practical variant: gathers its layers from the results of its queries;
//   2. drops casters that the light does not see; takes all layers if volumes are not clamped;
//   3. writes the commands of its silhouette and its caps, of no indices for a culled caster.
#include <shadow_volumes/frame.glsl>

layout(local_size_x = LAMINA_SHADOW_CASTER_GROUP) in;

layout(std430, binding = LAMINA_SHADOW_CASTER_BINDING) buffer LaminaShadowCasters {
    LaminaShadowCaster laminaCasters[];
};
layout(std430, binding = LAMINA_SHADOW_COMMAND_BINDING) writeonly buffer LaminaShadowCommands {
    LaminaShadowCommand laminaCommands[];
};
layout(std430, binding = LAMINA_SHADOW_QUERY_BINDING) readonly buffer LaminaShadowQueries {
    uint laminaQueries[]; // a caster: layers, and whether the light sees it
};

uvec4 queriedLayers(uint caster) {
    uvec4 layers = uvec4(0u);
    uint first = caster * (laminaFrame.counts.x + 1u);
    for (uint layer = 0u; layer < laminaFrame.counts.x; ++layer)
        if (laminaQueries[first + layer] != 0u)
            layers[layer >> 5] |= 1u << (layer & 31u);
    return layers;
}

uvec4 allLayers() {
    ivec4 count = clamp(ivec4(laminaFrame.counts.x) - ivec4(0, 32, 64, 96), ivec4(0), ivec4(32));
    return mix((uvec4(1u) << uvec4(count & 31)) - 1u, uvec4(0xffffffffu), equal(count, ivec4(32)));
}

void main() {
    uint caster = gl_GlobalInvocationID.x;
    if (caster >= laminaFrame.counts.z)
        return;
    LaminaShadowCaster found = laminaCasters[caster];
    uint flags = laminaFrame.counts.w;
    if ((flags & LAMINA_SHADOW_QUERIES) != 0u) {
        found.layers = queriedLayers(caster);
        found.state.x = laminaQueries[caster * (laminaFrame.counts.x + 1u) + laminaFrame.counts.x] != 0u ? 1u : 0u;
    }
    if ((flags & LAMINA_SHADOW_CLAMP) == 0u)
        found.layers = allLayers();
    if ((flags & LAMINA_SHADOW_CULL_CASTERS) != 0u && found.state.x == 0u)
        found.layers = uvec4(0u);
    laminaCasters[caster] = found;
    uint kept = any(notEqual(found.layers, uvec4(0u))) ? 1u : 0u;
    laminaCommands[2u * caster] = LaminaShadowCommand(found.state.y * kept, kept, 0u, 0u, 0u);
    laminaCommands[2u * caster + 1u] = LaminaShadowCommand(found.state.z * kept, kept, 0u, 0u, 0u);
}
