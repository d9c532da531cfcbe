// Resamples depth maps of lights into epipolar voxels, all shadow volumes of a batch in one dispatch
// ([WD13] 2.6, 3.1.3).
//
// Launch: ceil(theta samples / LAMINA_EPIPOLAR_RECTIFY_ROWS) x phi groups x shadow volumes work groups. A
// work group owns some rows (all alpha) of one texel layer, one after the other in shared memory; an
// invocation owns one phi sample, and so one light ray (theta, phi) a row:
//   1. clear the row; barrier;
//   2. find the texel of the depth map that the ray passes, and alpha of the surface point at that
//      texel's centre (a point that surely is on the surface, which the texel's depth along the ray's own
//      direction is not);
//   3. set the ray's bit in the first voxel whose centre lies behind that point: so, after the scan, a
//      bit is the visibility at its voxel's centre. An atomic OR, because rays share words; barrier;
//   4. store the row and clear it for the next; barrier. Every texel is written, so the target needs no
//      clear.
// Occluders before the volume's alpha range shadow all of the ray, those behind it nothing.
// permute LAMINA_EPIPOLAR_MAP = LAMINA_EPIPOLAR_MAP_OWN LAMINA_EPIPOLAR_MAP_2D LAMINA_EPIPOLAR_MAP_ARRAY LAMINA_EPIPOLAR_MAP_CUBE LAMINA_EPIPOLAR_MAP_HEMISPHERE
// permute LAMINA_EPIPOLAR_ALPHA_CAPACITY = 128 512 2048
#include <lamina/shared/epipolar_block.glsl>
#include <voxelize/hemisphere.glsl>

layout(local_size_x = 128) in;

layout(std430, binding = LAMINA_EPIPOLAR_PASS_SPACE_BINDING) readonly buffer LaminaEpipolarBlock {
    LaminaEpipolarSpace laminaEpipolarSpaces[];
};
layout(std430, binding = LAMINA_EPIPOLAR_PASS_MAP_BINDING) readonly buffer LaminaEpipolarMapBlock {
    LaminaEpipolarMap laminaEpipolarMaps[];
};
layout(rgba32ui, binding = LAMINA_EPIPOLAR_PASS_WORD_IMAGE) writeonly uniform uimage2DArray laminaEpipolarImage;

#if LAMINA_EPIPOLAR_MAP == LAMINA_EPIPOLAR_MAP_2D
layout(binding = LAMINA_EPIPOLAR_PASS_DEPTH_UNIT) uniform sampler2D laminaEpipolarDepth;
#elif LAMINA_EPIPOLAR_MAP == LAMINA_EPIPOLAR_MAP_CUBE
layout(binding = LAMINA_EPIPOLAR_PASS_DEPTH_UNIT) uniform samplerCube laminaEpipolarDepth;
#else
layout(binding = LAMINA_EPIPOLAR_PASS_DEPTH_UNIT) uniform sampler2DArray laminaEpipolarDepth;
#endif

shared uint laminaEpipolarRow[LAMINA_EPIPOLAR_ALPHA_CAPACITY * 4];

// A ray of the light in the frame (u, v, axis) around the eye.
struct Ray {
    vec3 origin;
    vec3 direction;
};

// Finds the first surface along the ray; false if there is none. `surface` is relative to the eye.
bool findSurface(LaminaEpipolarMap map, Ray ray, float lightDistance, out vec3 surface);

#if LAMINA_EPIPOLAR_MAP == LAMINA_EPIPOLAR_MAP_OWN
// The frame (u, v, light to eye) around the light, with its axes ordered as (s, t, depth) of a face.
vec3 toFace(int face, vec3 point) {
    vec3 ordered = point;
    if (face == LAMINA_EPIPOLAR_FACE_PLUS_U || face == LAMINA_EPIPOLAR_FACE_MINUS_U)
        ordered = point.yzx;
    else if (face == LAMINA_EPIPOLAR_FACE_PLUS_V || face == LAMINA_EPIPOLAR_FACE_MINUS_V)
        ordered = point.xzy;
    bool isNegative = face == LAMINA_EPIPOLAR_FACE_MINUS_U || face == LAMINA_EPIPOLAR_FACE_MINUS_V ||
                      face == LAMINA_EPIPOLAR_FACE_BACK;
    return vec3(ordered.xy, isNegative ? -ordered.z : ordered.z);
}

