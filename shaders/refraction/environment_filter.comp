// Makes a level of an environment from the one above, which the sampler sees as its level 0, by a round
// Gaussian around each texel's direction, so that no level shows the squares and the face edges of a
// box-filtered pyramid.
//
// Launch: 8 x 8 x 1 groups over the texels of the six faces; one invocation owns a texel: it sums 7 x 7
// look-ups of the level above on its tangent plane. No two share one.
//
// Width: with look-ups that add a tent of one texel, the standard deviation of level L is 0.7 of its texels
// (LAMINA_ENVIRONMENT_SIGMA) if each step adds a variance of 0.2 squared texels of its own.
#include <lamina/cube_map.glsl>

layout(local_size_x = 8, local_size_y = 8) in;
layout(binding = 0, rgba16f) uniform writeonly restrict imageCube laminaTarget;
layout(binding = 0) uniform samplerCube laminaSource;

void main() {
    ivec3 texel = ivec3(gl_GlobalInvocationID);
    ivec2 size = imageSize(laminaTarget);
    if (any(greaterThanEqual(texel.xy, size)))
        return;
    vec3 center = normalize(laminaCubeDirection(texel.z, (vec2(texel.xy) + 0.5) / vec2(size)));
    vec3 right = normalize(cross(center, abs(center.y) < 0.7 ? vec3(0.0, 1.0, 0.0) : vec3(1.0, 0.0, 0.0)));
    vec3 up = cross(right, center);
    const float kSigma = 0.4472; // sqrt(0.2) texels of this level.
    const float kStep = 0.375;   // Of this level's texels: 0.75 of the one above.
    float angle = 1.5707963267948966 / float(size.x);
    vec4 sum = vec4(0.0);
    for (int y = -3; y <= 3; ++y)
        for (int x = -3; x <= 3; ++x) {
            vec2 offset = vec2(x, y) * kStep;
            float weight = exp(-0.5 * dot(offset, offset) / (kSigma * kSigma));
            vec3 direction = center + angle * (offset.x * right + offset.y * up);
            sum += weight * vec4(textureLod(laminaSource, direction, 0.0).rgb, 1.0);
        }
    imageStore(laminaTarget, texel, vec4(sum.rgb / sum.w, 1.0));
}
