// Sums airlight and surface light of all virtual lights for each pixel ([WD13] 3.1.5, 3.4), without the
// surfaces' reflectance, which is given by laminaSurfaceReflectance().
//
// Launch: ceil(pixels / LAMINA_AREA_LIGHT_GATHER_SIZE) in x and y work groups, subsets in z. An invocation owns
// a pixel of the sums and a subset of the lights:
//   1. find the world point (and normal) that the pixel shows;
//   2. for each light of the subset add its airlight and, facing it, its light on the surface;
//   3. store both sums. With 9 subsets the pixels of a 3 x 3 block sum a ninth of the lights each, times
//      9: their mean is the sum of all. All invocations of a work group walk the same lights.
#include <area_light/pass_blocks.glsl>
#include <lamina/area_light.glsl>

layout(local_size_x = LAMINA_AREA_LIGHT_GATHER_SIZE, local_size_y = LAMINA_AREA_LIGHT_GATHER_SIZE) in;

layout(rgba32f, binding = LAMINA_AREA_LIGHT_PASS_AIRLIGHT_IMAGE) uniform image2D laminaAirlightSums;
layout(rgba32f, binding = LAMINA_AREA_LIGHT_PASS_SURFACE_IMAGE) uniform image2D laminaSurfaceSums;

// Reflected radiance per irradiance, for an albedo of 1, cosine left out. Unit vectors from the surface.
vec3 laminaSurfaceReflectance(vec3 normal, vec3 toLight, vec3 toViewer);

void main() {
    uvec4 lights = laminaGather.lights;
    uint subset = gl_WorkGroupID.z;
    bool isInterleaved = lights.w != 1u;
    ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
    if (isInterleaved)
        pixel = 3 * pixel + ivec2(subset % 3u, subset / 3u);
    ivec2 size = ivec2(laminaGather.pixels.xy);
    if (any(greaterThanEqual(pixel, size)))
        return;
    ivec2 seen = min(pixel * int(laminaGather.pixels.z), ivec2(laminaView.size.xy) - 1);
    bool isSky;
    vec3 world = laminaSeenPoint(seen, isSky);
    bool isShaded = laminaHas(LAMINA_AREA_LIGHT_HAS_NORMALS) && !isSky;
    vec3 normal = isShaded ? laminaSeenNormal(seen) : vec3(0.0);
    vec3 plane = isShaded || isSky ? normal : laminaSeenPlane(seen, world);
    vec3 toViewer = laminaTowardsViewer(laminaView, world);

    // A run of a low-discrepancy sequence is well spread; every ninth of its points need not be.
    int first = int(lights.x + lights.y * subset / lights.w);
    int end = int(lights.x + lights.y * (subset + 1u) / lights.w);
    int toVolume = int(lights.z) - int(lights.x);
    vec3 airlight = vec3(0.0);
    vec3 surface = vec3(0.0);
    for (int light = first; light < end; ++light) {
        if (laminaVirtualLights[light].intensity.rgb == vec3(0.0))
            continue;
        LaminaLightRay ray = laminaLightRay(light, light + toVolume, world, plane);
        airlight += laminaAirlight(light, light + toVolume, ray);
        if (isShaded) {
            vec3 toLight;
            vec3 irradiance = laminaLightIrradiance(light, light + toVolume, ray, world, toLight);
            float cosine = dot(normal, toLight);
            if (cosine > 0.0)
                surface += cosine * irradiance * laminaSurfaceReflectance(normal, toLight, toViewer);
        }
    }
    float scale = float(lights.w);
    vec4 airlightSum = vec4(scale * airlight, 1.0);
    vec4 surfaceSum = vec4(scale * surface, 1.0);
    if (laminaHas(LAMINA_AREA_LIGHT_ADDS)) {
        airlightSum += imageLoad(laminaAirlightSums, pixel);
        surfaceSum += imageLoad(laminaSurfaceSums, pixel);
    }
    imageStore(laminaAirlightSums, pixel, airlightSum);
    imageStore(laminaSurfaceSums, pixel, surfaceSum);
}
