// A triangle's surface: its area in voxels, and its normal, colour and material at points of it.
//
// The triangle is seen along the grid axis w that is nearest to its normal, so that its shadow on the
// (u, v) plane is widest and its plane w = slope . (u, v) + offset is flat: |slope| <= 1.
#include <lamina/shared/attribute_block.glsl>
#include <lamina/shared/volume_block.glsl>
#include <voxelize/attribute_area.glsl>

layout(std140, binding = LAMINA_ATTRIBUTE_BLOCK_BINDING) uniform LaminaAttributeBlock {
    LaminaAttributeConstants laminaBatch;
};
layout(std140, binding = LAMINA_VOLUME_MATERIAL_BLOCK_BINDING) uniform LaminaMaterialBlock {
    LaminaMaterialConstants laminaMaterials[LAMINA_MAX_MATERIALS];
};
layout(std430, binding = LAMINA_OVERLAP_NORMALS_BINDING) readonly buffer LaminaNormalWords {
    uint laminaNormalWords[];
};
layout(std430, binding = LAMINA_OVERLAP_COLORS_BINDING) readonly buffer LaminaColorWords {
    uint laminaColorWords[];
};

struct LaminaSurface {
    int axis; // w
    // Segments and points have no area: nothing below them is set.
    bool hasArea;
    dvec3 low, high;         // Bounding box, grid coordinates.
    dvec2 edgeNormals[3];    // Edge i from corner i on, in (u, v): distance of a point from it is
    double edgeOffsets[3];   // dot(edgeNormals[i], p) + edgeOffsets[i], positive inside.
    float inverseHeights[3]; // 1 / distance of the opposite corner.
    dvec2 slope;
    double offset;
    float areaScale; // From areas in (u, v) to weights in [0,1].
    float shadow;    // Area of the whole triangle in (u, v).
    vec3 normals[3]; // World, any length.
    vec4 colors[3];
    uint material;
};

dvec2 laminaAlong(int axis, dvec3 p) {
    return axis == 0 ? p.yz : axis == 1 ? p.zx : p.xy;
}

vec3 laminaFetchNormal(uint vertex) {
    uint word = laminaOverlap.normals.x + vertex * laminaOverlap.normals.y;
    vec3 local = uintBitsToFloat(uvec3(laminaNormalWords[word], laminaNormalWords[word + 1u], laminaNormalWords[word + 2u]));
    vec3 normal = vec3(dot(laminaOverlap.normalToWorld[0].xyz, local), dot(laminaOverlap.normalToWorld[1].xyz, local),
                       dot(laminaOverlap.normalToWorld[2].xyz, local));
    float size = length(normal);
    return size > 0.0 && !isinf(size) ? normal / size : vec3(0.0);
}

vec4 laminaFetchColor(uint vertex) {
    uint word = laminaOverlap.colors.x + vertex * laminaOverlap.colors.y;
    if (laminaOverlap.colors.z == LAMINA_COLORS_NONE)
        return vec4(1.0);
    if (laminaOverlap.colors.z == LAMINA_COLORS_UNORM8)
        return unpackUnorm4x8(laminaColorWords[word]);
    vec4 color = uintBitsToFloat(uvec4(laminaColorWords[word], laminaColorWords[word + 1u], laminaColorWords[word + 2u],
                                       laminaColorWords[word + 3u]));
    return mix(clamp(color, 0.0, 1.0), vec4(0.0), isnan(color));
}

// Of the triangle's first vertex; ids past the table's end use its last material.
uint laminaFetchMaterial(uint vertex) {
    uint id = laminaOverlap.materials.x;
    if (laminaOverlap.materials.y != 0u)
        id = laminaColorWords[id + vertex * laminaOverlap.materials.y];
    return min(id, laminaBatch.batch.z);
}

