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
    bool isOpen;        // Marched: it met a back face from outside, or never left: the surface has a hole there.
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
    return LaminaRefracted(world + thickness * ray, ray, vec3(1.0), thickness, 0, false);
}

float laminaFirstIndex(vec3 world, vec3 normal) {
    return laminaRefractionBlock.surface.x;
}

#else

layout(binding = LAMINA_REFRACTION_TEXTURE_UNIT + LAMINA_REFRACTION_PLANE_UNIT)
uniform sampler3D laminaVoxelPlanes;
layout(binding = LAMINA_REFRACTION_TEXTURE_UNIT + LAMINA_REFRACTION_OPTICS_UNIT)
uniform sampler3D laminaVoxelOptics;
layout(binding = LAMINA_REFRACTION_TEXTURE_UNIT + LAMINA_REFRACTION_BRICK_UNIT)
uniform sampler3D laminaBricks;

// The surfaces around a point, as a ray sees them: the mean planes of the voxels that it enters by and of those
// that it leaves by. A ray beside a surface sees both, before and behind the place where it is nearest, and
// never crosses the one that turns towards it.
struct LaminaSurfaces {
    vec4 entering; // Sum of normals times weights; of the point's distances outside the surface, voxels.
    vec4 leaving;
};

vec3 laminaVolumePoint(vec3 world) {
    return (world - laminaRefractionBlock.volume.xyz) * laminaRefractionBlock.volume.w;
}

// Weight of the voxel at `corner + offset`, of the eight around a point, and its place.
float laminaVoxelWeight(vec3 point, ivec3 offset, out ivec3 voxel, out vec3 apart) {
    vec3 corner = floor(point - 0.5);
    vec3 share = point - 0.5 - corner;
    vec3 weights = mix(1.0 - share, share, vec3(offset));
    voxel = clamp(ivec3(corner) + offset, ivec3(0), ivec3(int(laminaRefractionBlock.sizes.x) - 1));
    apart = point - (vec3(voxel) + 0.5);
    return weights.x * weights.y * weights.z;
}

void laminaAddSurface(inout LaminaSurfaces sum, vec3 point, vec3 direction, ivec3 offset) {
    ivec3 voxel;
    vec3 apart;
    float weight = laminaVoxelWeight(point, offset, voxel, apart);
    vec4 plane = texelFetch(laminaVoxelPlanes, voxel, 0);
    plane = weight * vec4(plane.xyz, plane.w + dot(plane.xyz, apart));
    if (dot(plane.xyz, direction) < 0.0)
        sum.entering += plane;
    else
        sum.leaving += plane;
}

// point: in voxels. Eight calls, not a loop: software GL counts every iteration of an invocation.
LaminaSurfaces laminaSurfacesAt(vec3 point, vec3 direction) {
    LaminaSurfaces sum = LaminaSurfaces(vec4(0.0), vec4(0.0));
    laminaAddSurface(sum, point, direction, ivec3(0, 0, 0));
    laminaAddSurface(sum, point, direction, ivec3(1, 0, 0));
    laminaAddSurface(sum, point, direction, ivec3(0, 1, 0));
    laminaAddSurface(sum, point, direction, ivec3(1, 1, 0));
    laminaAddSurface(sum, point, direction, ivec3(0, 0, 1));
    laminaAddSurface(sum, point, direction, ivec3(1, 0, 1));
    laminaAddSurface(sum, point, direction, ivec3(0, 1, 1));
    laminaAddSurface(sum, point, direction, ivec3(1, 1, 1));
    return sum;
}

// Unit normal, and the distance of the point outside, voxels; all 0 if there is no surface.
vec4 laminaMeanPlane(vec4 sum) {
    float weight = length(sum.xyz);
    return weight < LAMINA_REFRACTION_LEAST_WEIGHT ? vec4(0.0) : sum / weight;
}

// Optics of the surface at a point that faces `normal`: refractive index, transmittance per world unit.
vec4 laminaOpticsAt(vec3 point, vec3 normal) {
    if ((laminaRefractionBlock.modes.x & LAMINA_REFRACTION_OPTICS) == 0u)
        return laminaRefractionBlock.optics;
    vec4 sum = vec4(0.0);
    float weights = 0.0;
    for (int i = 0; i < 8; ++i) {
        ivec3 voxel;
        vec3 apart;
        float weight = laminaVoxelWeight(point, ivec3(i & 1, i >> 1 & 1, i >> 2), voxel, apart);
        weight *= max(dot(texelFetch(laminaVoxelPlanes, voxel, 0).xyz, normal), 0.0);
        sum += weight * texelFetch(laminaVoxelOptics, voxel, 0);
        weights += weight;
    }
    return weights > 0.0 ? sum / weights : laminaRefractionBlock.optics;
}

