// Sets the bits of one column for one triangle; logic op OR gathers them ([ED06] 2.2).
//
// One invocation owns one (triangle, column) pair of one pass of 128 slices:
//   1. reject columns whose centre the triangle does not own;
//   2. Sampled: the slice of the triangle's depth at the centre;
//      Filled: the slices between the least and the greatest depth of the part of the triangle in
//      the column's square, found as the extremes of an affine function over a convex polygon;
//   3. write their bits of this pass.
// permute LAMINA_COVERAGE = LAMINA_COVERAGE_SAMPLED LAMINA_COVERAGE_FILLED
#include <voxelize/draw_block.glsl>
#include <voxelize/column_triangle.glsl>

layout(std140, binding = LAMINA_PASS_GRID_BLOCK_BINDING) uniform LaminaPassGridBlock {
    LaminaGridConstants constants;
    vec4 boundaries[LAMINA_MAX_SLICE_BOUNDARIES / 4];
} laminaPassGrid;

#include <lamina/slice_distribution.glsl>

layout(location = 0) flat in dvec4 laminaEdge0;
layout(location = 2) flat in dvec4 laminaEdge1;
layout(location = 4) flat in dvec4 laminaEdge2;
layout(location = 6) flat in dvec3 laminaDepthPlane;
layout(location = 8) flat in dvec2 laminaDepthRange;

layout(location = 0) out uvec4 laminaBits;

// Bits [first, last] of the pass's 128; first and last may lie outside.
uvec4 bitRange(int first, int last) {
    ivec4 low = clamp(ivec4(first) - ivec4(0, 32, 64, 96), ivec4(0), ivec4(32));
    ivec4 high = clamp(ivec4(last + 1) - ivec4(0, 32, 64, 96), ivec4(0), ivec4(32));
    uvec4 belowLow = mix((uvec4(1u) << uvec4(low & 31)) - 1u, uvec4(0xffffffffu), equal(low, ivec4(32)));
    uvec4 belowHigh = mix((uvec4(1u) << uvec4(high & 31)) - 1u, uvec4(0xffffffffu), equal(high, ivec4(32)));
    return belowHigh & ~belowLow;
}

#if LAMINA_COVERAGE == LAMINA_COVERAGE_FILLED
// The square is taken this much larger, in columns, to absorb the rounding of float offsets in it.
const float kFootprintAllowance = 1.0 / 131072.0;
const float kHalfColumn = 0.5 + kFootprintAllowance;

// Least and greatest plane value over the part of the triangle in the column's square, whose centre the
// triangle owns. The part is convex: its vertices are the square's corners inside the triangle and the
// ends of the edges' parts in the square. Values on an edge are interpolated between its ends, so that
// rounding moves them along the edge but never off it, however steep the triangle.
dvec2 extremesInColumn(LaminaColumnTriangle triangle, dvec2 center, double centerValue) {
    const vec4 cornerX = vec4(-kHalfColumn, kHalfColumn, -kHalfColumn, kHalfColumn);
    const vec4 cornerY = vec4(-kHalfColumn, -kHalfColumn, kHalfColumn, kHalfColumn);
    bvec4 cornerIsInside = bvec4(true);
    dvec2 range = dvec2(centerValue);
    for (int i = 0; i < 3; ++i) {
        dvec4 edge = triangle.edges[i];
        vec2 direction = vec2(edge.zw);
        float size = length(direction);
        if (size == 0.0)
            continue;
        vec2 along = direction / size;
        vec2 normal = vec2(-along.y, along.x);
        float distance = float(laminaEdgeValue(edge, center) / double(size));
        vec4 cornerDistances = normal.x * cornerX + normal.y * cornerY + distance;
        cornerIsInside = bvec4(ivec4(cornerIsInside) * ivec4(greaterThanEqual(cornerDistances, vec4(0.0))));
        if (distance > 1.0)
            continue;
        // Points of the edge, as offsets from the centre: origin + s * along, s from ends.x to ends.y.
        vec2 origin = -distance * normal;
        bool isAscending = edge.z > 0.0lf || (edge.z == 0.0lf && edge.w > 0.0lf);
        dvec2 a = isAscending ? edge.xy : edge.xy - edge.zw;
        dvec2 b = isAscending ? edge.xy + edge.zw : edge.xy;
        dvec2 ends = dvec2(dot(a - center, dvec2(along)), dot(b - center, dvec2(along)));
        float low = max(float(ends.x), -2.0);
        float high = min(float(ends.y), 2.0);
        for (int axis = 0; axis < 2; ++axis) {
            if (abs(along[axis]) > 1.0e-12) {
                float first = (-kHalfColumn - origin[axis]) / along[axis];
                float second = (kHalfColumn - origin[axis]) / along[axis];
                low = max(low, min(first, second));
                high = min(high, max(first, second));
            } else if (abs(origin[axis]) > kHalfColumn) {
                high = -3.0;
            }
        }
        if (low <= high) {
            double valueA = laminaPlaneValue(triangle, a);
            double slope = (laminaPlaneValue(triangle, b) - valueA) / (ends.y - ends.x);
            dvec2 values = valueA + slope * (dvec2(low, high) - ends.x);
            range = dvec2(min(range.x, min(values.x, values.y)), max(range.y, max(values.x, values.y)));
        }
    }
    vec2 gradient = vec2(triangle.depthPlane.xy);
    vec4 cornerValues = gradient.x * cornerX + gradient.y * cornerY;
    for (int corner = 0; corner < 4; ++corner)
        if (cornerIsInside[corner])
            range = dvec2(min(range.x, centerValue + double(cornerValues[corner])),
                          max(range.y, centerValue + double(cornerValues[corner])));
    return range;
}
#endif

void main() {
    LaminaColumnTriangle triangle =
        LaminaColumnTriangle(dvec4[3](laminaEdge0, laminaEdge1, laminaEdge2), laminaDepthPlane, laminaDepthRange);
    dvec2 center = dvec2(gl_FragCoord.xy);
    if (!laminaOwnsPoint(triangle, center))
        discard;

    bool isPerspective = (laminaDraw.size.w & LAMINA_GRID_PERSPECTIVE) != 0u;
    int firstSlice = int(laminaDraw.pass.x);
    double value = laminaPlaneValue(triangle, center);
#if LAMINA_COVERAGE == LAMINA_COVERAGE_SAMPLED
    int slice = laminaSliceAt(isPerspective ? 1.0lf / value : value, laminaDraw);
    laminaBits = slice < 0 ? uvec4(0u) : bitRange(slice - firstSlice, slice - firstSlice);
#else
    dvec2 range = extremesInColumn(triangle, center, value);
    if (isPerspective)
        range = dvec2(1.0lf / range.y, range.x > 0.0lf ? 1.0lf / range.x : triangle.depthRange.y);
    double near = laminaDraw.depthRange.x;
    double far = near + 1.0lf / laminaDraw.depthRange.y;
    range = clamp(range, dvec2(triangle.depthRange.x), dvec2(triangle.depthRange.y));
    laminaBits = uvec4(0u);
    double rounding = LAMINA_DEPTH_SNAP / laminaDraw.depthRange.y;
    if (range.y >= near - rounding && range.x <= far + rounding) {
        range = clamp(range, dvec2(near), dvec2(far));
        laminaBits = bitRange(laminaSliceAt(range.x, laminaDraw) - firstSlice, laminaSliceAt(range.y, laminaDraw) - firstSlice);
    }
#endif
}
