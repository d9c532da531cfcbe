// Triangle set-up of the slicemap backends.
//
// One invocation owns one triangle:
//   1. drop it if it is not finite or lies outside the depths of this pass;
//   2. project it to columns and work out its exact edges and depth plane (LaminaColumnTriangle);
//   3. emit a polygon that covers the centres of its columns, widened by `dilation.x` pixels, so that
//      the rasterizer's sub-pixel snapping loses none; the fragment stage decides coverage exactly. Of a
//      triangle that reaches far beyond the grid, the part of its box in it.
//      Every column inside the polygon gets exactly one fragment: Solid counts them.
// Conservative: the columns whose squares the triangle touches, degenerate projections (edge-on
// triangles) included. Else the columns whose centres it owns; edge-on triangles own none and are dropped.
// LAMINA_SPLIT 1: the grid that takes the triangle goes along.
// permute LAMINA_SPLIT = 0 1
// permute LAMINA_COVERAGE = LAMINA_COVERAGE_SAMPLED LAMINA_COVERAGE_FILLED LAMINA_COVERAGE_CONSERVATIVE LAMINA_COVERAGE_SOLID
#include <voxelize/draw_block.glsl>

#define LAMINA_STAGE out
#include <voxelize/column_stage.glsl>
#include <voxelize/slicemap_split.glsl>
#include <voxelize/large_triangle.glsl>

layout(triangles) in;
#if LAMINA_COVERAGE == LAMINA_COVERAGE_CONSERVATIVE
layout(triangle_strip, max_vertices = 7) out;
#else
layout(triangle_strip, max_vertices = 4) out;
#endif

in LaminaVertexStage {
    dvec3 column;
#if LAMINA_SPLIT
    uint material;
#endif
} laminaIn[];

LaminaColumnTriangle triangle = kLaminaNoTriangle;
#if LAMINA_SPLIT
uint triangleGrid = 0u;
#endif

void emit(dvec2 column) {
    laminaEdge0 = triangle.edges[0];
    laminaEdge1 = triangle.edges[1];
    laminaEdge2 = triangle.edges[2];
    laminaDepthPlane = triangle.depthPlane;
    laminaDepthRange = triangle.depthRange;
#if LAMINA_COVERAGE == LAMINA_COVERAGE_FILLED || LAMINA_COVERAGE == LAMINA_COVERAGE_CONSERVATIVE
    laminaEdgeValues0 = triangle.edgeValues[0];
    laminaEdgeValues1 = triangle.edgeValues[1];
    laminaEdgeValues2 = triangle.edgeValues[2];
    laminaIsEdgeOn = triangle.isEdgeOn ? 1 : 0;
#endif
#if LAMINA_SPLIT
    laminaTriangleGrid = triangleGrid;
#endif
    gl_Position = vec4(vec2(column * (2.0lf / dvec2(laminaDraw.size.xy)) - 1.0lf), 0.0, 1.0);
    EmitVertex();
}

// Does the edge leave all of the grid, and a column around it, outside?
bool gridIsBeyond(dvec4 edge) {
    dvec2 size = dvec2(laminaDraw.size.xy) + 1.0lf;
    // Of all points there, this one has the greatest value.
    dvec2 corner = dvec2(edge.w > 0.0lf ? -1.0lf : size.x, edge.z > 0.0lf ? size.y : -1.0lf);
    return laminaEdgeValue(edge, corner) < 0.0lf;
}

void emitRectangle(dvec2 low, dvec2 high) {
    emit(low);
    emit(dvec2(high.x, low.y));
    emit(dvec2(low.x, high.y));
    emit(high);
    EndPrimitive();
}

// The rectangle, without its part outside the grid.
void emitClampedRectangle(dvec2 low, dvec2 high) {
    dvec2 size = dvec2(laminaDraw.size.xy);
    low = clamp(low, dvec2(0.0lf), size);
    high = clamp(high, dvec2(0.0lf), size);
    if (low.x < high.x && low.y < high.y)
        emitRectangle(low, high);
}

