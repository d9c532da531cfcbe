// Multiplies the strength of virtual lights by what the light source's texture shows there ([WD13] 3.1.1).
//
// Launch: ceil(lights / 64) work groups; an invocation owns a light. The texture is read at the level whose
// texels are as large as the light's part of the source, so that small bright spots are not missed. Parts
// smaller than a texel take just that texel: lights that were placed where the picture is bright would lose to
// the filter what it spreads to neighbours, where there are no lights.
#include <lamina/shared/area_light_block.glsl>

layout(local_size_x = 64) in;

layout(std430, binding = 0) buffer LaminaAreaLightBlock {
    LaminaAreaLightConstants laminaAreaLight;
    LaminaVirtualLight laminaVirtualLights[];
};
// Texture coordinates; share of the texture that the light stands for; unused.
layout(std430, binding = 1) readonly buffer LaminaTintBlock {
    vec4 laminaPlaces[];
};
layout(binding = 0) uniform sampler2D laminaEmission;

void main() {
    uint light = gl_GlobalInvocationID.x;
    if (light >= laminaAreaLight.counts.x)
        return;
    vec4 place = laminaPlaces[light];
    vec2 size = vec2(textureSize(laminaEmission, 0));
    float level = 0.5 * log2(size.x * size.y * place.z);
    ivec2 texel = min(ivec2(place.xy * size), ivec2(size) - 1);
    vec3 shown = level > 0.0 ? textureLod(laminaEmission, place.xy, level).rgb : texelFetch(laminaEmission, texel, 0).rgb;
    laminaVirtualLights[light].intensity.rgb *= shown;
}
