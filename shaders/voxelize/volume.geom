// Slices triangles into the layers of a volume ([CLN11] 2, Figure 1).
//
// One invocation owns one triangle and at most LAMINA_VOLUME_LAYERS_PER_INVOCATION of the layers that its
// depth range touches. What lies beyond is drawn by later passes with
// LAMINA_VOLUME_INVOCATIONS_OF_LATER_PASSES invocations a triangle, so that no layer is lost however many
// a triangle spans. The first pass over a mesh lists the triangles that need them (an atomic gives each
// its place in the list):
//   1. drop it if it is not finite, outside the depths, or turned the way its material leaves out;
//   2. in a perspective grid, cut off what lies at or behind the eye: one or two triangles are left;
//   3. for each layer emit a polygon that covers the part of the triangle in the layer's slab after
//      dilation, so that the rasterizer's sub-pixel snapping loses no column centre. The fragment
//      stage decides exactly. Of a triangle that reaches far beyond the grid, a rectangle around its box in
//      grid and slab.
// Degenerate projections (edge-on triangles) cover no column centre and are dropped.
// No array is indexed by a variable, and vertices are emitted at one place: software GL runs both
// branches of everything and indexes lane by lane.
// permute LAMINA_VOLUME_PASS = LAMINA_VOLUME_PASS_FIRST LAMINA_VOLUME_PASS_FIRST_LISTING LAMINA_VOLUME_PASS_LATER
// permute LAMINA_VOLUME_PERSPECTIVE = 0 1
// permute LAMINA_VOLUME_SURFACE = 0 1
#include <voxelize/volume_slices.glsl>
#include <voxelize/large_triangle.glsl>

#if LAMINA_VOLUME_PASS == LAMINA_VOLUME_PASS_LATER
layout(triangles, invocations = LAMINA_VOLUME_INVOCATIONS_OF_LATER_PASSES) in;
#else
layout(triangles) in;
#endif
layout(triangle_strip, max_vertices = 28) out; // 4 * LAMINA_VOLUME_LAYERS_PER_INVOCATION

in LaminaVolumeVertex {
    dvec3 column;
    vec3 local;
    vec3 normal;
    vec4 color;
    uint material;
    uint vertex;
} laminaIn[];

layout(location = 0) flat out dvec2 laminaCorner0;
layout(location = 1) flat out dvec2 laminaCorner1;
layout(location = 2) flat out dvec2 laminaCorner2;
layout(location = 3) flat out dvec3 laminaValues;
layout(location = 5) flat out ivec2 laminaLayerAndMaterial;
#if LAMINA_VOLUME_SURFACE
layout(location = 6) flat out uvec3 laminaNormals;
layout(location = 7) flat out uvec3 laminaColorsRg;
layout(location = 8) flat out uvec3 laminaColorsBa;
#endif

#if LAMINA_VOLUME_PASS == LAMINA_VOLUME_PASS_FIRST_LISTING
layout(std430, binding = LAMINA_VOLUME_TALL_BLOCK_BINDING) restrict buffer LaminaTallBlock {
    LaminaTallTriangles arguments;
    uint vertices[];
} laminaTall;
#endif

struct Corner {
    dvec3 column;
    vec3 normal;
    vec4 color;
};

// A triangle in front of the eye, counter-clockwise in column space.
struct Projected {
    dvec2 a, b, c;     // columns
    dvec3 values;      // depth (orthographic) or 1/depth (perspective): affine in columns
    uvec3 normals;     // packed
    uvec3 colorsRg;
    uvec3 colorsBa;
    vec2 gradient;     // of the values per column
    float radius;      // of dilation, columns
    int firstLayer;
    int lastLayer;     // below firstLayer: nothing to draw
    bool isSmall;      // not worth cutting
    bool isLarge;      // reaches far beyond the grid
};

// Area in columns below which a triangle is not cut to a slab: set-up costs more than what it saves.
const float kSmallArea = 32.0;

// Octahedral map of a direction to the square, 16 bits a coordinate.
uint packDirection(vec3 direction) {
    vec3 d = direction / max(abs(direction.x) + abs(direction.y) + abs(direction.z), 1.0e-30);
    vec2 signs = vec2(d.x >= 0.0 ? 1.0 : -1.0, d.y >= 0.0 ? 1.0 : -1.0);
    return packSnorm2x16(d.z < 0.0 ? (1.0 - abs(d.yx)) * signs : d.xy);
}

