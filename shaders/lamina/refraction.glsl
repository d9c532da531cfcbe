// Refraction through an object: what is seen at a point of its surface, for an engine's own fragment
// shader. [ED06] 3.3, [CLN11] 4.
//
//   <the lines of Refraction::shaderDefines(uniformBufferBinding, textureUnit)>
//   #include <lamina/refraction.glsl>
//   color = laminaRefraction(world, normal, gl_FragCoord.xy);
//
// Refraction::bind() with the same numbers fills what it reads. Cube map filtering across edges
// (GL_TEXTURE_CUBE_MAP_SEAMLESS) should be on. Levels are chosen explicitly: any control flow may surround
// the calls.
#ifndef LAMINA_REFRACTION_GLSL
#define LAMINA_REFRACTION_GLSL

#include <lamina/shared/refraction_block.glsl>
#include <lamina/view.glsl>

#ifndef LAMINA_REFRACTION_MODEL
#define LAMINA_REFRACTION_MODEL LAMINA_REFRACTION_VOLUME_INTEGRAL
#endif
#ifndef LAMINA_REFRACTION_BLOCK_BINDING
#define LAMINA_REFRACTION_BLOCK_BINDING 0
#endif
#ifndef LAMINA_REFRACTION_TEXTURE_UNIT
#define LAMINA_REFRACTION_TEXTURE_UNIT 0
#endif

layout(std140, binding = LAMINA_REFRACTION_BLOCK_BINDING) uniform LaminaRefractionBlock {
    LaminaRefractionConstants laminaRefractionBlock;
};
layout(binding = LAMINA_REFRACTION_TEXTURE_UNIT + LAMINA_REFRACTION_ENVIRONMENT_UNIT)
uniform samplerCube laminaEnvironment;
layout(binding = LAMINA_REFRACTION_TEXTURE_UNIT + LAMINA_REFRACTION_BEHIND_UNIT)
uniform sampler2D laminaBehind;
layout(binding = LAMINA_REFRACTION_TEXTURE_UNIT + LAMINA_REFRACTION_BEHIND_DEPTH_UNIT)
uniform sampler2D laminaBehindDepths;

// A view ray behind its last surface.
struct LaminaRefracted {
    vec3 exit;          // World point where it leaves the object, or the first surface if it never does.
    vec3 direction;     // Unit vector.
    vec3 transmittance; // Of red, green and blue light.
    float inside;       // Length inside the object, world units.
    int events;         // Surfaces met after the first one.
};

// Share of unpolarized light that a surface reflects. cosine: of the angle of incidence, in [0,1];
// eta: refractive index on this side by that on the other. 1 for total internal reflection.
float laminaFresnel(float cosine, float eta) {
    float transmitted = 1.0 - eta * eta * (1.0 - cosine * cosine);
    if (transmitted <= 0.0)
        return 1.0;
    float inner = sqrt(transmitted);
    float s = (eta * cosine - inner) / (eta * cosine + inner);
    float p = (cosine - eta * inner) / (cosine + eta * inner);
    return 0.5 * (s * s + p * p);
}

// The environment around a direction, blurred by a lobe of this standard deviation in radians.
vec3 laminaEnvironmentLight(vec3 direction, float blur) {
    const float kQuarter = 1.5707963267948966;
    float texel = kQuarter / float(laminaRefractionBlock.modes.z) * LAMINA_ENVIRONMENT_SIGMA;
    float level = clamp(log2(max(blur, 1e-6) / texel), 0.0, float(laminaRefractionBlock.modes.y));
    return textureLod(laminaEnvironment, direction, level).rgb;
}

