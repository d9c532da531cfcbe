// The depths at which a triangle meets a column, by coverage. For fragment stages that include
// voxelize/draw_block.glsl and define LAMINA_COVERAGE.
#include <voxelize/column_triangle.glsl>

#if LAMINA_COVERAGE == LAMINA_COVERAGE_FILLED || LAMINA_COVERAGE == LAMINA_COVERAGE_CONSERVATIVE
const float kHalfColumn = 0.5 + kLaminaFootprintAllowance;
const double kUnboundedDepth = 1.0e300lf;

dvec2 including(dvec2 range, dvec2 values) {
    return dvec2(min(range.x, min(values.x, values.y)), max(range.y, max(values.x, values.y)));
}

// The part in the column's square of a line at a distance from the centre, as distances along it from
// the point nearest to the centre; x > y if there is none.
vec2 lineInColumn(vec2 nearest, vec2 along) {
    vec2 part = vec2(-2.0, 2.0);
    for (int axis = 0; axis < 2; ++axis) {
        if (abs(along[axis]) > 1.0e-12) {
            float first = (-kHalfColumn - nearest[axis]) / along[axis];
            float second = (kHalfColumn - nearest[axis]) / along[axis];
            part = vec2(max(part.x, min(first, second)), min(part.y, max(first, second)));
        } else if (abs(nearest[axis]) > kHalfColumn) {
            part.y = -3.0;
        }
    }
    return part;
}

// `range` and the plane values of the part of edge i in the column's square. Interpolated between the
// edge's ends, so that rounding moves them along the edge but never off it, however steep the triangle.
// along: the edge's direction, from its anchor; nearest: its point nearest to the centre, relative to it.
dvec2 includingEdge(dvec2 range, LaminaColumnTriangle triangle, int i, dvec2 center, vec2 along, vec2 nearest) {
    dvec4 edge = triangle.edges[i];
    double first = dot(edge.xy - center, dvec2(along));
    double size = abs(dot(edge.zw, dvec2(along)));
    vec2 part = lineInColumn(nearest, along);
    dvec2 places = (dvec2(part) - first) / size;
    if (part.x > part.y || places.y < 0.0lf || places.x > 1.0lf)
        return range;
    places = clamp(places, 0.0lf, 1.0lf);
    dvec2 ends = triangle.edgeValues[i];
    return including(range, ends.x + (ends.y - ends.x) * places);
}

// Least and greatest plane value over the part of the triangle in the column's square; x > y if it has
// none there. The part is a convex polygon: its corners are the ends of the edges' parts in the square,
// and the square's corners inside the triangle.
dvec2 extremesInColumn(LaminaColumnTriangle triangle, dvec2 center) {
    const vec4 cornerX = vec4(-kHalfColumn, kHalfColumn, -kHalfColumn, kHalfColumn);
    const vec4 cornerY = vec4(-kHalfColumn, -kHalfColumn, kHalfColumn, kHalfColumn);
    bvec4 cornerIsInside = bvec4(!triangle.isEdgeOn);
    dvec2 range = dvec2(kUnboundedDepth, -kUnboundedDepth);
    for (int i = 0; i < 3; ++i) {
        dvec4 edge = triangle.edges[i];
        vec2 direction = vec2(edge.zw);
        float size = length(direction);
        if (size == 0.0) {
            dvec2 offset = abs(edge.xy - center);
            if (max(offset.x, offset.y) <= double(kHalfColumn))
                range = including(range, triangle.edgeValues[i]);
            continue;
        }
        direction /= size;
        vec2 inwards = vec2(-direction.y, direction.x);
        float distance = float(laminaEdgeValue(edge, center) / double(size));
        vec4 cornerDistances = inwards.x * cornerX + inwards.y * cornerY + distance;
        cornerIsInside = bvec4(ivec4(cornerIsInside) * ivec4(greaterThanEqual(cornerDistances, vec4(0.0))));
        if (abs(distance) <= 1.0) {
            bool isAscending = edge.z > 0.0lf || (edge.z == 0.0lf && edge.w > 0.0lf);
            range = includingEdge(range, triangle, i, center, isAscending ? direction : -direction, -distance * inwards);
        }
    }
    if (any(cornerIsInside)) {
        dvec2 step = triangle.depthPlane.xy * double(kHalfColumn);
        dvec4 values = laminaPlaneValue(triangle, center) + step.x * dvec4(-1.0lf, 1.0lf, -1.0lf, 1.0lf) +
                       step.y * dvec4(-1.0lf, -1.0lf, 1.0lf, 1.0lf);
        for (int corner = 0; corner < 4; ++corner)
            if (cornerIsInside[corner])
                range = including(range, dvec2(values[corner]));
    }
    return range;
}
#endif

// Eye depths of an interval of plane values, within the triangle's own.
dvec2 depthsOfValues(LaminaColumnTriangle triangle, dvec2 values) {
    if ((laminaDraw.size.w & LAMINA_GRID_PERSPECTIVE) != 0u)
        values = dvec2(values.y > 0.0lf ? 1.0lf / values.y : triangle.depthRange.y,
                       values.x > 0.0lf ? 1.0lf / values.x : triangle.depthRange.y);
    return clamp(values, dvec2(triangle.depthRange.x), dvec2(triangle.depthRange.y));
}

// Least and greatest eye depth that the triangle gives the column of this centre; false if none.
// Sampled, Solid: the depth at the centre, twice, if the triangle owns it. Filled: the depths of the part
// of the triangle inside the column's square, if the triangle owns the centre. Conservative: the same
// wherever the triangle touches the square, so far beyond that a depth on a boundary lies on both sides.
bool laminaDepthsInColumn(LaminaColumnTriangle triangle, dvec2 center, out dvec2 depths) {
    depths = dvec2(0.0lf);
#if LAMINA_COVERAGE == LAMINA_COVERAGE_CONSERVATIVE
    dvec2 values = extremesInColumn(triangle, center);
    if (values.x > values.y)
        return false;
    double closure = 2.0lf * LAMINA_DEPTH_SNAP / laminaDraw.depthRange.y;
    depths = depthsOfValues(triangle, values) + dvec2(-closure, closure);
#else
    if (!laminaOwnsPoint(triangle, center))
        return false;
    dvec2 values = dvec2(laminaPlaneValue(triangle, center));
#if LAMINA_COVERAGE == LAMINA_COVERAGE_FILLED
    values = including(extremesInColumn(triangle, center), values);
#endif
    depths = depthsOfValues(triangle, values);
#endif
    return true;
}