void emit(Projected triangle, dvec2 column, int layer, uint material) {
    laminaCorner0 = triangle.a;
    laminaCorner1 = triangle.b;
    laminaCorner2 = triangle.c;
    laminaValues = triangle.values;
    laminaLayerAndMaterial = ivec2(layer, int(material));
#if LAMINA_VOLUME_SURFACE
    laminaNormals = triangle.normals;
    laminaColorsRg = triangle.colorsRg;
    laminaColorsBa = triangle.colorsBa;
#endif
    gl_Layer = layer;
    gl_Position = vec4(vec2(column * (2.0lf / dvec2(laminaDraw.size.xy)) - 1.0lf), 0.0, 1.0);
    EmitVertex();
}

// Low and high corner, along `along` and at right angles to it, around five points.
vec4 boundsAlong(vec2 along, vec2 points[5], float radius) {
    mat2 frame = mat2(along.x, -along.y, along.y, along.x);
    vec2 low = frame * points[0];
    vec2 high = low;
    for (int i = 1; i < 5; ++i) {
        vec2 place = frame * points[i];
        low = min(low, place);
        high = max(high, place);
    }
    return vec4(low - radius, high + radius);
}

float areaOf(vec4 bounds) {
    return (bounds.z - bounds.x) * (bounds.w - bounds.y);
}

void swapIf(bool condition, inout vec3 a, inout vec3 b) {
    vec3 kept = a;
    a = condition ? b : a;
    b = condition ? kept : b;
}

// Corners of the part of the triangle with values in [low, high] (relative to that of its corner a):
// two on the side from the least to the greatest value, two on the other sides, and the middle corner.
// Corners are given as offset from a and value.
void cutBetween(float low, float high, vec3 least, vec3 middle, vec3 greatest, out vec2 points[5]) {
    swapIf(least.z > middle.z, least, middle);
    swapIf(middle.z > greatest.z, middle, greatest);
    swapIf(least.z > middle.z, least, middle);
    float ends[2] = float[2](clamp(low, least.z, greatest.z), clamp(high, least.z, greatest.z));
    for (int i = 0; i < 2; ++i) {
        float first = middle.z > least.z ? (ends[i] - least.z) / (middle.z - least.z) : float(i);
        float second = greatest.z > middle.z ? (ends[i] - middle.z) / (greatest.z - middle.z) : 1.0;
        float whole = greatest.z > least.z ? (ends[i] - least.z) / (greatest.z - least.z) : float(i);
        points[i] = mix(least.xy, greatest.xy, whole);
        points[2 + i] = ends[i] <= middle.z ? mix(least.xy, middle.xy, first) : mix(middle.xy, greatest.xy, second);
    }
    points[4] = middle.z >= ends[0] && middle.z <= ends[1] ? middle.xy : points[2];
}

// Least and greatest value of a layer's slab, grown by the overlap.
dvec2 slabOf(int layer) {
    double overlap = double(laminaDraw.settings.y);
    double front = laminaDepthAtSlice(max(double(layer) - overlap, 0.0lf));
    double back = laminaDepthAtSlice(min(double(layer) + 1.0lf + overlap, double(laminaDraw.size.z)));
#if LAMINA_VOLUME_PERSPECTIVE
    return 1.0lf / dvec2(back, front);
#else
    return dvec2(front, back);
#endif
}

