// Records one hit of a triangle in one voxel of a volume ([CLN11] 2-4).
//
// One invocation owns one (triangle, column, layer):
//   1. reject columns whose centre the triangle does not own;
//   2. reject layers whose slab, grown by the overlap, does not hold the triangle's depth there: exactly
//      one layer passes without overlap;
//   3. add the hit: to float targets by blending, to 32-bit counts by an atomic, since integers do not
//      blend. Rejected and helper invocations add nothing.
// permute LAMINA_VOLUME_PERSPECTIVE = 0 1
// permute LAMINA_VOLUME_SURFACE = 0 1
#include <voxelize/volume_slices.glsl>
#include <voxelize/column_triangle.glsl>

layout(binding = LAMINA_VOLUME_COUNT_IMAGE, r32ui) uniform restrict uimage3D laminaCounts;

layout(location = 0) flat in dvec2 laminaCorner0;
layout(location = 1) flat in dvec2 laminaCorner1;
layout(location = 2) flat in dvec2 laminaCorner2;
layout(location = 3) flat in dvec3 laminaValues;
layout(location = 5) flat in ivec2 laminaLayerAndMaterial;
#if LAMINA_VOLUME_SURFACE
layout(location = 6) flat in uvec3 laminaNormals;
layout(location = 7) flat in uvec3 laminaColorsRg;
layout(location = 8) flat in uvec3 laminaColorsBa;
#endif

layout(location = 0) out float laminaCount;
layout(location = 1) out float laminaAbsorption;
layout(location = 2) out vec4 laminaNormal;
layout(location = 3) out vec4 laminaColor;
layout(location = 4) out vec4 laminaOptics;

// Value of the edge from a to b, whose interior lies to the left; see laminaEdgeValue(). `owns`: may a
// point with this value belong to the triangle?
double edgeValue(dvec2 a, dvec2 b, dvec2 point, out bool owns) {
    bool isAscending = a.x < b.x || (a.x == b.x && a.y < b.y);
    dvec2 direction = b - a;
    double value = laminaEdgeValue(dvec4(isAscending ? a : b, direction), point);
    bool isLeftOrTop = direction.y < 0.0lf || (direction.y == 0.0lf && direction.x <= 0.0lf);
    owns = value > 0.0lf || (value == 0.0lf && isLeftOrTop);
    return value;
}

vec3 unpackDirection(uint bits) {
    vec2 square = unpackSnorm2x16(bits);
    vec3 direction = vec3(square, 1.0 - abs(square.x) - abs(square.y));
    if (direction.z < 0.0)
        direction.xy = (1.0 - abs(square.yx)) * vec2(square.x >= 0.0 ? 1.0 : -1.0, square.y >= 0.0 ? 1.0 : -1.0);
    return normalize(direction);
}

void main() {
    dvec2 center = dvec2(gl_FragCoord.xy);
    bvec3 owns;
    dvec3 areas; // of the parts opposite to the corners
    areas.z = edgeValue(laminaCorner0, laminaCorner1, center, owns.x);
    areas.x = edgeValue(laminaCorner1, laminaCorner2, center, owns.y);
    areas.y = edgeValue(laminaCorner2, laminaCorner0, center, owns.z);
    if (!all(owns))
        discard;
#if LAMINA_VOLUME_PERSPECTIVE
    double slice = laminaSliceCoordinateOf((areas.x + areas.y + areas.z) / dot(areas, laminaValues));
#else
    double slice = laminaSliceCoordinateOf(dot(areas, laminaValues) / (areas.x + areas.y + areas.z));
#endif
    int layer = laminaLayerAndMaterial.x;
    double overlap = double(laminaDraw.settings.y);
    // The far depth belongs to the last slice.
    bool isInSlab = slice >= double(layer) - overlap &&
                    (slice < double(layer + 1) + overlap || layer + 1 == int(laminaDraw.size.z));
    if (slice < 0.0lf || !isInSlab)
        discard;

    if (laminaAsks(LAMINA_VOLUME_COUNT_R32UI))
        imageAtomicAdd(laminaCounts, ivec3(ivec2(gl_FragCoord.xy), layer), 1u);
    LaminaMaterialConstants material = laminaMaterialOf(uint(laminaLayerAndMaterial.y));
    laminaCount = 1.0 / 255.0;
    laminaAbsorption = material.optics.x;
    laminaOptics = vec4(material.optics.yz, float(slice - (double(layer) + 0.5lf)), 1.0);
    laminaNormal = vec4(0.0);
    laminaColor = vec4(0.0);
#if LAMINA_VOLUME_SURFACE
#if LAMINA_VOLUME_PERSPECTIVE
    areas *= laminaValues; // now in proportion to areas in the world
#endif
    vec3 weights = vec3(areas / (areas.x + areas.y + areas.z));
    vec3 normal = vec3(0.0);
    vec4 color = vec4(0.0);
    for (int i = 0; i < 3; ++i) {
        normal += weights[i] * unpackDirection(laminaNormals[i]);
        color += weights[i] * vec4(unpackUnorm2x16(laminaColorsRg[i]), unpackUnorm2x16(laminaColorsBa[i]));
    }
    float size = length(normal);
    laminaNormal = vec4(size > 0.0 ? normal / size : normal, 1.0);
    laminaColor = vec4((color * material.color).rgb, 1.0);
#endif
}