vec3 fromFace(int face, vec3 point) {
    bool isNegative = face == LAMINA_EPIPOLAR_FACE_MINUS_U || face == LAMINA_EPIPOLAR_FACE_MINUS_V ||
                      face == LAMINA_EPIPOLAR_FACE_BACK;
    vec3 ordered = vec3(point.xy, isNegative ? -point.z : point.z);
    if (face == LAMINA_EPIPOLAR_FACE_PLUS_U || face == LAMINA_EPIPOLAR_FACE_MINUS_U)
        return ordered.zxy;
    if (face == LAMINA_EPIPOLAR_FACE_PLUS_V || face == LAMINA_EPIPOLAR_FACE_MINUS_V)
        return ordered.xzy;
    return ordered;
}

int faceOf(vec3 direction) {
    vec3 size = abs(direction);
    if (size.z >= max(size.x, size.y))
        return direction.z >= 0.0 ? LAMINA_EPIPOLAR_FACE_FRONT : LAMINA_EPIPOLAR_FACE_BACK;
    if (size.x >= size.y)
        return direction.x >= 0.0 ? LAMINA_EPIPOLAR_FACE_PLUS_U : LAMINA_EPIPOLAR_FACE_MINUS_U;
    return direction.y >= 0.0 ? LAMINA_EPIPOLAR_FACE_PLUS_V : LAMINA_EPIPOLAR_FACE_MINUS_V;
}

bool findSurface(LaminaEpipolarMap map, Ray ray, float lightDistance, out vec3 surface) {
    bool isDirectional = lightDistance == 0.0;
    vec3 direction = vec3(ray.direction.xy, -ray.direction.z);
    int face = isDirectional ? LAMINA_EPIPOLAR_FACE_FRONT : faceOf(direction);
    vec3 onFace = toFace(face, direction);
    // The window belongs to the front face; the others see a right angle.
    float side = map.depth.z;
    vec4 window = face == LAMINA_EPIPOLAR_FACE_FRONT ? map.window : vec4(-1.0, -1.0, vec2(0.5 * side));
    vec2 place = isDirectional ? ray.origin.xy : onFace.xy / onFace.z;
    vec2 texel = clamp(floor((place - window.xy) * window.zw), vec2(0.0), vec2(side - 1.0));
    ivec4 layers = map.layers;
    int layer = face < 2 ? (face == 0 ? layers.x : layers.y)
                         : (face < 4 ? (face == 2 ? layers.z : layers.w)
                                     : (face == 4 ? map.layersAndSpace.x : map.layersAndSpace.y));
    float depth = texelFetch(laminaEpipolarDepth, ivec3(texel, max(layer, 0)), 0).r;
    if (layer < 0 || depth <= 0.0)
        return false;
    vec2 center = window.xy + (texel + 0.5) / window.zw;
    if (isDirectional) {
        surface = vec3(center, map.depth.x + depth * map.depth.y);
    } else {
        vec3 point = fromFace(face, vec3(center, 1.0) * (map.depth.x / depth));
        surface = vec3(point.xy, lightDistance - point.z);
    }
    return true;
}
#elif LAMINA_EPIPOLAR_MAP == LAMINA_EPIPOLAR_MAP_CUBE
bool findSurface(LaminaEpipolarMap map, Ray ray, float lightDistance, out vec3 surface) {
    vec3 direction = mat3(map.toTexel) * ray.direction;
    vec3 size = abs(direction);
    int major = size.x >= size.y && size.x >= size.z ? 0 : (size.y >= size.z ? 1 : 2);
    float longest = max(size.x, max(size.y, size.z));
    // Texel centres of a cube face lie at odd multiples of 1 / side in each of its two axes.
    float side = map.depth.w;
    vec3 scaled = direction / longest;
    vec3 center = (clamp(floor((scaled * 0.5 + 0.5) * side), 0.0, side - 1.0) + 0.5) * (2.0 / side) - 1.0;
    center = mix(center, sign(scaled), equal(ivec3(major), ivec3(0, 1, 2)));
    float depth = textureLod(laminaEpipolarDepth, center, 0.0).r;
    if (depth == map.depth.x)
        return false;
    surface = ray.origin + mat3(map.fromTexel) * center * (map.depth.y / (map.depth.z + depth));
    return true;
}
#elif LAMINA_EPIPOLAR_MAP == LAMINA_EPIPOLAR_MAP_HEMISPHERE
bool findSurface(LaminaEpipolarMap map, Ray ray, float lightDistance, out vec3 surface) {
    vec3 direction = mat3(map.toTexel) * ray.direction;
    if (direction.z <= 0.0)
        return false;
    vec2 side = map.window.zw;
    vec2 texel = clamp(floor((laminaHemisphereToSquare(direction) * 0.5 + 0.5) * side), vec2(0.0), side - 1.0);
    float distance = texelFetch(laminaEpipolarDepth, ivec3(texel + map.window.xy, map.layers.x), 0).r;
    if (distance == map.depth.x)
        return false;
    vec3 center = laminaSquareToHemisphere((texel + 0.5) * (2.0 / side) - 1.0);
    surface = ray.origin + mat3(map.fromTexel) * center * distance;
    return true;
}
#else
bool findSurface(LaminaEpipolarMap map, Ray ray, float lightDistance, out vec3 surface) {
    vec4 clip = map.toTexel * vec4(ray.origin + ray.direction * max(lightDistance, 1.0), 1.0);
    if (clip.w <= 0.0)
        return false;
    vec2 texel = floor(clip.xy / clip.w);
    if (any(lessThan(texel, vec2(0.0))) || any(greaterThanEqual(texel, map.window.zw)))
        return false;
    ivec2 place = ivec2(texel + map.window.xy);
#if LAMINA_EPIPOLAR_MAP == LAMINA_EPIPOLAR_MAP_ARRAY
    float depth = texelFetch(laminaEpipolarDepth, ivec3(place, map.layers.x), 0).r;
#else
    float depth = texelFetch(laminaEpipolarDepth, place, 0).r;
#endif
    if (depth == map.depth.x)
        return false;
    vec4 point = map.fromTexel * vec4(texel + 0.5, depth, 1.0);
    surface = point.xyz / point.w;
    return true;
}
#endif

