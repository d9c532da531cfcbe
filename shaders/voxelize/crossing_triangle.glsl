// Triangles that cross the centre lines of columns.
#include <voxelize/column_triangle.glsl>

struct LaminaCrossingTriangle {
    LaminaColumnTriangle columns;
    // Which side of it looks at the near end of the columns.
    bool isCounterClockwise;
};

// The columns whose centres lie in the box around the triangle; all slices of the part, because a
// crossing beyond them fills them too.
LaminaVoxelBox laminaColumnsAround(dvec3 corners[3]) {
    dvec3 low = min(corners[0], min(corners[1], corners[2]));
    dvec3 high = max(corners[0], max(corners[1], corners[2]));
    return laminaVoxelsAround(dvec3(low.xy, double(laminaOverlap.low.z)), dvec3(high.xy, double(laminaOverlap.high.z + 1)), -0.5lf);
}

// False for triangles seen edge-on, which cross nothing.
bool laminaCrossingTriangle(dvec3 corners[3], out LaminaCrossingTriangle triangle) {
    triangle.columns.depthRange = dvec2(min(corners[0].z, min(corners[1].z, corners[2].z)), max(corners[0].z, max(corners[1].z, corners[2].z)));
    dvec2 p[3] = dvec2[](corners[0].xy, corners[1].xy, corners[2].xy);
    dvec2 u = p[1] - p[0];
    dvec2 v = p[2] - p[0];
    precise double orientation = u.x * v.y - u.y * v.x;
    triangle.isCounterClockwise = orientation > 0.0lf;
    return laminaSetUpTriangle(p, dvec3(corners[0].z, corners[1].z, corners[2].z), triangle.columns);
}

// Slice of the last voxel whose centre lies before the crossing of this centre line: it and all nearer
// ones are on the crossing's near side. Not clamped to the grid.
double laminaSliceBefore(LaminaColumnTriangle triangle, dvec2 center) {
    double crossing = clamp(laminaPlaneValue(triangle, center), triangle.depthRange.x, triangle.depthRange.y);
    return ceil(crossing - 0.5lf) - 1.0lf;
}