// What a ray that leaves the object sees: what the engine has drawn behind it, if that is known and on the
// screen, else the environment. pixel, depth: of the first surface.
vec3 laminaSeenBehind(LaminaRefracted ray, float blur, vec4 surface) {
    uint flags = laminaRefractionBlock.modes.x;
    if ((flags & LAMINA_REFRACTION_BEHIND) == 0u)
        return laminaEnvironmentLight(ray.direction, blur);
    float distance = laminaRefractionBlock.surface.w;
    LaminaViewConstants view = laminaRefractionBlock.view;
    vec4 place = laminaWindowPoint(view, ray.exit + distance * ray.direction);
    vec2 size = vec2(view.size.xy);
    if (place.w <= 0.0 || any(lessThan(place.xy, vec2(0.0))) || any(greaterThan(place.xy, size)))
        return laminaEnvironmentLight(ray.direction, blur);
    // The blur in pixels: a step across the ray at that distance.
    vec3 across = cross(ray.direction, abs(ray.direction.x) < 0.7 ? vec3(1.0, 0.0, 0.0) : vec3(0.0, 1.0, 0.0));
    vec4 beside = laminaWindowPoint(view, ray.exit + distance * (ray.direction + blur * normalize(across)));
    float level = clamp(log2(max(length(beside.xy - place.xy), 1.0)), 0.0, float(laminaRefractionBlock.sizes.z));
    if ((flags & LAMINA_REFRACTION_BEHIND_DEPTH) != 0u) {
        // What stands before the surface is not seen through it.
        ivec2 pixel = ivec2(min(place.xy, size - 1.0));
        float depth = texelFetch(laminaBehindDepths, pixel, 0).r;
        vec4 drawn = view.windowToWorld * vec4(place.xy, depth, 1.0);
        vec3 point = view.origin.xyz + drawn.xyz / drawn.w;
        if (!laminaIsBackground(view, depth) && laminaWindowPoint(view, point).w < surface.w)
            place.xy = surface.xy;
    }
    return textureLod(laminaBehind, place.xy / size, level).rgb;
}

#if LAMINA_REFRACTION_MODEL == LAMINA_REFRACTION_VOLUME_INTEGRAL

layout(binding = LAMINA_REFRACTION_TEXTURE_UNIT + LAMINA_REFRACTION_THICKNESS_UNIT)
uniform sampler2D laminaThicknesses;

// Length inside the object along the straight view ray of a pixel, world units ([ED06] 3.3).
float laminaThickness(vec2 pixel) {
    return texelFetch(laminaThicknesses, ivec2(pixel), 0).r;
}

// The ray bent at the first surface, the more the longer it stays inside: the offset of the environment
// look-up is scaled by the thickness.
LaminaRefracted laminaRefract(vec3 world, vec3 normal, vec3 direction, vec2 pixel) {
    float thickness = laminaThickness(pixel);
    vec3 bent = refract(direction, normal, 1.0 / laminaRefractionBlock.surface.x);
    float full = laminaRefractionBlock.surface.z;
    float share = full > 0.0 ? min(thickness / full, 1.0) : 1.0;
    vec3 ray = normalize(mix(direction, bent, share));
    return LaminaRefracted(world + thickness * ray, ray, vec3(1.0), thickness, 0);
}

float laminaFirstIndex(vec3 world) {
    return laminaRefractionBlock.surface.x;
}

#else

layout(binding = LAMINA_REFRACTION_TEXTURE_UNIT + LAMINA_REFRACTION_NORMAL_UNIT)
uniform sampler3D laminaVoxelNormals;
layout(binding = LAMINA_REFRACTION_TEXTURE_UNIT + LAMINA_REFRACTION_OPTICS_UNIT)
uniform sampler3D laminaVoxelOptics;
layout(binding = LAMINA_REFRACTION_TEXTURE_UNIT + LAMINA_REFRACTION_BRICK_UNIT)
uniform sampler3D laminaBricks;

// Voxels around a point: sum of normals and weights, and of optics, filtered.
struct LaminaSurfaceSample {
    vec4 normal; // Sum of normals, weight.
    vec4 optics; // Sum of (refractive index, transmittance per world unit).
};

vec3 laminaVolumePoint(vec3 world) {
    return (world - laminaRefractionBlock.volume.xyz) * laminaRefractionBlock.volume.w;
}

LaminaSurfaceSample laminaSurfaceAt(vec3 voxel) {
    vec3 place = voxel / float(laminaRefractionBlock.sizes.x);
    vec4 normal = textureLod(laminaVoxelNormals, place, 0.0);
    vec4 optics = laminaRefractionBlock.optics * normal.a;
    if ((laminaRefractionBlock.modes.x & LAMINA_REFRACTION_OPTICS) != 0u && normal.a > 0.0)
        optics = textureLod(laminaVoxelOptics, place, 0.0);
    return LaminaSurfaceSample(normal, optics);
}

