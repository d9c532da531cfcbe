// The crossings of a triangle with columns' centre lines, toggled in the grid. solid_fill.comp makes
// the inside of them.
#include <voxelize/solid_columns.glsl>
#include <voxelize/crossing_check.glsl>
#if LAMINA_CROSSINGS == LAMINA_CROSSINGS_CHECKED
// Of this invocation.
uvec2 laminaCrossings = uvec2(0u);
#endif
#if LAMINA_CROSSINGS != LAMINA_CROSSINGS_SIGNED

// Toggles the last voxel whose centre lies before the crossing. Atomic: other triangles cross in the
// same word.
void laminaCross(LaminaCrossingTriangle triangle, int x, int y) {
    dvec2 center = dvec2(x, y) + 0.5lf;
    if (!laminaOwnsPoint(triangle.columns, center))
        return;
    double slice = laminaSliceBefore(triangle.columns, center);
    int last = int(clamp(slice, double(laminaOverlap.low.z - 1), double(laminaOverlap.high.z)));
    if (last >= laminaOverlap.low.z)
        atomicXor(laminaWords[laminaWordIndex(x, y, last >> 5)], 1u << uint(last & 31));
#if LAMINA_CROSSINGS == LAMINA_CROSSINGS_CHECKED
    uvec2 number = laminaPlaceNumber(x, y, last);
    laminaCrossings += triangle.isCounterClockwise ? number : -number;
#else
    else if (laminaOverlap.low.z == 0) {
        uint column = uint(y) * laminaOverlap.grid.x + uint(x);
        atomicXor(laminaCrossedBefore[column >> 5], 1u << (column & 31u));
    }
#endif
}

#endif
