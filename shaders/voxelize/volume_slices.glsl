// Slice coordinates of depths and back, in double precision as on the host.
#include <voxelize/volume_blocks.glsl>

// Boundary k of the slices as a fraction of the depth range.
double laminaBoundary(int k) {
    if ((laminaDraw.size.w & LAMINA_GRID_CUSTOM_SLICES) == 0u)
        return double(k) / double(laminaDraw.size.z);
    return double(laminaPassVolume.boundaries[k >> 2][k & 3]);
}

// Continuous slice coordinate of a depth; -1 outside the grid. Depths within LAMINA_DEPTH_SNAP of a
// boundary count as on it.
double laminaSliceCoordinateOf(double depth) {
    precise double fraction = (depth - laminaDraw.depthRange.x) * laminaDraw.depthRange.y;
    if (!(fraction >= -LAMINA_DEPTH_SNAP && fraction <= 1.0lf + LAMINA_DEPTH_SNAP))
        return -1.0lf;
    fraction = clamp(fraction + LAMINA_DEPTH_SNAP, 0.0lf, 1.0lf);
    int slices = int(laminaDraw.size.z);
    if ((laminaDraw.size.w & LAMINA_GRID_CUSTOM_SLICES) == 0u)
        return fraction * double(slices);
    // The largest k with boundary k at or before the depth.
    int low = 0;
    int high = slices;
    while (high - low > 1) {
        int middle = (low + high) >> 1;
        if (laminaBoundary(middle) <= fraction)
            low = middle;
        else
            high = middle;
    }
    double front = laminaBoundary(low);
    return double(low) + min((fraction - front) / (laminaBoundary(low + 1) - front), 1.0lf);
}

// Depth at a slice coordinate in [0, slices].
double laminaDepthAtSlice(double coordinate) {
    int k = min(int(coordinate), int(laminaDraw.size.z) - 1);
    double front = laminaBoundary(k);
    double fraction = front + (laminaBoundary(k + 1) - front) * (coordinate - double(k));
    return laminaDraw.depthRange.x + fraction * (laminaDraw.depthRange.w - laminaDraw.depthRange.x);
}
