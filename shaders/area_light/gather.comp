// The gather with the built-in reflectance: Lambert's and Phong's.
#include <area_light/gather_main.glsl>

vec3 laminaSurfaceReflectance(vec3 normal, vec3 toLight, vec3 toViewer) {
    float exponent = laminaGather.numbers.z;
    float strength = laminaGather.numbers.w;
    float reflected = 1.0 / kLaminaPi;
    if (strength > 0.0)
        reflected += strength * (exponent + 2.0) / (2.0 * kLaminaPi) *
                     pow(max(dot(reflect(-toLight, normal), toViewer), 0.0), exponent);
    return vec3(reflected);
}