// The first alpha voxel that the ray's occluder shadows; a number of voxels for none.
int firstShadowed(LaminaEpipolarMap map, LaminaEpipolarSpace space, vec2 angles) {
    float lightDistance = space.eye.w;
    bool isDirectional = (space.size.w & LAMINA_EPIPOLAR_DIRECTIONAL) != 0u;
    vec2 around = vec2(cos(angles.x), sin(angles.x));
    Ray ray = isDirectional
                  ? Ray(vec3(around * angles.y, 0.0), vec3(0.0, 0.0, -1.0))
                  : Ray(vec3(0.0, 0.0, lightDistance), vec3(around * sin(angles.y), -cos(angles.y)));
    if (dot(vec3(ray.direction.xy, -ray.direction.z), map.spot.xyz) < map.spot.w)
        return 0;
    vec3 surface;
    if (!findSurface(map, ray, lightDistance, surface))
        return int(space.size.x);
    float alpha = (atan(length(surface.xy), surface.z) - space.origin.x) * space.scale.x;
    return int(clamp(ceil(alpha - 0.5), 0.0, float(space.size.x)));
}

void main() {
    LaminaEpipolarMap map = laminaEpipolarMaps[gl_WorkGroupID.z];
    LaminaEpipolarSpace space = laminaEpipolarSpaces[map.layersAndSpace.z];
    uint alphaCount = min(space.size.x, uint(LAMINA_EPIPOLAR_ALPHA_CAPACITY));
    for (uint i = gl_LocalInvocationID.x; i < alphaCount * 4u; i += gl_WorkGroupSize.x)
        laminaEpipolarRow[i] = 0u;
    barrier();

    uint bit = gl_LocalInvocationID.x;
    uint phi = gl_WorkGroupID.y * space.tile.z + bit;
    uint firstRow = gl_WorkGroupID.x * LAMINA_EPIPOLAR_RECTIFY_ROWS;
    uint endRow = min(firstRow + LAMINA_EPIPOLAR_RECTIFY_ROWS, space.size.y);
    for (uint row = firstRow; row < endRow; ++row) {
        if (bit < space.tile.z && phi < space.size.z) {
            vec2 sampled = vec2(row, phi) + 0.5;
            int first = firstShadowed(map, space, space.origin.yz + sampled / space.scale.yz);
            if (first < int(alphaCount))
                atomicOr(laminaEpipolarRow[uint(first) * 4u + (bit >> 5)], 1u << (bit & 31u));
        }
        barrier();
        ivec3 origin = ivec3(space.tile.xy + uvec2(0u, row), gl_WorkGroupID.y);
        for (uint i = gl_LocalInvocationID.x; i < alphaCount; i += gl_WorkGroupSize.x) {
            uvec4 bits;
            for (int word = 0; word < 4; ++word) {
                bits[word] = laminaEpipolarRow[i * 4u + word];
                laminaEpipolarRow[i * 4u + word] = 0u;
            }
            imageStore(laminaEpipolarImage, origin + ivec3(i, 0, 0), bits);
        }
        barrier();
    }
}