// Optics of the surface at a world point: refractive index, transmittance per world unit.
vec4 laminaOpticsAt(vec3 world) {
    LaminaSurfaceSample found = laminaSurfaceAt(laminaVolumePoint(world));
    return found.normal.a > LAMINA_REFRACTION_LEAST_WEIGHT ? found.optics / found.normal.a
                                                           : laminaRefractionBlock.optics;
}

float laminaFirstIndex(vec3 world) {
    return laminaOpticsAt(world).x;
}

// Voxels that a ray crosses in the brick at `voxel`, if that is empty; 0 if not.
float laminaEmptyStretch(vec3 voxel, vec3 perUnit) {
    ivec3 brick = ivec3(voxel) / LAMINA_REFRACTION_BRICK;
    if (texelFetch(laminaBricks, brick, 0).r != 0.0)
        return 0.0;
    vec3 low = vec3(brick * LAMINA_REFRACTION_BRICK);
    vec3 high = low + float(LAMINA_REFRACTION_BRICK);
    vec3 side = mix(low, high, greaterThan(perUnit, vec3(0.0)));
    vec3 stretch = mix((side - voxel) / perUnit, vec3(1e30), equal(perUnit, vec3(0.0)));
    return min(min(stretch.x, stretch.y), stretch.z);
}

// Marches a ray that enters the object at `world` through the volume ([CLN11] 4.1). A surface is a run of
// voxels with similar normals: where it ends, the ray is refracted or totally reflected at the run's mean
// point and normal. After that, voxels with similar normals are the same surface's until the ray is some
// voxels away from its plane.
LaminaRefracted laminaRefract(vec3 world, vec3 normal, vec3 direction, vec2 pixel) {
    vec4 media[LAMINA_REFRACTION_MAX_MEDIA];
    media[0] = vec4(1.0);
    media[1] = laminaOpticsAt(world);
    int depth = 1;
    LaminaRefracted ray =
        LaminaRefracted(world, refract(direction, normal, 1.0 / media[1].x), vec3(1.0), 0.0, 0);
    float alike = laminaRefractionBlock.blur.w;
    float size = float(laminaRefractionBlock.sizes.x);
    int greatest = int(laminaRefractionBlock.modes.w);
    vec3 last = normal;
    bool isSame = true;
    bool isWaiting = false; // The last surface lies ahead: a run is open.
    vec4 sum = vec4(0.0);
    vec4 optics = vec4(0.0);
    float center = 0.0;
    vec2 slant = vec2(0.0); // Cosines of ray and normal at the run's first and last voxel.
    float passed = 0.0;     // World units from ray.exit.
    vec3 start = laminaVolumePoint(world);
    vec3 perUnit = ray.direction * laminaRefractionBlock.volume.w;
    for (int i = 0; i < LAMINA_REFRACTION_MAX_STEPS && ray.events < greatest; ++i) {
        vec3 along = abs(perUnit);
        float step = LAMINA_REFRACTION_STEP / max(max(along.x, along.y), along.z);
        passed += step;
        vec3 voxel = start + passed * perUnit;
        bool isOutside = any(lessThan(voxel, vec3(0.0))) || any(greaterThanEqual(voxel, vec3(size)));
        LaminaSurfaceSample found = LaminaSurfaceSample(vec4(0.0), vec4(0.0));
        if (!isOutside) {
            float stretch = isWaiting ? 0.0 : laminaEmptyStretch(voxel, perUnit);
            if (stretch > 0.0) {
                passed += max(stretch - step, 0.0);
                continue;
            }
            found = laminaSurfaceAt(voxel);
        }
        bool isEmpty = found.normal.a < LAMINA_REFRACTION_LEAST_WEIGHT;
        vec3 facing = normalize(found.normal.xyz + vec3(1e-20));
        bool ends = isWaiting && (isEmpty || dot(facing, normalize(sum.xyz + vec3(1e-20))) < alike);
        if (ends) {
            // 1. The surface: mean point and normal of the run.
            float distance = center / sum.w;
            vec3 surface = normalize(sum.xyz + vec3(1e-20));
            bool isEntering = dot(ray.direction, surface) < 0.0;
            last = surface;
            isSame = true;
            isWaiting = false;
            vec4 body = optics / sum.w;
            sum = vec4(0.0);
            optics = vec4(0.0);
            center = 0.0;
            // A ray that first nears a surface and then leaves it passes beside it.
            bool isCrossing = slant.x * slant.y > 0.0;
            if (isCrossing && (isEntering ? depth + 1 < LAMINA_REFRACTION_MAX_MEDIA : depth > 0)) {
                // 2. What the medium takes from here to there.
                ray.transmittance *= depth > 0 ? pow(media[depth].yzw, vec3(distance)) : vec3(1.0);
                ray.inside += depth > 0 ? distance : 0.0;
                ray.exit += distance * ray.direction;
                // 3. Snell's law.
                float next = isEntering ? body.x : media[depth - 1].x;
                vec3 towards = isEntering ? surface : -surface;
                vec3 bent = refract(ray.direction, towards, media[depth].x / next);
                if (bent == vec3(0.0)) {
                    ray.direction = reflect(ray.direction, towards);
                } else {
                    ray.direction = normalize(bent);
                    depth += isEntering ? 1 : -1;
                    if (isEntering)
                        media[depth] = body;
                }
                ++ray.events;
                start = laminaVolumePoint(ray.exit);
                perUnit = ray.direction * laminaRefractionBlock.volume.w;
                passed = 0.0;
                continue;
            }
        }
        if (isOutside)
            break;
        // Near the last surface the ray may leave its voxels, which stand in steps, and meet them again.
        float away = passed * abs(dot(perUnit, last));
        isSame = isSame && away < LAMINA_REFRACTION_SURFACE_DEPTH;
        if (isEmpty || (isSame && dot(facing, last) >= alike))
            continue;
        slant.y = dot(ray.direction, facing);
        slant.x = isWaiting ? slant.x : slant.y;
        isSame = false;
        isWaiting = true;
        sum += found.normal;
        optics += found.optics;
        center += found.normal.a * passed;
    }
    return ray;
}