// How far from the triangle the centres of its columns may lie: by coverage, and by what rasterization may
// lose. farthest: largest coordinate; far outside the grid more is lost to the rounding of normalized device
// coordinates.
double dilationRadius(double farthest) {
    double rounding = double(laminaDraw.dilation.x) + farthest * 4.8e-7lf;
#if LAMINA_COVERAGE == LAMINA_COVERAGE_CONSERVATIVE
    return 0.5lf + rounding;
#else
    return rounding;
#endif
}

int longestEdge(dvec2 p[3]) {
    dvec3 squares = dvec3(dot(p[1] - p[0], p[1] - p[0]), dot(p[2] - p[1], p[2] - p[1]), dot(p[0] - p[2], p[0] - p[2]));
    return squares.x >= max(squares.y, squares.z) ? 0 : (squares.y >= squares.z ? 1 : 2);
}

#if LAMINA_COVERAGE == LAMINA_COVERAGE_CONSERVATIVE
// Triangles whose boxes hold fewer columns get their boxes: idle fragments cost less than the hull's corners.
const double kSmallBox = 1024.0lf;

// Narrower triangles get the hull of their longest edge.
const double kNarrow = 1.0e-3lf;

// The quadrant, counted from (+,+) against the clock, of the outward normal of an edge of a polygon that
// is passed against the clock.
int normalQuadrant(dvec2 along) {
    dvec2 normal = dvec2(along.y, -along.x);
    if (normal.y < 0.0lf)
        return normal.x < 0.0lf ? 2 : 3;
    return normal.x > 0.0lf ? 0 : (normal.y > 0.0lf ? 1 : 2);
}

// The hull of the squares of 2 `radius` about the corners of a triangle: at each corner, the square's
// corners between the quadrants of the normals of the edges before and after it; four in all, for the
// normals turn once around. Against the clock; returns how many.
int hullOf(dvec2 p[3], double radius, out dvec2 hull[7]) {
    dvec2 u = p[1] - p[0];
    dvec2 v = p[2] - p[0];
    double orientation = u.x * v.y - u.y * v.x;
    int first = longestEdge(p);
    dvec2 base = p[(first + 1) % 3] - p[first];
    dvec2 corners[3] = dvec2[](p[first], p[(first + 1) % 3], p[(first + 2) % 3]);
    int cornerCount = 3;
    if (abs(orientation) <= kNarrow * length(base)) {
        cornerCount = 2;
        radius += kNarrow;
    } else if (orientation < 0.0lf) {
        corners = dvec2[](corners[1], corners[0], corners[2]);
    }
    int count = 0;
    for (int i = 0; i < cornerCount; ++i) {
        dvec2 before = corners[i] - corners[(i + cornerCount - 1) % cornerCount];
        dvec2 after = corners[(i + 1) % cornerCount] - corners[i];
        int quadrant = normalQuadrant(before);
        int turns = (normalQuadrant(after) - quadrant) & 3;
        for (int turn = 0; turn <= turns && count < 7; ++turn, ++quadrant) {
            int corner = quadrant & 3;
            hull[count++] = corners[i] + radius * dvec2(corner == 0 || corner == 3 ? 1.0lf : -1.0lf, corner <= 1 ? 1.0lf : -1.0lf);
        }
    }
    return count;
}

