// What the fragments of a triangle know about it: exact edges and depth, in column space and in
// double precision. Rasterizers snap vertices to a sub-pixel grid; coverage and depth decided from
// these numbers do not depend on it, so every device gives the same voxels.

// Columns' squares are taken this much larger on every side, in columns, to absorb the rounding of float
// offsets in them.
const float kLaminaFootprintAllowance = 1.0 / 131072.0;

struct LaminaColumnTriangle {
    // Anchor (x,y) and direction (z,w) of each edge. The interior lies to the left. The anchor is the
    // lexicographically smaller end, so that the two triangles of an edge compute the same number.
    // Direction 0: no constraint (an edge behind the eye).
    dvec4 edges[3];
    // Plane values at the anchor and at the other end of each edge.
    dvec2 edgeValues[3];
    // Gradient per column and value at edges[0].xy of the depth (orthographic) or 1/depth
    // (perspective): both are affine in column coordinates.
    dvec3 depthPlane;
    // Least and greatest depth of the triangle.
    dvec2 depthRange;
    // Nowhere wider than half the footprint allowance. A point inside then lies between points of two edges
    // closer than the allowance: the edges alone tell the depths in a square, the plane is not needed.
    bool isEdgeOn;
};

// For initializers: Mesa warns of variables that it cannot see set before a function reads them.
const LaminaColumnTriangle kLaminaNoTriangle =
    LaminaColumnTriangle(dvec4[3](dvec4(0.0lf), dvec4(0.0lf), dvec4(0.0lf)), dvec2[3](dvec2(0.0lf), dvec2(0.0lf), dvec2(0.0lf)),
                         dvec3(0.0lf), dvec2(0.0lf), false);

// Positive inside, negative outside, zero on the edge; in column units times the edge's length.
double laminaEdgeValue(dvec4 edge, dvec2 point) {
    precise double x = edge.z * (point.y - edge.y);
    precise double y = edge.w * (point.x - edge.x);
    precise double value = x - y;
    return value;
}

// Does the triangle own this point? A point on an edge belongs to the one of the two triangles of
// that edge for which it is a left or a horizontal top edge.
bool laminaOwnsPoint(LaminaColumnTriangle triangle, dvec2 point) {
    for (int i = 0; i < 3; ++i) {
        dvec4 edge = triangle.edges[i];
        double value = laminaEdgeValue(edge, point);
        bool isLeftOrTop = edge.w < 0.0lf || (edge.w == 0.0lf && edge.z <= 0.0lf);
        if (!(value > 0.0lf || (value == 0.0lf && isLeftOrTop)))
            return false;
    }
    return true;
}

// Depth (orthographic) or 1/depth (perspective) of the triangle's plane.
double laminaPlaneValue(LaminaColumnTriangle triangle, dvec2 point) {
    dvec2 offset = point - triangle.edges[0].xy;
    precise double value = triangle.depthPlane.z + triangle.depthPlane.x * offset.x + triangle.depthPlane.y * offset.y;
    return value;
}

// Edge number i, from a to b with plane values `values`, of a triangle whose interior lies to the left if
// `orientation` is positive.
void laminaSetEdge(int i, dvec2 a, dvec2 b, dvec2 values, double orientation, inout LaminaColumnTriangle triangle) {
    bool isAscending = a.x < b.x || (a.x == b.x && a.y < b.y);
    dvec2 anchor = isAscending ? a : b;
    dvec2 direction = (isAscending ? b - a : a - b) * ((isAscending == (orientation > 0.0lf)) ? 1.0lf : -1.0lf);
    triangle.edges[i] = dvec4(anchor, direction);
    triangle.edgeValues[i] = isAscending ? values : values.yx;
}

// Edges and depth plane of a triangle with columns p and plane values (depth or 1/depth) `values`. False
// if its projection is degenerate: then it owns no point, and only its edges are set.
bool laminaSetUpTriangle(dvec2 p[3], dvec3 values, inout LaminaColumnTriangle triangle) {
    dvec2 u = p[1] - p[0];
    dvec2 v = p[2] - p[0];
    precise double orientation = u.x * v.y - u.y * v.x;
    for (int i = 0; i < 3; ++i) {
        int next = (i + 1) % 3;
        laminaSetEdge(i, p[i], p[next], dvec2(values[i], values[next]), orientation, triangle);
    }
    dvec2 w = p[2] - p[1];
    double longest = max(dot(u, u), max(dot(v, v), dot(w, w)));
    double width = 0.5lf * double(kLaminaFootprintAllowance);
    triangle.isEdgeOn = orientation * orientation <= longest * width * width;
    if (orientation == 0.0lf)
        return false;
    double du = values.y - values.x;
    double dv = values.z - values.x;
    triangle.depthPlane = dvec3((du * v.y - dv * u.y) / orientation, (dv * u.x - du * v.x) / orientation, triangle.edgeValues[0].x);
    return true;
}