// Low and high corner of the triangle's box in the grid, narrowed to where its values are those of the slab;
// without area if that is nowhere.
dvec4 boxInSlab(Projected triangle, int layer) {
    const double kMargin = 1.0lf; // columns, for rounding
    dvec2 size = dvec2(laminaDraw.size.xy);
    dvec2 low = clamp(min(triangle.a, min(triangle.b, triangle.c)) - kMargin, dvec2(0.0lf), size);
    dvec2 high = clamp(max(triangle.a, max(triangle.b, triangle.c)) + kMargin, dvec2(0.0lf), size);
    dvec2 u = triangle.b - triangle.a;
    dvec2 v = triangle.c - triangle.a;
    dvec2 rises = triangle.values.yz - triangle.values.x;
    double area = u.x * v.y - u.y * v.x;
    dvec2 gradient = dvec2(rises.x * v.y - rises.y * u.y, rises.y * u.x - rises.x * v.x) * (1.0lf / area);
    dvec2 inverse = 1.0lf / gradient;
    dvec2 middle = 0.5lf * (low + high);
    dvec2 ends = slabOf(layer);
    ends += 1.0e-9lf * (abs(ends.x) + abs(ends.y)) * dvec2(-1.0lf, 1.0lf);
    ends -= triangle.values.x + dot(gradient, middle - triangle.a);
    // Along the other axis the values vary by as much.
    dvec2 spread = abs(gradient.yx) * 0.5lf * (high - low).yx;
    dvec2 first = (ends.x - spread) * inverse;
    dvec2 last = (ends.y + spread) * inverse;
    bvec2 isLevel = equal(gradient, dvec2(0.0lf));
    low = mix(max(low, middle + min(first, last) - kMargin), low, isLevel);
    high = mix(min(high, middle + max(first, last) + kMargin), high, isLevel);
    return dvec4(low, max(low, high));
}

// The polygon of one layer: the whole triangle, its edges moved outwards, where it is small or lies in
// one layer, else the smaller of two rectangles around the part in the slab. The same, around the whole,
// where moved edges would make a spike.
void emitLayer(Projected triangle, int layer, uint material) {
    vec2 toB = vec2(triangle.b - triangle.a);
    vec2 toC = vec2(triangle.c - triangle.a);
    vec3 lengths = vec3(length(toB), length(toC - toB), length(toC));
    // Outward normals of ab, bc and ca.
    vec2 normalAb = vec2(toB.y, -toB.x) / lengths.x;
    vec2 normalBc = vec2(toC.y - toB.y, toB.x - toC.x) / lengths.y;
    vec2 normalCa = vec2(-toC.y, toC.x) / lengths.z;
    vec3 miter = 1.0 + vec3(dot(normalCa, normalAb), dot(normalAb, normalBc), dot(normalBc, normalCa));
    // A corner moves by at most sqrt(2 / miter) radii.
    bool isSpiky = !(min(miter.x, min(miter.y, miter.z)) > 1.0e-3);
    bool isWhole = triangle.isSmall || triangle.firstLayer == triangle.lastLayer;

    float radius = triangle.radius;
    vec2 corners[4];
    bool isTriangle = isWhole && !isSpiky && !triangle.isLarge;
    if (isTriangle) {
        corners[0] = (normalCa + normalAb) * (radius / miter.x);
        corners[1] = toB + (normalAb + normalBc) * (radius / miter.y);
        corners[2] = toC + (normalBc + normalCa) * (radius / miter.z);
    } else {
        float low = -3.4e38;
        float high = 3.4e38;
        float slope = length(triangle.gradient);
        if (!isWhole) {
            dvec2 ends = slabOf(layer);
            // Dilation, and the rounding of depths and of slices near their boundaries.
            float allowance = float(1.0e-9lf * (abs(ends.x) + abs(ends.y))) + slope * radius;
            ends -= triangle.values.x;
            low = float(ends.x) - allowance - 1.0e-6 * abs(float(ends.x));
            high = float(ends.y) + allowance + 1.0e-6 * abs(float(ends.y));
        }
        vec2 points[5];
        cutBetween(low, high, vec3(0.0), vec3(toB, float(triangle.values.y - triangle.values.x)),
                   vec3(toC, float(triangle.values.z - triangle.values.x)), points);
        vec2 along = lengths.x >= max(lengths.y, lengths.z) ? toB / lengths.x
                     : lengths.y >= lengths.z               ? (toC - toB) / lengths.y
                                                            : toC / lengths.z;
        vec4 bounds = boundsAlong(along, points, radius);
        vec2 uphill = slope > 0.0 && !isinf(slope) ? triangle.gradient / slope : along;
        vec4 uphillBounds = boundsAlong(uphill, points, radius);
        if (areaOf(uphillBounds) < areaOf(bounds)) {
            along = uphill;
            bounds = uphillBounds;
        }
        vec2 across = vec2(-along.y, along.x);
        corners[0] = along * bounds.x + across * bounds.y;
        corners[1] = along * bounds.z + across * bounds.y;
        corners[2] = along * bounds.x + across * bounds.w;
        corners[3] = along * bounds.z + across * bounds.w;
    }
    dvec2 place[4];
    for (int i = 0; i < 4; ++i)
        place[i] = triangle.a + dvec2(corners[i]);
    if (triangle.isLarge) {
        dvec4 box = boxInSlab(triangle, layer);
        place = dvec2[4](box.xy, box.zy, box.xw, box.zw);
    }
    emit(triangle, place[0], layer, material);
    emit(triangle, place[1], layer, material);
    emit(triangle, place[2], layer, material);
    if (!isTriangle)
        emit(triangle, place[3], layer, material);
    EndPrimitive();
}