// Emitted at one place: software GL runs both branches of everything.
void emitCover(dvec2 p[3], dvec2 low, dvec2 high, bool isLarge) {
    dvec2 farthest = max(abs(low), abs(high));
    double radius = dilationRadius(max(farthest.x, farthest.y));
    dvec2 size = high - low + 1.0lf;
    dvec2 hull[7];
    int count;
    if (isLarge || size.x * size.y <= kSmallBox || min(size.x, size.y) <= 1.0lf + kNarrow) {
        low = clamp(low - radius, dvec2(0.0lf), dvec2(laminaDraw.size.xy));
        high = clamp(high + radius, dvec2(0.0lf), dvec2(laminaDraw.size.xy));
        hull[0] = low;
        hull[1] = dvec2(high.x, low.y);
        hull[2] = high;
        hull[3] = dvec2(low.x, high.y);
        count = low.x < high.x && low.y < high.y ? 4 : 0;
    } else {
        count = hullOf(p, radius, hull);
    }
    for (int i = 0; i < count; ++i)
        emit(hull[(i & 1) == 0 ? i >> 1 : count - 1 - (i >> 1)]);
    EndPrimitive();
}
#else
vec2 unitNormal(dvec4 edge) {
    vec2 direction = vec2(edge.zw);
    return vec2(direction.y, -direction.x) / length(direction);
}

// A triangle in front of the eye: its three edges moved outwards, or, where that would make a spike,
// the rectangle around its longest edge; of a large one, its box in the grid. Emitted at one place: software
// GL runs both branches of everything.
void emitCover(dvec2 p[3], dvec2 lowest, dvec2 highest, bool isLarge) {
    dvec2 farthest = max(abs(lowest), abs(highest));
    float radius = float(dilationRadius(max(farthest.x, farthest.y)));
    vec2 normals[3] = vec2[](unitNormal(triangle.edges[0]), unitNormal(triangle.edges[1]), unitNormal(triangle.edges[2]));
    vec3 miter = 1.0 + vec3(dot(normals[2], normals[0]), dot(normals[0], normals[1]), dot(normals[1], normals[2]));
    bool isTriangle = !isLarge && min(miter.x, min(miter.y, miter.z)) > 1.0e-4;
    dvec2 corners[4];
    if (isTriangle) {
        corners[0] = p[0] + dvec2((normals[2] + normals[0]) * (radius / miter.x));
        corners[1] = p[1] + dvec2((normals[0] + normals[1]) * (radius / miter.y));
        corners[2] = p[2] + dvec2((normals[1] + normals[2]) * (radius / miter.z));
    } else if (isLarge) {
        dvec2 size = dvec2(laminaDraw.size.xy);
        dvec2 low = clamp(lowest - dvec2(radius), dvec2(0.0lf), size);
        dvec2 high = clamp(highest + dvec2(radius), dvec2(0.0lf), size);
        corners = dvec2[](low, dvec2(high.x, low.y), dvec2(low.x, high.y), high);
    } else {
        int first = longestEdge(p);
        dvec2 a = p[first];
        dvec2 b = p[(first + 1) % 3];
        dvec2 c = p[(first + 2) % 3];
        vec2 along = normalize(vec2(b - a));
        vec2 across = vec2(-along.y, along.x);
        float height = dot(vec2(c - a), across);
        dvec2 low = dvec2(across * (min(height, 0.0) - 2.0 * radius));
        dvec2 high = dvec2(across * (max(height, 0.0) + 2.0 * radius));
        dvec2 extension = dvec2(along * (2.0 * radius));
        corners = dvec2[](a - extension + low, b + extension + low, a - extension + high, b + extension + high);
    }
    emit(corners[0]);
    emit(corners[1]);
    emit(corners[2]);
    if (!isTriangle)
        emit(corners[3]);
    EndPrimitive();
}
#endif

// The anchor of edges behind the eye, which constrain nothing: in no column, but near enough for the depth
// plane to be anchored there.
const double kNowhere = -2.0lf;

// Relative to their distances from the eye; flatter triangles are edge-on.
const double kEyeFlatness = 1.0e-14lf;

