// Where a depth falls among the slices of a grid, in double precision as on the host
// (GridTransform::sliceAt). Needs a LaminaGridBlock named laminaPassGrid for custom slices.

// The largest slice k > 0 whose front lies at or before a depth fraction in a custom distribution, else 0.
int laminaCustomSliceAt(double fraction, LaminaDrawConstants grid) {
    int low = 0;
    int high = int(grid.size.z);
    while (high - low > 1) {
        int middle = (low + high) >> 1;
        if (double(laminaPassGrid.boundaries[middle >> 2][middle & 3]) <= fraction)
            low = middle;
        else
            high = middle;
    }
    return low;
}

// Slice of a depth that stands at `fraction` of the range that the slices divide, or -1 outside the range.
// `grid`: see LaminaDrawConstants.
int laminaSliceOf(double fraction, LaminaDrawConstants grid) {
    if (!(fraction >= -LAMINA_DEPTH_SNAP && fraction <= 1.0lf + LAMINA_DEPTH_SNAP))
        return -1;
    fraction = max(fraction + LAMINA_DEPTH_SNAP, 0.0lf);
    if ((grid.size.w & LAMINA_GRID_CUSTOM_SLICES) == 0u)
        return min(int(floor(fraction * grid.depthRange.w)), int(grid.size.z) - 1);
    return laminaCustomSliceAt(fraction, grid);
}

// The same of a depth in the grid's own range.
int laminaSliceAt(double depth, LaminaDrawConstants grid) {
    precise double fraction = (depth - grid.depthRange.x) * grid.depthRange.y;
    return laminaSliceOf(fraction, grid);
}

// The last slice whose centre (slice coordinate k + 0.5) lies before a depth, or -1 if none does.
int laminaLastCenterBefore(double depth, LaminaDrawConstants grid) {
    precise double fraction = (depth - grid.depthRange.x) * grid.depthRange.y;
    fraction = clamp(fraction, 0.0lf, 1.0lf);
    if ((grid.size.w & LAMINA_GRID_CUSTOM_SLICES) == 0u)
        return int(ceil(fraction * grid.depthRange.w - 0.5lf)) - 1;
    int slice = laminaCustomSliceAt(fraction, grid);
    double front = double(laminaPassGrid.boundaries[slice >> 2][slice & 3]);
    double back = double(laminaPassGrid.boundaries[(slice + 1) >> 2][(slice + 1) & 3]);
    return 0.5lf * (front + back) < fraction ? slice : slice - 1;
}
