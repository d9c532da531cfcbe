// Which voxels a triangle meets, by separating axes [Schwarz & Seidel 2010], solved for the slices of
// one column. Needs Real, Real2, Real3: float or double types, and kVertical.
//
// A triangle and a convex box are apart if and only if their shadows are on one of 13 axes: the 3 grid
// axes, the triangle's normal, and the 9 cross products of its edges with the grid axes. For a voxel
// at (x, y, z) each of these is an inequality
//
//     low <= a x + b y + c z <= high,
//
// so a column's voxels are an interval of z: the narrowest of the intervals of the normal, of the
// edges seen along y (x and z) and along x (y and z), and of the bounding box; the edges seen along z
// (x and y) tell whether the column has any. An inequality that does not depend on the coordinate it is
// solved for says nothing beyond the bounding box and is left unbounded.
#define LAMINA_UNBOUNDED 1.0e9

// All coordinates are relative to `base`, where they are small.
struct LaminaOverlapTriangle {
    ivec3 base;
    // Edge i seen along z: x in slopes[i].x * y + [lowX[i], highX[i]];
    // along x: z in slopes[i].y * y + [lowZY[i], highZY[i]]; along y: z in slopes[i].z * x + ...
    Real3 slopes[3];
    Real3 lowX, highX;
    Real3 lowZY, highZY;
    Real3 lowZX, highZX;
    // Plane: z in gradient . (x, y) + [planeRange.x, planeRange.y].
    Real2 gradient;
    Real2 planeRange;
};

// Half the shadow of a voxel on the axis (-slope, 1): of its cube, or of the crosshair through its
// centre, which alone makes the thin, 6-separating set.
Real laminaReach(Real sizes, Real largest) {
#if LAMINA_COVERAGE == LAMINA_COVERAGE_SEPARATING6
    return largest * Real(0.5 + LAMINA_OVERLAP_ALLOWANCE);
#else
    return sizes * Real(0.5 + LAMINA_OVERLAP_ALLOWANCE);
#endif
}

// The range of q - slope * p for low corners of voxels whose shadow meets the triangle's, in the plane
// (p, q), on the axis at right angles to an edge. along: of the edge; corner: on it; apex: the third.
void laminaStrip(Real alongP, Real alongQ, Real2 corner, Real2 apex, out Real slope, out Real low, out Real high) {
    slope = Real(0.0);
    low = Real(-LAMINA_UNBOUNDED);
    high = Real(LAMINA_UNBOUNDED);
    if (abs(alongP) > Real(1.0e-6)) {
        slope = alongQ / alongP;
        Real a = corner.y - slope * corner.x;
        Real b = apex.y - slope * apex.x;
        Real size = abs(slope);
        Real reach = laminaReach(size + Real(1.0), max(size, Real(1.0)));
        Real center = Real(0.5) - Real(0.5) * slope;
        low = min(a, b) - center - reach;
        high = max(a, b) - center + reach;
    }
}

// normal: cross product of the edges, precise, of any length.
LaminaOverlapTriangle laminaOverlapTriangle(ivec3 base, Real3 corners[3], Real3 normal) {
    LaminaOverlapTriangle t;
    t.base = base;
    for (int i = 0; i < 3; ++i) {
        Real3 a = corners[i];
        Real3 along = corners[(i + 1) % 3] - a;
        Real3 apex = corners[(i + 2) % 3];
        laminaStrip(along.y, along.x, a.yx, apex.yx, t.slopes[i].x, t.lowX[i], t.highX[i]);
        laminaStrip(along.y, along.z, a.yz, apex.yz, t.slopes[i].y, t.lowZY[i], t.highZY[i]);
        laminaStrip(along.x, along.z, a.xz, apex.xz, t.slopes[i].z, t.lowZX[i], t.highZX[i]);
    }
    t.gradient = Real2(0.0);
    t.planeRange = Real2(-LAMINA_UNBOUNDED, LAMINA_UNBOUNDED);
    Real2 sizes = abs(normal.xy);
    if (abs(normal.z) > kVertical * (sizes.x + sizes.y)) {
        t.gradient = -normal.xy / normal.z;
        sizes = abs(t.gradient);
        Real3 values = Real3(corners[0].z - dot(t.gradient, corners[0].xy), corners[1].z - dot(t.gradient, corners[1].xy),
                             corners[2].z - dot(t.gradient, corners[2].xy));
        Real reach = laminaReach(sizes.x + sizes.y + Real(1.0), max(max(sizes.x, sizes.y), Real(1.0)));
        Real center = Real(0.5) - Real(0.5) * (t.gradient.x + t.gradient.y);
        t.planeRange = Real2(min(values.x, min(values.y, values.z)) - center - reach,
                             max(values.x, max(values.y, values.z)) - center + reach);
    }
    return t;
}

Real laminaLeast(Real3 v) {
    return min(v.x, min(v.y, v.z));
}
Real laminaGreatest(Real3 v) {
    return max(v.x, max(v.y, v.z));
}

// Relative columns x that the triangle may meet in relative row y.
Real2 laminaRowColumns(LaminaOverlapTriangle t, Real y) {
    Real3 x = Real3(t.slopes[0].x, t.slopes[1].x, t.slopes[2].x) * y;
    return Real2(laminaGreatest(x + t.lowX), laminaLeast(x + t.highX));
}

// Relative slices that the edges seen along x leave in relative row y.
Real2 laminaRowSlices(LaminaOverlapTriangle t, Real y) {
    Real3 z = Real3(t.slopes[0].y, t.slopes[1].y, t.slopes[2].y) * y;
    return Real2(laminaGreatest(z + t.lowZY), laminaLeast(z + t.highZY));
}

// Relative slices that the plane and the edges seen along y leave in relative column (x, y).
Real2 laminaColumnSlices(LaminaOverlapTriangle t, Real x, Real y) {
    Real3 z = Real3(t.slopes[0].z, t.slopes[1].z, t.slopes[2].z) * x;
    Real plane = t.gradient.x * x + t.gradient.y * y;
    return Real2(max(laminaGreatest(z + t.lowZX), plane + t.planeRange.x), min(laminaLeast(z + t.highZX), plane + t.planeRange.y));
}

// What is done with the voxels a triangle meets: told the triangle, then slices [first, last] of columns.
void laminaBeginTriangle(uint triangle, dvec3 corners[3]);
void laminaVisitSlices(int x, int y, int first, int last);
