// Where a depth falls among the slices of a grid, in double precision as on the host
// (GridTransform::sliceAt). Needs a LaminaGridBlock named laminaPassGrid for custom slices.

// Slice of a depth, or -1 outside the grid. `grid`: see LaminaDrawConstants.
int laminaSliceAt(double depth, LaminaDrawConstants grid) {
    precise double fraction = (depth - grid.depthRange.x) * grid.depthRange.y;
    if (!(fraction >= -LAMINA_DEPTH_SNAP && fraction <= 1.0lf + LAMINA_DEPTH_SNAP))
        return -1;
    fraction = max(fraction + LAMINA_DEPTH_SNAP, 0.0lf);
    int last = int(grid.size.z) - 1;
    if ((grid.size.w & LAMINA_GRID_CUSTOM_SLICES) == 0u)
        return min(int(floor(fraction * grid.depthRange.w)), last);
    // The largest k with boundaries[k] <= fraction.
    int low = 0;
    int high = last + 1;
    while (high - low > 1) {
        int middle = (low + high) >> 1;
        if (double(laminaPassGrid.boundaries[middle >> 2][middle & 3]) <= fraction)
            low = middle;
        else
            high = middle;
    }
    return low;
}