LaminaSurface laminaSurfaceOf(uint triangle, dvec3 corners[3]) {
    LaminaSurface s;
    s.low = min(corners[0], min(corners[1], corners[2]));
    s.high = max(corners[0], max(corners[1], corners[2]));
    dvec3 normal = cross(corners[1] - corners[0], corners[2] - corners[0]);
    dvec3 sizes = abs(normal);
    s.axis = sizes.z >= sizes.x && sizes.z >= sizes.y ? 2 : sizes.y >= sizes.x ? 1 : 0;
    double facing = s.axis == 2 ? normal.z : s.axis == 1 ? normal.y : normal.x;
    dvec3 extent = s.high - s.low;
    double longest = max(extent.x, max(extent.y, extent.z));
    // Below: rounding of the corners' own coordinates decides about the area.
    s.hasArea = abs(facing) > 1.0e-12lf * longest * longest && abs(facing) > 1.0e-30lf;
    vec3 faceNormal = vec3(0.0);
    if (s.hasArea) {
        double turn = sign(facing);
        dvec2 p[3] = dvec2[](laminaAlong(s.axis, corners[0]), laminaAlong(s.axis, corners[1]), laminaAlong(s.axis, corners[2]));
        for (int i = 0; i < 3; ++i) {
            dvec2 along = p[(i + 1) % 3] - p[i];
            s.edgeNormals[i] = dvec2(-along.y, along.x) * (turn / length(along));
            s.edgeOffsets[i] = -dot(s.edgeNormals[i], p[i]);
            s.inverseHeights[i] = float(1.0lf / (dot(s.edgeNormals[i], p[(i + 2) % 3]) + s.edgeOffsets[i]));
        }
        s.slope = -laminaAlong(s.axis, normal) / facing;
        double w = s.axis == 0 ? corners[0].x : s.axis == 1 ? corners[0].y : corners[0].z;
        s.offset = w - dot(s.slope, p[0]);
        s.shadow = float(0.5lf * abs(facing));
        vec3 unit = vec3(normal / abs(facing));
        faceNormal = vec3(dot(laminaBatch.areaToWorld[0].xyz, unit), dot(laminaBatch.areaToWorld[1].xyz, unit),
                          dot(laminaBatch.areaToWorld[2].xyz, unit));
        s.areaScale = length(faceNormal);
        faceNormal /= s.areaScale;
    }
    bool hasNormals = laminaOverlap.normals.y != 0u;
    for (uint i = 0u; i < 3u; ++i) {
        uint vertex = laminaVertexIndex(triangle * 3u + i);
        s.colors[i] = laminaFetchColor(vertex);
        vec3 normal = hasNormals ? laminaFetchNormal(vertex) : vec3(0.0);
        s.normals[i] = normal == vec3(0.0) ? faceNormal : normal;
        if (i == 0u)
            s.material = laminaFetchMaterial(vertex);
    }
    vec4 tint = laminaMaterials[s.material].color;
    for (int i = 0; i < 3; ++i)
        s.colors[i] *= tint;
    return s;
}

// Area, and centroid in barycentric coordinates, of the triangle's part in a voxel enlarged by the allowance of its
// coverage: what is counted as touching has a share, and a face between two voxels counts in both.
float laminaPartInVoxel(LaminaSurface s, ivec3 voxel, out vec3 barycentric) {
    const float kReach = float(0.5 + LAMINA_OVERLAP_ALLOWANCE);
    barycentric = vec3(1.0 / 3.0);
    if (!s.hasArea)
        return 0.0;
    dvec3 center = dvec3(voxel) + 0.5lf;
    if (all(lessThanEqual(s.high - center, dvec3(kReach))) && all(lessThanEqual(center - s.low, dvec3(kReach))))
        return s.shadow * s.areaScale;
    dvec2 middle = laminaAlong(s.axis, center);
    double depth = s.axis == 0 ? center.x : s.axis == 1 ? center.y : center.z;
    // The origin: the voxel's centre or, if that is outside the triangle, its foot on the farthest edge.
    vec2 origin = vec2(0.0);
    float farthest = 0.0;
    for (int i = 0; i < 3; ++i) {
        float inside = float(dot(s.edgeNormals[i], middle) + s.edgeOffsets[i]);
        origin = inside < farthest ? vec2(s.edgeNormals[i]) * -inside : origin;
        farthest = min(farthest, inside);
    }
    middle += dvec2(origin);
    LaminaLine lines[9];
    for (int i = 0; i < 3; ++i)
        lines[i] = LaminaLine(vec2(s.edgeNormals[i]), float(dot(s.edgeNormals[i], middle) + s.edgeOffsets[i]));
    lines[3] = LaminaLine(vec2(1.0, 0.0), kReach + origin.x);
    lines[4] = LaminaLine(vec2(-1.0, 0.0), kReach - origin.x);
    lines[5] = LaminaLine(vec2(0.0, 1.0), kReach + origin.y);
    lines[6] = LaminaLine(vec2(0.0, -1.0), kReach - origin.y);
    // The slab between the voxel's faces along w, cut with the plane.
    vec2 slope = vec2(s.slope);
    float w = float(dot(s.slope, middle) + s.offset - depth);
    float size = length(slope);
    // A plane along the slab is in it all over or, but for rounding of the coverage, not at all.
    bool isFlat = size < 1.0e-6;
    vec2 normal = isFlat ? vec2(1.0, 0.0) : slope / size;
    lines[7] = LaminaLine(normal, isFlat ? 4.0 : (kReach + w) / size);
    lines[8] = LaminaLine(-normal, isFlat ? 4.0 : (kReach - w) / size);
    vec3 part = laminaPolygon(lines);
    vec2 place = part.xy;
    vec3 distances = vec3(dot(lines[1].normal, place) + lines[1].offset, dot(lines[2].normal, place) + lines[2].offset,
                          dot(lines[0].normal, place) + lines[0].offset);
    barycentric = max(distances * vec3(s.inverseHeights[1], s.inverseHeights[2], s.inverseHeights[0]), vec3(0.0));
    float sum = barycentric.x + barycentric.y + barycentric.z;
    barycentric = sum > 0.0 ? barycentric / sum : vec3(1.0 / 3.0);
    return part.z * s.areaScale;
}
