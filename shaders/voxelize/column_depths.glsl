// The depths at which a triangle meets a column, by coverage. For fragment stages that include
// voxelize/draw_block.glsl and define LAMINA_COVERAGE.
#include <voxelize/column_triangle.glsl>

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

// Least and greatest eye depth that the triangle gives the column of this centre; false if none.
// Sampled: the depth at the centre, twice. Filled: the depths of the part of the triangle inside the
// column's square, if the triangle owns the centre.
bool laminaDepthsInColumn(LaminaColumnTriangle triangle, dvec2 center, out dvec2 depths) {
    depths = dvec2(0.0lf);
    if (!laminaOwnsPoint(triangle, center))
        return false;
    bool isPerspective = (laminaDraw.size.w & LAMINA_GRID_PERSPECTIVE) != 0u;
    double value = laminaPlaneValue(triangle, center);
#if LAMINA_COVERAGE == LAMINA_COVERAGE_SAMPLED
    depths = dvec2(isPerspective ? 1.0lf / value : value);
#else
    depths = extremesInColumn(triangle, center, value);
    if (isPerspective)
        depths = dvec2(1.0lf / depths.y, depths.x > 0.0lf ? 1.0lf / depths.x : triangle.depthRange.y);
    depths = clamp(depths, dvec2(triangle.depthRange.x), dvec2(triangle.depthRange.y));
#endif
    return true;
}