#endif

// What is seen at a world point of the object's surface: red, green, blue, and 1. normal: outward, any
// length; pixel: window coordinates of the point.
vec4 laminaRefraction(vec3 world, vec3 normal, vec2 pixel) {
    vec3 towards = laminaTowardsViewer(laminaRefractionBlock.view, world);
    normal = normalize(normal);
    // Interpolated normals may turn away at the silhouette: they are taken to be just seen.
    const float kLeastCosine = 0.01;
    float cosine = dot(normal, towards);
    if (cosine < kLeastCosine) {
        normal = normalize(normal + (kLeastCosine - cosine) * towards);
        cosine = kLeastCosine;
    }
    LaminaRefracted ray = laminaRefract(world, normal, -towards, pixel);
    float blur = laminaRefractionBlock.blur.y + laminaRefractionBlock.blur.z * ray.inside;
    vec4 surface = vec4(pixel, 0.0, laminaWindowPoint(laminaRefractionBlock.view, world).w);
    vec3 light = laminaSeenBehind(ray, blur, surface) * ray.transmittance;
    vec4 body = laminaRefractionBlock.body;
    if ((laminaRefractionBlock.modes.x & LAMINA_REFRACTION_POWER) != 0u) {
        float opacity = pow(clamp(ray.inside / laminaRefractionBlock.blur.x, 0.0, 1.0), body.w);
        light = mix(light, body.rgb, opacity);
    } else {
        light *= exp(-body.rgb * ray.inside);
    }
    float reflected = laminaRefractionBlock.surface.y * laminaFresnel(cosine, 1.0 / laminaFirstIndex(world));
    vec3 mirrored = reflect(-towards, normal);
    return vec4(mix(light, laminaEnvironmentLight(mirrored, laminaRefractionBlock.blur.y), min(reflected, 1.0)), 1.0);
}

#endif
