// The slicemap of receivers: for each texel of each face of the light's map, one bit a layer.
layout(std430, binding = LAMINA_SHADOW_SLICEMAP_BINDING) LAMINA_SHADOW_SLICEMAP_ACCESS buffer LaminaShadowSlicemap {
    uint laminaSlicemap[];
};

uint laminaSlicemapWord(uint face, uvec2 texel) {
    return ((face * laminaFrame.size.z + texel.y) * laminaFrame.size.z + texel.x) * laminaFrame.counts.y;
}