// The layers that it reaches are what says whether there is something to draw.
Projected project(Corner a, Corner b, Corner c) {
    Projected triangle;
    double nearest = min(a.column.z, min(b.column.z, c.column.z));
    double farthest = max(a.column.z, max(b.column.z, c.column.z));
#if LAMINA_VOLUME_PERSPECTIVE
    triangle.values = 1.0lf / dvec3(a.column.z, b.column.z, c.column.z);
    triangle.a = a.column.xy / a.column.z;
    triangle.b = b.column.xy / b.column.z;
    triangle.c = c.column.xy / c.column.z;
#else
    triangle.values = dvec3(a.column.z, b.column.z, c.column.z);
    triangle.a = a.column.xy;
    triangle.b = b.column.xy;
    triangle.c = c.column.xy;
#endif
#if LAMINA_VOLUME_SURFACE
    triangle.normals = uvec3(packDirection(a.normal), packDirection(b.normal), packDirection(c.normal));
    triangle.colorsRg = uvec3(packUnorm2x16(a.color.rg), packUnorm2x16(b.color.rg), packUnorm2x16(c.color.rg));
    triangle.colorsBa = uvec3(packUnorm2x16(a.color.ba), packUnorm2x16(b.color.ba), packUnorm2x16(c.color.ba));
#endif
    dvec2 low = min(triangle.a, min(triangle.b, triangle.c));
    dvec2 high = max(triangle.a, max(triangle.b, triangle.c));
    dvec2 u = triangle.b - triangle.a;
    dvec2 v = triangle.c - triangle.a;
    precise double area = u.x * v.y - u.y * v.x;
    vec2 rises = vec2(dvec2(triangle.values.y, triangle.values.z) - triangle.values.x);
    triangle.gradient = vec2(rises.x * float(v.y) - rises.y * float(u.y), rises.y * float(u.x) - rises.x * float(v.x)) / float(area);
    if (area < 0.0lf) {
        dvec2 kept = triangle.b;
        triangle.b = triangle.c;
        triangle.c = kept;
        triangle.values = triangle.values.xzy;
        triangle.normals = triangle.normals.xzy;
        triangle.colorsRg = triangle.colorsRg.xzy;
        triangle.colorsBa = triangle.colorsBa.xzy;
    }
    // Far corners carry more rounding.
    dvec2 extent = max(abs(low), abs(high));
    triangle.radius = laminaDraw.settings.x + float(max(extent.x, extent.y)) * 4.8e-7;
    triangle.isSmall = abs(float(area)) < 2.0 * kSmallArea;
    triangle.isLarge = laminaIsLarge(low, high, dvec2(laminaDraw.size.xy));

    double rounding = (laminaDraw.depthRange.w - laminaDraw.depthRange.x) * 1.0e-11lf;
    bool isOutside = farthest < laminaDraw.depthRange.x - rounding || nearest > laminaDraw.depthRange.w + rounding ||
                     any(greaterThan(low, dvec2(laminaDraw.size.xy))) || any(lessThan(high, dvec2(0.0lf)));
    double overlap = double(laminaDraw.settings.y);
    double first = laminaSliceCoordinateOf(max(nearest - rounding, laminaDraw.depthRange.x));
    double last = laminaSliceCoordinateOf(min(farthest + rounding, laminaDraw.depthRange.w));
    int slices = int(laminaDraw.size.z);
    triangle.firstLayer = min(int(max(first - overlap, 0.0lf)), slices - 1);
    triangle.lastLayer = min(int(last + overlap), slices - 1);
    if (isOutside || area == 0.0lf)
        triangle.lastLayer = triangle.firstLayer - 1;
    return triangle;
}

