// Leaves the cells of a diagonal zero: those of the words with needed lines, an invocation for each.
#include <voxelize/solid_cells.glsl>

layout(local_size_x = LAMINA_OVERLAP_GROUP_SIZE) in;

layout(std430, binding = LAMINA_SOLID_CELLS_BINDING) writeonly buffer LaminaSolidCells {
    uvec4 laminaCells[];
};
layout(std430, binding = LAMINA_SOLID_TOUCHED_BINDING) readonly buffer LaminaSolidTouched {
    uint laminaTouched[];
};

void main() {
    uint index = (gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x) * LAMINA_OVERLAP_GROUP_SIZE + gl_LocalInvocationIndex;
    int word = int(index % uint(laminaLine.period.w));
    int row = int(index / uint(laminaLine.period.w)) + laminaLine.rows.x;
    if (row >= laminaLine.rows.x + laminaLine.rows.y || laminaTouched[laminaTouchedIndex(row, word)] == 0u)
        return;
    uint cell = laminaCellIndex(row, 0, word);
    for (int slot = 0; slot < laminaLine.period.z; ++slot) {
        laminaCells[cell] = uvec4(0u);
        cell += uint(laminaLine.period.w);
    }
}