// A perspective triangle that reaches behind the eye cut: the rectangle around its visible part.
// h: (column x * depth, column y * depth, depth) of the vertices.
void emitCut(dvec3 h[3], double cutDepth) {
    double orientation = dot(h[0], cross(h[1], h[2]));
    triangle.isEdgeOn = abs(orientation) <= kEyeFlatness * length(h[0]) * length(h[1]) * length(h[2]);
    if (orientation == 0.0lf && LAMINA_COVERAGE != LAMINA_COVERAGE_CONSERVATIVE)
        return;
    dvec2 low = dvec2(laminaDraw.size.xy);
    dvec2 high = dvec2(0.0lf);
    for (int i = 0; i < 3; ++i) {
        dvec3 a = h[i];
        dvec3 b = h[(i + 1) % 3];
        if (a.z < cutDepth && b.z < cutDepth) {
            triangle.edges[i] = dvec4(kNowhere, kNowhere, 0.0lf, 0.0lf);
            continue;
        }
        // From the end in front to the end behind, for both triangles of the edge.
        if (a.z < cutDepth) {
            double t = (cutDepth - b.z) / (a.z - b.z);
            a = dvec3(b.xy + (a.xy - b.xy) * t, cutDepth);
        } else if (b.z < cutDepth) {
            double t = (cutDepth - a.z) / (b.z - a.z);
            b = dvec3(a.xy + (b.xy - a.xy) * t, cutDepth);
        }
        dvec2 pa = a.xy / a.z;
        dvec2 pb = b.xy / b.z;
        laminaSetEdge(i, pa, pb, 1.0lf / dvec2(a.z, b.z), orientation, triangle);
        low = min(low, min(pa, pb));
        high = max(high, max(pa, pb));
    }
    // 1/depth = dot(normal, (column x, column y, 1)).
    dvec3 normal = (cross(h[0], h[1]) + cross(h[1], h[2]) + cross(h[2], h[0])) / orientation;
    triangle.depthPlane = dvec3(normal.xy, dot(normal, dvec3(triangle.edges[0].xy, 1.0lf)));
    double margin = dilationRadius(0.0lf);
    emitClampedRectangle(low - margin, high + margin);
}

void main() {
    dvec3 h[3] = dvec3[](laminaIn[0].column, laminaIn[1].column, laminaIn[2].column);
    for (int i = 0; i < 3; ++i)
        if (any(isnan(h[i])) || any(isinf(h[i])))
            return;
    triangle.depthRange = dvec2(min(h[0].z, min(h[1].z, h[2].z)), max(h[0].z, max(h[1].z, h[2].z)));
    if (triangle.depthRange.x > laminaDraw.passDepths.y || triangle.depthRange.y < laminaDraw.passDepths.x)
        return;
#if LAMINA_SPLIT
    triangleGrid = laminaGridOf(h, laminaIn[2].material);
    if (triangleGrid >= laminaDraw.pass.z)
        return;
#endif

    bool isPerspective = (laminaDraw.size.w & LAMINA_GRID_PERSPECTIVE) != 0u;
    double cutDepth = laminaDraw.depthRange.z;
    if (isPerspective && triangle.depthRange.x < cutDepth) {
        emitCut(h, cutDepth);
        return;
    }

    dvec2 p[3];
    dvec3 values;
    for (int i = 0; i < 3; ++i) {
        double w = isPerspective ? h[i].z : 1.0lf;
        p[i] = h[i].xy / w;
        values[i] = isPerspective ? 1.0lf / h[i].z : h[i].z;
    }
    dvec2 low = min(p[0], min(p[1], p[2]));
    dvec2 high = max(p[0], max(p[1], p[2]));
    double margin = double(kLaminaFootprintAllowance);
    if (any(greaterThan(low, dvec2(laminaDraw.size.xy) + margin)) || any(lessThan(high, dvec2(-margin))))
        return;
    bool ownsPoints = laminaSetUpTriangle(p, values, triangle);
    if (!ownsPoints && LAMINA_COVERAGE != LAMINA_COVERAGE_CONSERVATIVE)
        return;
    bool isLarge = laminaIsLarge(low, high, dvec2(laminaDraw.size.xy));
    if (isLarge && (gridIsBeyond(triangle.edges[0]) || gridIsBeyond(triangle.edges[1]) || gridIsBeyond(triangle.edges[2])))
        return;
    emitCover(p, low, high, isLarge);
}