// Always from the end behind, so that both triangles of an edge get the same point.
Corner cutPoint(Corner behind, Corner kept, double cutDepth) {
    double t = (cutDepth - behind.column.z) / (kept.column.z - behind.column.z);
    return Corner(behind.column + (kept.column - behind.column) * t, mix(behind.normal, kept.normal, float(t)),
                  mix(behind.color, kept.color, float(t)));
}

bool isFinite(dvec3 value) {
    return !any(isnan(value)) && !any(isinf(value));
}

Corner cornerOf(int i, vec3 faceNormal) {
    vec3 normal = laminaIn[i].normal;
    float size = length(normal);
    return Corner(laminaIn[i].column, size > 0.0 && !isinf(size) ? normal / size : faceNormal, laminaIn[i].color);
}

// Does the material take triangles that face this way?
bool isTaken(float facing, dvec3 a, dvec3 b, dvec3 c) {
#if LAMINA_VOLUME_PERSPECTIVE
    double turn = dot(a, cross(b, c));
#else
    double turn = cross(b - a, c - a).z;
#endif
    bool isFront = (turn > 0.0lf) != (laminaDraw.pass.z != 0u);
    return facing == LAMINA_FACING_ANY || isFront == (facing == LAMINA_FACING_FRONT);
}

void main() {
    uint material = laminaIn[0].material;
    // From differences in local space, which are exact for small triangles far from the origin.
    vec3 localNormal = cross(laminaIn[1].local - laminaIn[0].local, laminaIn[2].local - laminaIn[0].local);
    vec3 faceNormal = normalize(laminaNormalToWorld(normalize(localNormal))) * laminaDraw.normalToWorld[0].w;
    Corner a = cornerOf(0, faceNormal);
    Corner b = cornerOf(1, faceNormal);
    Corner c = cornerOf(2, faceNormal);
    if (!isFinite(a.column) || !isFinite(b.column) || !isFinite(c.column) ||
        !isTaken(laminaMaterialOf(material).optics.w, a.column, b.column, c.column))
        return;

    int skipped = int(laminaDraw.pass.x) + gl_InvocationID * LAMINA_VOLUME_LAYERS_PER_INVOCATION;
    int budget = LAMINA_VOLUME_LAYERS_PER_INVOCATION;
    int remaining = 0;
#if LAMINA_VOLUME_PERSPECTIVE
    double cutDepth = laminaDraw.depthRange.z;
    int behind = int(a.column.z < cutDepth) + int(b.column.z < cutDepth) + int(c.column.z < cutDepth);
    if (behind == 3)
        return;
    Corner second = c; // of the other half of what a cut leaves
    Corner third = a;
    if (behind > 0) {
        // Turned until a is the corner that is alone on its side.
        bool isAlone = behind == 1;
        bool bIsAlone = (b.column.z < cutDepth) == isAlone;
        bool cIsAlone = !bIsAlone && (c.column.z < cutDepth) == isAlone;
        Corner p = bIsAlone ? b : cIsAlone ? c : a;
        Corner q = bIsAlone ? c : cIsAlone ? a : b;
        Corner r = bIsAlone ? a : cIsAlone ? b : c;
        a = behind == 1 ? cutPoint(p, q, cutDepth) : p;
        b = behind == 1 ? q : cutPoint(q, p, cutDepth);
        c = behind == 1 ? r : cutPoint(r, p, cutDepth);
        second = r;
        third = cutPoint(p, r, cutDepth);
    }
    for (int part = 0; part < (behind == 1 ? 2 : 1); ++part) {
        if (part == 1) {
            b = second;
            c = third;
        }
#else
    {
#endif
        Projected triangle = project(a, b, c);
        int layers = triangle.lastLayer - triangle.firstLayer + 1;
        int begin = min(skipped, layers);
        int end = min(layers, begin + budget);
        for (int layer = begin; layer < end; ++layer)
            emitLayer(triangle, triangle.firstLayer + layer, material);
        skipped -= begin;
        budget -= end - begin;
        remaining += layers - end;
    }
#if LAMINA_VOLUME_PASS == LAMINA_VOLUME_PASS_FIRST_LISTING
    if (remaining > 0) {
        uint place = atomicAdd(laminaTall.arguments.count, 3u);
        for (int i = 0; i < 3; ++i)
            laminaTall.vertices[place + uint(i)] = laminaIn[i].vertex;
    }
#endif
}
