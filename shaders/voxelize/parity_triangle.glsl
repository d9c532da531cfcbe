// The crossings of a triangle with columns' centre lines, toggled in the grid. solid_fill.comp makes
// the inside of them.
#include <voxelize/column_triangle.glsl>

layout(std430, binding = LAMINA_OVERLAP_COLUMNS_BINDING) buffer LaminaColumns {
    // Columns that an odd number of triangles crosses: the mesh is open there.
    uint laminaOddColumns;
    uint laminaColumnsUnused[3];
    // A bit for each column: odd number of crossings before the first voxel's centre.
    uint laminaCrossedBefore[];
};

// The columns whose centres lie in the box around the triangle; all slices of the part, because a
// crossing beyond them fills them too.
LaminaVoxelBox laminaColumnsAround(dvec3 corners[3]) {
    dvec3 low = min(corners[0], min(corners[1], corners[2]));
    dvec3 high = max(corners[0], max(corners[1], corners[2]));
    return laminaVoxelsAround(dvec3(low.xy, double(laminaOverlap.low.z)), dvec3(high.xy, double(laminaOverlap.high.z + 1)), -0.5lf);
}

bool laminaParityTriangle(dvec3 corners[3], out LaminaColumnTriangle triangle) {
    triangle.depthRange = dvec2(min(corners[0].z, min(corners[1].z, corners[2].z)), max(corners[0].z, max(corners[1].z, corners[2].z)));
    dvec2 p[3] = dvec2[](corners[0].xy, corners[1].xy, corners[2].xy);
    return laminaSetUpTriangle(p, dvec3(corners[0].z, corners[1].z, corners[2].z), triangle);
}

// Toggles the last voxel whose centre lies before the crossing: it and all nearer ones are on its near
// side. Atomic: other triangles cross in the same word.
void laminaToggle(LaminaColumnTriangle triangle, int x, int y) {
    dvec2 center = dvec2(x, y) + 0.5lf;
    if (!laminaOwnsPoint(triangle, center))
        return;
    double crossing = clamp(laminaPlaneValue(triangle, center), triangle.depthRange.x, triangle.depthRange.y);
    double slice = ceil(crossing - 0.5lf) - 1.0lf;
    int last = int(clamp(slice, double(laminaOverlap.low.z - 1), double(laminaOverlap.high.z)));
    if (last >= laminaOverlap.low.z) {
        atomicXor(laminaWords[laminaWordIndex(x, y, last >> 5)], 1u << uint(last & 31));
    } else if (laminaOverlap.low.z == 0) {
        uint column = uint(y) * laminaOverlap.grid.x + uint(x);
        atomicXor(laminaCrossedBefore[column >> 5], 1u << (column & 31u));
    }
}