float laminaFirstIndex(vec3 world, vec3 normal) {
    return laminaOpticsAt(laminaVolumePoint(world), normal).x;
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

// A ray on its way through the volume.
struct LaminaMarch {
    LaminaRefracted ray;
    vec4 media[LAMINA_REFRACTION_MAX_MEDIA]; // That it is in, one within the other: index, transmittance.
    int depth;                               // Of the innermost; 0: outside.
    vec3 last;                               // Normal of the surface it met last.
    bool isNear;                             // It has not been clear of that one.
    vec4 before[2];                          // Planes a step before: those it enters by, those it leaves by.
    float passed;                            // World units from ray.exit.
    int steps;
};

// Does the ray pass from the one side of a plane to the other in a step of so many voxels? The plane's normal
// there, and the share of the step before it; 0 if not. side: 0 if the ray enters by the plane, 1 if it leaves.
vec4 laminaCrossing(inout LaminaMarch march, int side, vec4 plane, float step) {
    vec4 old = march.before[side];
    march.before[side] = plane;
    bool isSeen = plane.xyz != vec3(0.0);
    bool wasSeen = old.xyz != vec3(0.0);
    // One that is seen from here or from the step before alone is carried on.
    vec3 normal = isSeen ? plane.xyz : old.xyz;
    float change = dot(normal, march.ray.direction) * step;
    vec2 ahead = vec2(wasSeen ? old.w : plane.w - change, isSeen ? plane.w : old.w + change);
    ahead = side == 0 ? ahead : -ahead;
    bool isLast = dot(normal, march.last) >= laminaRefractionBlock.blur.w;
    float passed = march.passed * laminaRefractionBlock.volume.w;
    if (isLast && (ahead.y > LAMINA_REFRACTION_CLEAR_DEPTH || passed > LAMINA_REFRACTION_CLEAR_LENGTH))
        march.isNear = false;
    if ((!isSeen && !wasSeen) || !(ahead.x > 0.0 && ahead.y <= 0.0) || (march.isNear && isLast))
        return vec4(0.0);
    float share = ahead.x / (ahead.x - ahead.y);
    // Both steps' normals: what is known before the crossing, and behind.
    return vec4(isSeen && wasSeen ? normalize(mix(old.xyz, plane.xyz, share)) : normal, share);
}

// Marches to the next surface: its outward normal, and how far it is from ray.exit, world units; a normal of 0
// if there is none.
vec4 laminaNextSurface(inout LaminaMarch march) {
    vec3 start = laminaVolumePoint(march.ray.exit);
    vec3 perUnit = march.ray.direction * laminaRefractionBlock.volume.w;
    vec3 along = abs(perUnit);
    float step = LAMINA_REFRACTION_STEP / max(max(along.x, along.y), along.z);
    float size = float(laminaRefractionBlock.sizes.x);
    vec4 found = vec4(0.0);
    while (found.xyz == vec3(0.0) && march.steps < LAMINA_REFRACTION_MAX_STEPS) {
        ++march.steps;
        march.passed += step;
        vec3 point = start + march.passed * perUnit;
        if (any(lessThan(point, vec3(0.0))) || any(greaterThanEqual(point, vec3(size)))) {
            march.ray.isOpen = march.ray.isOpen || march.depth > 0;
            break;
        }
        float stretch = laminaEmptyStretch(point, perUnit);
        if (stretch > 0.0) {
            march.passed += max(stretch - step, 0.0);
            march.before[0] = vec4(0.0);
            march.before[1] = vec4(0.0);
            march.isNear = false;
            continue;
        }
        LaminaSurfaces around = laminaSurfacesAt(point, march.ray.direction);
        float voxels = step * laminaRefractionBlock.volume.w;
        vec4 enters = laminaCrossing(march, 0, laminaMeanPlane(around.entering), voxels);
        vec4 leaves = laminaCrossing(march, 1, laminaMeanPlane(around.leaving), voxels);
        found = enters.xyz != vec3(0.0) ? enters : leaves;
        found.w = march.passed - step * (1.0 - found.w);
    }
    return found;
}

// Takes the ray to a surface that laminaNextSurface() has found, and on: Snell's law, or total reflection.
// Nothing happens where it cannot be: beyond the deepest nest, or at a back face from outside, which open
// surfaces show.
void laminaMeet(inout LaminaMarch march, vec3 normal, float distance) {
    bool isEntering = dot(normal, march.ray.direction) < 0.0;
    if (isEntering ? march.depth + 1 >= LAMINA_REFRACTION_MAX_MEDIA : march.depth == 0) {
        march.ray.isOpen = march.ray.isOpen || !isEntering;
        return;
    }
    vec4 medium = march.media[march.depth];
    if (march.depth > 0) {
        march.ray.transmittance *= pow(max(medium.yzw, 1e-37), vec3(distance));
        march.ray.inside += distance;
    }
    march.ray.exit += distance * march.ray.direction;
    vec4 body = laminaOpticsAt(laminaVolumePoint(march.ray.exit), normal);
    float next = isEntering ? body.x : march.media[march.depth - 1].x;
    vec3 towards = isEntering ? normal : -normal;
    vec3 bent = refract(march.ray.direction, towards, medium.x / next);
    if (bent == vec3(0.0)) {
        march.ray.direction = reflect(march.ray.direction, towards);
    } else {
        march.ray.direction = normalize(bent);
        march.depth += isEntering ? 1 : -1;
        if (isEntering)
            march.media[march.depth] = body;
    }
    ++march.ray.events;
    march.last = normal;
    march.isNear = true;
    march.before[0] = vec4(0.0);
    march.before[1] = vec4(0.0);
    march.passed = 0.0;
}

// Marches a ray that enters the object at `world` through the volume ([CLN11] 4.1). Each step asks for the
// planes of the surfaces around. Where the ray passes from the one side of a plane to the other, it is refracted
// or totally reflected. A plane with a normal like the last surface's is that surface's again, until the ray
// has been clear of it.
LaminaRefracted laminaRefract(vec3 world, vec3 normal, vec3 direction, vec2 pixel) {
    LaminaMarch march;
    march.media[0] = vec4(1.0);
    march.media[1] = laminaOpticsAt(laminaVolumePoint(world), normal);
    march.depth = 1;
    vec3 bent = refract(direction, normal, 1.0 / march.media[1].x);
    march.ray = LaminaRefracted(world, bent, vec3(1.0), 0.0, 0, false);
    march.last = normal;
    march.isNear = true;
    march.before = vec4[2](vec4(0.0), vec4(0.0));
    march.passed = 0.0;
    march.steps = 0;
    int greatest = int(laminaRefractionBlock.modes.w);
    while (march.ray.events < greatest) {
        vec4 surface = laminaNextSurface(march);
        if (surface.xyz == vec3(0.0))
            break;
        laminaMeet(march, surface.xyz, surface.w);
    }
    return march.ray;
}

#endif

// What is seen at a world point of the object's surface: red, green, blue, and 1. normal: outward, any
// length; pixel: window coordinates of the point; ray: the way of the light that passes through.
vec4 laminaRefraction(vec3 world, vec3 normal, vec2 pixel, out LaminaRefracted ray) {
    vec3 towards = laminaTowardsViewer(laminaRefractionBlock.view, world);
    // The squares of very long and very short ones are beyond floats.
    float largest = max(max(abs(normal.x), abs(normal.y)), abs(normal.z));
    normal = largest > 0.0 ? normal / largest : vec3(0.0);
    normal = dot(normal, normal) > 0.0 ? normalize(normal) : towards;
    // Interpolated normals may turn away at the silhouette: they are taken to be just seen.
    const float kLeastCosine = 0.01;
    float cosine = dot(normal, towards);
    if (cosine < kLeastCosine) {
        normal = normalize(normal + (kLeastCosine - cosine) * towards);
        cosine = kLeastCosine;
    }
    ray = laminaRefract(world, normal, -towards, pixel);
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
    float reflected = laminaRefractionBlock.surface.y * laminaFresnel(cosine, 1.0 / laminaFirstIndex(world, normal));
    vec3 mirrored = reflect(-towards, normal);
    return vec4(mix(light, laminaEnvironmentLight(mirrored, laminaRefractionBlock.blur.y), min(reflected, 1.0)), 1.0);
}

vec4 laminaRefraction(vec3 world, vec3 normal, vec2 pixel) {
    LaminaRefracted ray;
    return laminaRefraction(world, normal, pixel, ray);
}

#endif
