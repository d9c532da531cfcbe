// Leaves the cells of a diagonal zero. One invocation owns one word of a row.
#include <voxelize/solid_cells.glsl>

layout(local_size_x = LAMINA_OVERLAP_GROUP_SIZE) in;

layout(std430, binding = LAMINA_SOLID_CELLS_BINDING) writeonly buffer LaminaSolidCells {
    uvec4 laminaCells[];
};

void main() {
    uint index = (gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x) * LAMINA_OVERLAP_GROUP_SIZE + gl_LocalInvocationIndex;
    int word = int(index % uint(laminaLine.period.w));
    int row = int(index / uint(laminaLine.period.w)) + laminaLine.rows.x;
    if (row >= laminaLine.rows.x + laminaLine.rows.y)
        return;
    uint cell = laminaCellIndex(row, 0, word);
    for (int slot = 0; slot < laminaLine.period.z; ++slot) {
        laminaCells[cell] = uvec4(0u);
        cell += uint(laminaLine.period.w);
    }
}
