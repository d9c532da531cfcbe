// The crossings of a triangle with the lines of one direction of SolidRule::Voted, counted with their
// signs in the cells. solid_scan.comp and solid_scan_columns.comp make votes of them.
#include <voxelize/solid_cells.glsl>
#if LAMINA_CROSSINGS == LAMINA_CROSSINGS_SIGNED

layout(std430, binding = LAMINA_SOLID_CELLS_BINDING) buffer LaminaSolidCells {
    uint laminaCellPlanes[];
};

// First and last step of line (p, q) in the grid; first > last for lines that miss it.
ivec2 laminaStepsInGrid(int p, int q) {
    ivec2 steps = ivec2(0, laminaLine.grid.z - 1);
    ivec2 start = ivec2(p, q);
    for (int axis = 0; axis < 2; ++axis) {
        int last = laminaLine.grid[axis] - 1 - start[axis];
        if (laminaLine.slope[axis] > 0)
            steps = ivec2(max(steps.x, -start[axis]), min(steps.y, last));
        else if (laminaLine.slope[axis] < 0)
            steps = ivec2(max(steps.x, -last), min(steps.y, start[axis]));
    }
    return steps;
}

// Adds 1 or -1 to one of the 32 numbers modulo 16 whose bits stand in the four planes of a cell. Each
// toggle hands the next plane a carry or a borrow that depends on the bit it found, so every order of
// additions, also interleaved ones, gives the same sum.
void laminaAddSigned(uint cell, uint bit, bool isIncrement) {
    for (uint plane = 0u; plane < 4u; ++plane) {
        uint found = atomicXor(laminaCellPlanes[cell * 4u + plane], bit);
        if (((found & bit) != 0u) != isIncrement)
            return;
    }
}

// Counts the crossing at the last voxel of the line whose centre lies before it; at the line's way in
// or out, one step outside the grid, if that is elsewhere.
void laminaCross(LaminaCrossingTriangle triangle, int p, int q) {
    dvec2 center = dvec2(p, q) + 0.5lf;
    if (!laminaOwnsPoint(triangle.columns, center))
        return;
    ivec2 steps = laminaStepsInGrid(p, q);
    if (steps.x > steps.y)
        return;
    int last = int(clamp(laminaSliceBefore(triangle.columns, center), double(steps.x - 1), double(steps.y)));
    ivec3 place = laminaCellPlace(p + laminaLine.slope.x * last, q + laminaLine.slope.y * last, last);
    if (place.x < laminaLine.rows.x || place.x >= laminaLine.rows.x + laminaLine.rows.y)
        return;
    laminaAddSigned(laminaCellIndex(place.x, place.y, place.z >> 5), 1u << uint(place.z & 31), triangle.isCounterClockwise);
}

#endif
