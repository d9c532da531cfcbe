// The crossings of a triangle with the lines of one direction of SolidRule::Voted, counted with their
// signs in the cells. solid_scan.comp and solid_scan_columns.comp make votes of them.
#include <voxelize/solid_cells.glsl>
#if LAMINA_CROSSINGS == LAMINA_CROSSINGS_SIGNED

layout(std430, binding = LAMINA_SOLID_CELLS_BINDING) buffer LaminaSolidCells {
    uint laminaCellPlanes[];
};
layout(std430, binding = LAMINA_SOLID_TOUCHED_BINDING) buffer LaminaSolidTouched {
    uint laminaTouched[];
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
// additions, also interleaved ones, gives the same sum. Weights alternate in sign: a carry subtracts.
void laminaAddSigned(uint cell, uint bit, bool isIncrement) {
    for (uint plane = 0u; plane < 4u; ++plane) {
        uint found = atomicXor(laminaCellPlanes[cell * 4u + plane], bit);
        if (((found & bit) != 0u) != isIncrement)
            return;
        isIncrement = !isIncrement;
    }
}

// Marks the cell of an axis.
void laminaTouch(int row, int slot, int word) {
    bool isAlongZ = laminaLine.rows.z == LAMINA_SOLID_ALONG_Z;
    uint bit = uint(isAlongZ ? word : slot);
    uint index = laminaTouchedIndex(row, isAlongZ ? slot : word) + (bit >> 5);
    if ((laminaTouched[index] & (1u << (bit & 31u))) == 0u)
        atomicOr(laminaTouched[index], 1u << (bit & 31u));
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
    int word = place.z >> 5;
    laminaAddSigned(laminaCellIndex(place.x, place.y, word), 1u << uint(place.z & 31), triangle.isCounterClockwise);
    if (laminaLine.rows.w > 0)
        laminaTouch(place.x, place.y, word);
}

#endif
