// Triangles that reach far beyond the grid. Rasterizers lose whole columns of those (from some 8,000 times
// the grid's size on): their numbers are too coarse for the corners. So what is rasterized of them is a
// rectangle inside the grid, and the fragment stage decides.

// In sizes of the grid from its origin.
const double kLaminaFarCorner = 64.0lf;

// low, high: bounds of the triangle, columns.
bool laminaIsLarge(dvec2 low, dvec2 high, dvec2 size) {
    return any(greaterThan(max(abs(low), abs(high)), kLaminaFarCorner * size));
}
