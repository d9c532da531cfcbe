// Fills level 0 of an environment from the host's. Launch: 8 x 8 x 1 groups over the texels of the six
// faces; one invocation owns a texel and looks its direction up. No two share one.
// permute LAMINA_ENVIRONMENT_EQUIRECTANGULAR = 0 1
#include <lamina/cube_map.glsl>

layout(local_size_x = 8, local_size_y = 8) in;
layout(binding = 0, rgba16f) uniform writeonly restrict imageCube laminaTarget;
#if LAMINA_ENVIRONMENT_EQUIRECTANGULAR
layout(binding = 0) uniform sampler2D laminaSource;
#else
layout(binding = 0) uniform samplerCube laminaSource;
#endif

void main() {
    ivec3 texel = ivec3(gl_GlobalInvocationID);
    ivec2 size = imageSize(laminaTarget);
    if (any(greaterThanEqual(texel.xy, size)))
        return;
    vec3 direction = laminaCubeDirection(texel.z, (vec2(texel.xy) + 0.5) / vec2(size));
#if LAMINA_ENVIRONMENT_EQUIRECTANGULAR
    const float kTurn = 6.283185307179586;
    vec3 unit = normalize(direction);
    vec2 place = vec2(0.5 + atan(unit.x, -unit.z) / kTurn, 0.5 + asin(clamp(unit.y, -1.0, 1.0)) * 2.0 / kTurn);
    // The row's first and last texel are neighbours, whatever wrapping the host has set.
    vec2 texels = vec2(textureSize(laminaSource, 0));
    vec2 corner = place * texels - 0.5;
    vec2 share = fract(corner);
    ivec2 low = ivec2(floor(corner));
    vec3 light = vec3(0.0);
    for (int i = 0; i < 4; ++i) {
        ivec2 at = low + ivec2(i & 1, i >> 1);
        at.x = (at.x + int(texels.x)) % int(texels.x);
        at.y = clamp(at.y, 0, int(texels.y) - 1);
        float weight = ((i & 1) == 0 ? 1.0 - share.x : share.x) * ((i >> 1) == 0 ? 1.0 - share.y : share.y);
        light += weight * texelFetch(laminaSource, at, 0).rgb;
    }
#else
    vec3 light = textureLod(laminaSource, direction, 0.0).rgb;
#endif
    // The largest half: infinities would spread over whole levels.
    imageStore(laminaTarget, texel, vec4(min(light, vec3(65504.0)), 1.0));
}
