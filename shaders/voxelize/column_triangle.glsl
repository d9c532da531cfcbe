// What the fragments of a triangle know about it: exact edges and depth, in column space and in
// double precision. Rasterizers snap vertices to a sub-pixel grid; coverage and depth decided from
// these numbers do not depend on it, so every device gives the same voxels.

struct LaminaColumnTriangle {
    // Anchor (x,y) and direction (z,w) of each edge. The interior lies to the left. The anchor is the
    // lexicographically smaller end, so that the two triangles of an edge compute the same number.
    // Direction 0: no constraint (an edge behind the eye).
    dvec4 edges[3];
    // Gradient per column and value at edges[0].xy of the depth (orthographic) or 1/depth
    // (perspective): both are affine in column coordinates.
    dvec3 depthPlane;
    // Least and greatest depth of the triangle.
    dvec2 depthRange;
};

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

// The edge from a to b of a triangle whose interior lies to the left if `orientation` is positive.
dvec4 laminaOrientedEdge(dvec2 a, dvec2 b, double orientation) {
    bool isAscending = a.x < b.x || (a.x == b.x && a.y < b.y);
    dvec2 anchor = isAscending ? a : b;
    dvec2 direction = (isAscending ? b - a : a - b) * ((isAscending == (orientation > 0.0lf)) ? 1.0lf : -1.0lf);
    return dvec4(anchor, direction);
}

// Edges and depth plane of a triangle with columns p and plane values (depth or 1/depth) `values`. False
// if its projection is degenerate: then it owns no point.
bool laminaSetUpTriangle(dvec2 p[3], dvec3 values, inout LaminaColumnTriangle triangle) {
    dvec2 u = p[1] - p[0];
    dvec2 v = p[2] - p[0];
    precise double orientation = u.x * v.y - u.y * v.x;
    if (orientation == 0.0lf)
        return false;
    for (int i = 0; i < 3; ++i)
        triangle.edges[i] = laminaOrientedEdge(p[i], p[(i + 1) % 3], orientation);
    double du = values.y - values.x;
    double dv = values.z - values.x;
    triangle.depthPlane = dvec3((du * v.y - dv * u.y) / orientation, (dv * u.x - du * v.x) / orientation,
                                triangle.edges[0].xy == p[0] ? values.x : values.y);
    return true;
}
