// Splats point samples into the maps of all virtual lights at once ([WD13] 3.1.2; imperfect shadow maps).
//
// Launch: ceil(points a map / 64) x maps work groups. An invocation owns a point of a map, one drawn from an
// equal share of the list, another one for each map:
//   1. bring the point's disk into the frame of the light;
//   2. for each texel of the disk's box, cut the ray of the texel's centre with the disk's plane; inside
//      the disk (and, where the triangle is larger than the point's share of it, inside the triangle, so that
//      silhouettes stay sharp) keep the nearest distance. An atomic minimum, because disks overlap;
//      distances are positive, so their bits are in their order.
// Points behind the light or outside the map are dropped.
// permute LAMINA_SPLAT_DIRECTIONAL = 0 1
#include <area_light/random.glsl>
#include <lamina/shared/imperfect_block.glsl>
#include <voxelize/hemisphere.glsl>

layout(local_size_x = 64) in;

layout(std140, binding = LAMINA_SPLAT_UNIFORM_BINDING) uniform LaminaSplatBlock {
    LaminaSplatConstants laminaSplat;
};
layout(std430, binding = LAMINA_SPLAT_TRIANGLE_BINDING) readonly buffer LaminaTriangleBlock {
    float laminaTriangles[];
};
layout(std430, binding = LAMINA_SPLAT_POINT_BINDING) readonly buffer LaminaPointBlock {
    LaminaPointSample laminaPoints[];
};
layout(std430, binding = LAMINA_SPLAT_MAP_BINDING) readonly buffer LaminaMapBlock {
    LaminaImperfectMap laminaMaps[];
};
layout(r32ui, binding = LAMINA_SPLAT_IMAGE) uniform uimage2DArray laminaImage;

vec3 toMap(uint map, vec3 world) {
    vec4 point = vec4(world, 1.0);
    return vec3(dot(laminaMaps[map].rows[0], point), dot(laminaMaps[map].rows[1], point),
                dot(laminaMaps[map].rows[2], point));
}

vec3 corner(uint triangle, uint i) {
    uint word = triangle * 9u + i * 3u;
    return vec3(laminaTriangles[word], laminaTriangles[word + 1u], laminaTriangles[word + 2u]);
}

void main() {
    uint slot = gl_GlobalInvocationID.x;
    uint map = laminaSplat.counts.w + gl_WorkGroupID.y;
    uint perMap = laminaSplat.counts.z;
    if (slot >= perMap)
        return;
    float stride = float(laminaSplat.counts.y) / float(perMap);
    uint index = min(uint((float(slot) + laminaRandom(slot * 1024u + map)) * stride), laminaSplat.counts.y - 1u);
    LaminaPointSample point = laminaPoints[index];
    float radius = point.position.w * laminaSplat.numbers.x;
    if (radius == 0.0)
        return;

    // A disk in the plane of the triangle; or, where the triangle is larger than that, an ellipse, the disk of an
    // equilateral triangle of that area brought to its shape: disks, cut off by a long thin triangle, would leave
    // most of it bare. In the frame of the map, where u and v span it.
    bool isClipped = point.normal.w > 3.14159265 * radius * radius;
    radius *= isClipped ? LAMINA_SPLAT_OVERLAP : LAMINA_SPLAT_OVERLAP_SMALL;
    vec3 normal = point.normal.xyz;
    vec3 other = abs(normal.x) < 0.5 ? vec3(1.0, 0.0, 0.0) : vec3(0.0, 1.0, 0.0);
    vec3 tangent = normalize(cross(other, normal));
    vec3 center = toMap(map, point.position.xyz);
    vec3 u = toMap(map, point.position.xyz + radius * tangent) - center;
    vec3 v = toMap(map, point.position.xyz + radius * cross(normal, tangent)) - center;
    vec3 first = vec3(0.0);
    vec3 toB = vec3(0.0);
    vec3 toC = vec3(0.0);
    if (isClipped) {
        first = toMap(map, corner(point.triangle.x, 0u));
        vec3 edgeB = toMap(map, corner(point.triangle.x, 1u)) - first;
        vec3 edgeC = toMap(map, corner(point.triangle.x, 2u)) - first;
        vec3 plane = cross(edgeB, edgeC);
        float edgeScale = 1.0 / dot(plane, plane);
        toB = edgeScale * cross(edgeC, plane);
        toC = edgeScale * cross(plane, edgeB);
        // The equilateral triangle's edge squared is 4 / sqrt(3) times its area.
        float part = radius * sqrt(0.4330127 / point.normal.w);
        u = part * edgeB;
        v = part * (2.0 * edgeC - edgeB) * 0.5773503;
    }
    vec3 across = cross(u, v);

    int side = int(laminaSplat.counts.x);
    float perUnit = 0.5 * float(side);
#if LAMINA_SPLAT_DIRECTIONAL
    vec2 place = center.xy;
    vec2 reach = perUnit * vec2(length(vec2(u.x, v.x)), length(vec2(u.y, v.y)));
    if (center.z < 0.0)
        return;
#else
    if (center.z <= 0.0)
        return;
    vec2 place = laminaHemisphereToSquare(center);
    vec2 toEnd = abs(laminaHemisphereToSquare(center + u) - place);
    vec2 toSide = abs(laminaHemisphereToSquare(center + v) - place);
    // The map is not linear; some more makes up for that.
    vec2 reach = 1.25 * perUnit * sqrt(toEnd * toEnd + toSide * toSide);
    if (min(center.z + u.z, center.z + v.z) <= 0.0)
        reach = vec2(float(LAMINA_SPLAT_MOST_TEXELS));
#endif
    reach = min(reach, vec2(LAMINA_SPLAT_MOST_TEXELS));
    vec2 middle = (place * 0.5 + 0.5) * float(side);
    ivec2 low = max(ivec2(floor(middle - reach)), ivec2(0));
    ivec2 high = min(ivec2(floor(middle + reach)), ivec2(side - 1));
    // Rows that take an offset in the disk's plane to coordinates of the disk, and of the triangle.
    float scale = 1.0 / dot(across, across);
    vec3 toU = scale * cross(v, across);
    vec3 toV = scale * cross(across, u);
    float above = dot(across, center);
    for (int y = low.y; y <= high.y; ++y)
        for (int x = low.x; x <= high.x; ++x) {
            vec2 square = (vec2(x, y) + 0.5) * (2.0 / float(side)) - 1.0;
#if LAMINA_SPLAT_DIRECTIONAL
            vec3 origin = vec3(square, 0.0);
            vec3 direction = vec3(0.0, 0.0, 1.0);
#else
            vec3 origin = vec3(0.0);
            vec3 direction = laminaSquareToHemisphere(square);
#endif
            float t = (above - dot(across, origin)) / dot(across, direction);
            vec3 hit = origin + t * direction;
            vec3 offset = hit - center;
            vec2 disk = vec2(dot(offset, toU), dot(offset, toV));
            vec3 inside = hit - first;
            vec2 weights = vec2(dot(inside, toB), dot(inside, toC));
            bool isOutside = min(min(weights.x, weights.y), 1.0 - weights.x - weights.y) < 0.0;
            if (!(t > 0.0) || dot(disk, disk) > 1.0 || (isClipped && isOutside))
                continue;
            imageAtomicMin(laminaImage, ivec3(x, y, map), floatBitsToUint(t));
        }
}
